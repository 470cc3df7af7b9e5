#include "render/load/list_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "render/load/files/unread.h"
#include "render/load/gltf/extensions.h"
#include "render/load/pbrt/features.h"

namespace latent::render {

namespace {

// "  NAME  words", wrapped at 80 columns.
template <class Words>
std::string paragraph(std::string_view name, const Words& words) {
    constexpr std::size_t kIndent = 18, kWidth = 80;
    std::string text, line = fmt::format("  {:<16}", name);
    for (const std::string_view word : words) {
        if (line.size() + 1 + word.size() > kWidth) {
            text += line + "\n";
            line = std::string(kIndent, ' ');
        }
        if (line.size() > kIndent) line += ' ';
        line += word;
    }
    return text + line + "\n";
}

std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> out;
    while (!text.empty()) {
        out.push_back(text.substr(0, text.find(' ')));
        text.remove_prefix(std::min(out.back().size() + 1, text.size()));
    }
    return out;
}

// What a format has beside that.
std::string unread(SceneLanguage language) {
    std::string text;
    for (const UnreadFeatures& of : unread_features()) {
        if (of.language != language) continue;
        const std::string line = of.names.empty() ? std::string(of.why) : fmt::format("{}: {}", of.names, of.why);
        text += paragraph(of.kind, words_of(line));
    }
    return text;
}

}  // namespace

std::string list_features() {
    std::string text = "pbrt-v4 (.pbrt)\n", own_types, parameters, replaced;
    const auto is_of_pbrt = [](std::string_view type) { return type != "phong" && !type.starts_with("latent:"); };
    for (const PbrtFeature& feature : pbrt_features()) {
        std::vector<std::string_view> of_pbrt, own;
        for (const std::string_view type : feature.types) (is_of_pbrt(type) ? of_pbrt : own).push_back(type);
        text += paragraph(feature.directive, of_pbrt);
        if (!own.empty()) own_types += paragraph(feature.directive, own);
    }
    for (const PbrtFeature& feature : pbrt_replacements()) replaced += paragraph(feature.directive, feature.types);
    for (const PbrtFeature& extension : pbrt_extensions()) parameters += paragraph(extension.directive, extension.types);
    text += "\nreplaced, with a warning: films by rgb, integrators by path\n" + replaced;
    text += "\ntypes beyond pbrt-v4 (docs/scenes.md, \"Extensions\")\n" + own_types;
    text += "\nparameters, and values of parameters, beyond pbrt-v4\n" + parameters;
    text += "\nnot read of pbrt-v4\n" + unread(SceneLanguage::kPbrtV4);
    text += "\npbrt-v3 (.pbrt): docs/scenes.md, \"Scenes for pbrt-v3\"\n\nnot read of pbrt-v3\n" + unread(SceneLanguage::kPbrtV3);
    text += "\nglTF 2.0 (.gltf, .glb)\n" + paragraph("extensions", known_extensions());
    text += "\nnot read of glTF\n" + unread(SceneLanguage::kGltf);
    text += "\nWavefront OBJ (.obj, .mtl)\n";
    using Words = std::initializer_list<std::string_view>;
    text += paragraph("geometry", Words{"v", "vt", "vn", "f", "s", "mtllib", "usemtl"});
    text += paragraph("materials",
                      Words{"newmtl", "Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr"});
    text += paragraph("maps", Words{"map_Kd", "map_Ks", "map_Ke", "map_Ns", "map_d", "map_Pr", "map_Pm", "map_Ps", "map_Pc",
                                    "map_Pcr", "norm", "map_bump"});
    return text + "\nnot read of OBJ\n" + unread(SceneLanguage::kObj);
}

}  // namespace latent::render
