#include "render/load/scene_format.h"

#include <algorithm>
#include <string>

namespace latent::render {

namespace {

struct Beginning {
    std::string_view bytes, format;
};
constexpr Beginning kBeginnings[] = {
    {"#usda ", "this is a USD scene"},
    {"PXR-USDC", "this is a USD scene"},
    {"PK\x03\x04", "this is a zip archive, as USDZ scenes are"},
    {"Kaydara FBX Binary", "this is an FBX scene"},
    {"; FBX ", "this is an FBX scene"},
    {"BLENDER", "this is a Blender file"},
    {"ply\n", "this is a PLY mesh, which a scene names in Shape \"plymesh\""},
    {"ply\r", "this is a PLY mesh, which a scene names in Shape \"plymesh\""},
    {"solid ", "this is an STL mesh"},
    {"<", "this is XML, as scenes of Mitsuba and COLLADA are"},
    {"\x28\xb5\x2f\xfd", "this is compressed by zstd"},
};

// Words that begin a line of Wavefront OBJ.
constexpr std::string_view kObjWords[] = {"mtllib ", "usemtl ", "v ", "vt ", "vn ", "f ", "o ", "g "};

// From the first line that is not empty and no comment of "#".
std::string_view first_statement(std::string_view text) {
    while (true) {
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
        if (!text.starts_with('#')) return text;
        text.remove_prefix(std::min(text.find('\n'), text.size()));
    }
}

std::string_view without_mark(std::string_view text) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    return text;
}

}  // namespace

SceneFormat scene_format(const std::filesystem::path& path, std::string_view beginning) {
    std::string extension = path.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (extension == ".pbrt") return SceneFormat::kPbrt;
    if (extension == ".glb" || extension == ".gltf" || beginning.starts_with("glTF")) return SceneFormat::kGltf;
    if (extension == ".obj") return SceneFormat::kObj;
    const std::string_view statement = first_statement(without_mark(beginning));
    if (statement.starts_with('{')) return SceneFormat::kGltf;
    const auto begins = [statement](std::string_view word) { return statement.starts_with(word); };
    return std::ranges::any_of(kObjWords, begins) ? SceneFormat::kObj : SceneFormat::kPbrt;
}

std::string_view foreign_format(std::string_view text) {
    text = without_mark(text);
    for (const Beginning& beginning : kBeginnings) {
        if (text.starts_with(beginning.bytes)) return beginning.format;
    }
    const std::string_view statement = first_statement(text);
    if (statement.starts_with('{') || text.starts_with("glTF")) return "this is a glTF scene; its name must end in .gltf or .glb";
    const auto begins = [statement](std::string_view word) { return statement.starts_with(word); };
    if (std::ranges::any_of(kObjWords, begins)) return "this is a Wavefront OBJ scene; its name must end in .obj";
    if (text.find('\0') != text.npos) return "this is a binary file";
    return {};
}

}  // namespace latent::render
