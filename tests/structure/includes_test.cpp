// The arrows of CONTRIBUTING.md's diagrams, read from the includes: nothing points back, and every file is in a room.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace {

namespace fs = std::filesystem;
using Rooms = std::set<std::string>;

// Room -> rooms below it. A file may include headers of its own room and of all that arrows lead to from there, step by step.
const std::map<std::string, Rooms>& arrows() {
    static const std::map<std::string, Rooms> table = {
        {"base", {}},
        {"color", {"base"}},
        {"color/film", {"color"}},
        {"image", {"base"}},
        {"image/oiio", {"image"}},

        {"sampledb/data", {"base"}},
        {"sampledb/format", {"sampledb/data"}},
        {"sampledb/codec", {"sampledb/format"}},
        {"sampledb/read", {"sampledb/codec"}},
        {"sampledb/http", {"sampledb/read"}},
        {"sampledb/write", {"sampledb/read"}},

        {"render/math", {"base"}},
        {"render/spectral", {"color", "sampledb/data"}},
        {"render/sampling", {"render/math", "render/spectral"}},
        {"render/scene", {"render/math", "render/spectral"}},
        {"render/geometry", {"render/sampling", "render/scene"}},
        {"render/bsdf", {"render/sampling", "render/scene"}},
        {"render/camera", {"render/sampling", "render/scene"}},
        {"render/light", {"render/geometry", "render/bsdf", "render/texture"}},
        {"render/medium", {"render/geometry", "render/bsdf", "render/texture"}},
        {"render/texture", {"render/sampling", "render/scene", "image"}},
        {"render/material", {"render/light", "render/texture"}},
        {"render/world", {"render/material", "render/medium", "render/camera"}},
        {"render/transport", {"render/world"}},
        {"render/transport/bidirectional", {"render/transport"}},
        {"render/load/mesh", {"render/scene"}},
        {"render/load/volume", {"render/scene"}},
        {"render/load/brdf", {"render/scene"}},
        {"render/load/files", {"render/scene", "image"}},
        {"render/load/pbrt", {"render/load/files", "render/load/mesh", "render/load/volume", "render/load/brdf"}},
        {"render/load/model", {"render/load/files", "render/load/mesh", "render/texture"}},
        {"render/load/gltf", {"render/load/model"}},
        {"render/load/obj", {"render/load/model"}},
        {"render/load", {"render/load/pbrt", "render/load/gltf", "render/load/obj"}},
        {"render/program", {"render/transport/bidirectional", "render/load", "sampledb/write"}},
        {"render/preview", {"render/program", "tools/develop", "tools/convert"}},
        {"render/target", {"render/program", "tools/develop"}},
        {"render/main.cpp", {"render/preview", "render/target"}},

        {"tools/merge", {"sampledb/read"}},
        {"tools/develop/film", {"sampledb/data"}},
        {"tools/develop/lens", {"tools/develop/film", "sampledb/read", "color", "image"}},
        {"tools/develop/channels", {"tools/develop/film", "tools/develop/lens", "color/film"}},
        {"tools/develop/kernel", {"tools/develop/channels"}},
        {"tools/develop/engine", {"tools/develop/kernel"}},
        {"tools/develop/denoise", {"tools/develop/film"}},
        {"tools/develop/forecast", {"tools/develop/film"}},
        {"tools/develop/picture", {"tools/develop/engine", "tools/develop/denoise", "tools/develop/forecast"}},
        {"tools/develop/noise", {"tools/develop/picture"}},
        {"tools/develop", {"tools/develop/noise"}},
        {"tools/convert", {"color/film", "image"}},
        {"tools/print", {"tools/develop", "tools/convert"}},
        {"tools/darkroom/engine", {"tools/develop", "tools/convert"}},
        {"tools/darkroom/server", {"tools/darkroom/engine"}},
        {"tools/darkroom", {"tools/darkroom/server"}},
        {"tools/inspect", {"sampledb/write", "tools/develop"}},

        {"c_api", {"sampledb/write", "tools/merge"}},
        {"python", {"c_api", "tools/develop"}},
    };
    return table;
}

// The room of a path relative to the source tree: its folder, or a main that stands before inner rooms; "" if it is in none.
std::string room_of(const fs::path& path) {
    for (const std::string& room : {path.string(), path.parent_path().string()}) {
        if (arrows().count(room) != 0) return room;
    }
    return "";
}

// All that arrows lead to from `room`.
Rooms below(const std::string& room) {
    Rooms reached, open = arrows().at(room);
    while (!open.empty()) {
        const std::string next = *open.begin();
        open.erase(open.begin());
        if (reached.insert(next).second) open.insert(arrows().at(next).begin(), arrows().at(next).end());
    }
    return reached;
}

// "render" of "render/light/light.h".
std::string top_folder(const std::string& path) { return path.substr(0, path.find('/')); }
const Rooms kTopFolders = {"base", "color", "image", "sampledb", "render", "tools", "c_api", "python"};

// The name between quotes or brackets that a line includes; "" if there is none.
std::string included(std::string line) {
    constexpr std::string_view kInclude = "#include";
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    if (!line.starts_with(kInclude)) return "";
    const std::size_t end = line.find_first_of("\">", kInclude.size() + 1);
    return end == std::string::npos ? "" : line.substr(kInclude.size() + 1, end - kInclude.size() - 1);
}

// "FILE includes HEADER" for every include from a room to one that it may not know, and for every path that leads upwards.
std::vector<std::string> reversed_arrows(const std::string& file, std::istream& text) {
    std::vector<std::string> wrong;
    const std::string from = room_of(file);
    const Rooms allowed = below(from);
    std::string line;
    while (std::getline(text, line)) {
        const std::string header = included(line), to = room_of(header);
        if (header.find("..") != std::string::npos) wrong.push_back(file + " includes " + header);
        if (kTopFolders.count(top_folder(header)) == 0 || to == from) continue;
        if (allowed.count(to) == 0) wrong.push_back(file + " includes " + header);
    }
    return wrong;
}

// Headers and sources of the top folders, relative to the source tree.
std::vector<std::string> all_sources() {
    const fs::path tree = latent::testing::in_tree("");
    std::vector<std::string> files;
    for (const std::string& top : kTopFolders) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree / top)) {
            const fs::path& path = entry.path();
            if (path.extension() == ".h" || path.extension() == ".cpp") files.push_back(fs::relative(path, tree).string());
        }
    }
    return files;
}

std::string content(const std::string& file) {
    std::ifstream text(latent::testing::in_tree(file));
    return {std::istreambuf_iterator<char>(text), {}};
}

TEST(Structure, EveryFileIsInARoom) {
    EXPECT_GT(all_sources().size(), 100u);
    for (const std::string& file : all_sources()) EXPECT_NE(room_of(file), "") << file;
    EXPECT_EQ(room_of("render/math.h"), "");
    EXPECT_EQ(room_of("sampledb/codec/simd/planes.h"), "");
    EXPECT_EQ(room_of("render/transport/bidirectional/walk.cpp"), "render/transport/bidirectional");
}

// Sources whose header has another name: those behind an interface for other programs, of a module, or of a large part of a class.
const std::map<std::string, std::string>& other_headers() {
    static const std::map<std::string, std::string> table = {
        {"c_api/merge.cpp", "c_api/latent.h"},          {"c_api/reader.cpp", "c_api/latent.h"},
        {"c_api/writer.cpp", "c_api/latent.h"},         {"image/oiio/oiio_pictures.cpp", "image/pictures.h"},
        {"color/observer_csv.cpp", "color/observer.h"},
    };
    return table;
}

// Those of render: see EverySourceOfTheRendererHasAHeaderOfItsName.
TEST(Structure, EverySourceOutsideRenderHasAHeaderOfItsName) {
    const std::vector<std::string> files = all_sources();
    const std::set<std::string> there(files.begin(), files.end());
    for (const std::string& name : files) {
        const fs::path file = name;
        if (file.extension() != ".cpp" || file.filename() == "main.cpp" || name == "python/module.cpp" ||
            top_folder(name) == "render")
            continue;
        const auto other = other_headers().find(name);
        const std::string header = other == other_headers().end() ? fs::path(file).replace_extension(".h").string() : other->second;
        EXPECT_TRUE(there.contains(header)) << name << " has no " << header;
    }
}

TEST(Structure, EveryIncludePointsDownTheArrows) {
    for (const std::string& file : all_sources()) {
        if (room_of(file).empty()) continue;
        std::istringstream text(content(file));
        for (const std::string& wrong : reversed_arrows(file, text)) ADD_FAILURE() << wrong;
    }
}

TEST(Structure, AReversedArrowIsCaught) {
    const auto wrong = [](const std::string& file, const std::string& header) {
        std::istringstream quotes("  # include  \"" + header + "\"\n"), brackets("#include <" + header + ">\n");
        const std::size_t count = reversed_arrows(file, quotes).size();
        EXPECT_EQ(reversed_arrows(file, brackets).size(), count);
        return count;
    };
    EXPECT_EQ(wrong("sampledb/data/page.h", "render/scene/description.h"), 1u);
    EXPECT_EQ(wrong("tools/convert/convert.cpp", "sampledb/data/page.h"), 1u);
    EXPECT_EQ(wrong("tools/develop/engine/develop.cpp", "sampledb/write/part_writer.h"), 1u);
    EXPECT_EQ(wrong("tools/merge/merge.cpp", "c_api/latent.h"), 1u);
    EXPECT_EQ(wrong("render/bsdf/bsdf.h", "render/light/light.h"), 1u);
    EXPECT_EQ(wrong("render/bsdf/bsdf.h", "render/geometry/geometry.h"), 1u);  // side by side
    EXPECT_EQ(wrong("sampledb/format/run_frame.cpp", "sampledb/codec/page_decoder.h"), 1u);
    EXPECT_EQ(wrong("render/world/world.h", "render/world.h"), 1u);  // in no room
    EXPECT_EQ(wrong("render/bsdf/bsdf.h", "../light/light_set.h"), 1u);
    EXPECT_EQ(wrong("sampledb/data/page.h", "base/result.h"), 0u);
    EXPECT_EQ(wrong("render/world/world.h", "render/math/vec.h"), 0u);
    EXPECT_EQ(wrong("render/world/world.cpp", "hwy/highway.h"), 0u);
}

TEST(Structure, TheArrowsFormNoCircle) {
    for (const auto& [room, direct] : arrows()) EXPECT_EQ(below(room).count(room), 0u) << room;
}

TEST(Structure, EveryRoomSaysWhatItIsFor) {
    const std::string pages = content("README.md") + content("CONTRIBUTING.md");
    for (const auto& [room, direct] : arrows()) {
        const bool named = pages.find("`" + room + "/`") != std::string::npos || pages.find("`" + room + "`") != std::string::npos;
        EXPECT_TRUE(named) << room;
    }
}

TEST(Structure, EverySourceOfTheRendererHasAHeaderOfItsName) {
    for (const std::string& file : all_sources()) {
        if (top_folder(file) != "render" || fs::path(file).extension() != ".cpp" || file == "render/main.cpp") continue;
        EXPECT_TRUE(fs::exists(latent::testing::in_tree(fs::path(file).replace_extension(".h").string()))) << file;
    }
}

TEST(Structure, EveryMainIsATableOfContents) {
    for (const char* tool :
         {"render", "tools/merge", "tools/develop", "tools/convert", "tools/print", "tools/darkroom", "tools/inspect"}) {
        const std::string main = content(std::string(tool) + "/main.cpp");
        ASSERT_FALSE(main.empty()) << tool;
        EXPECT_LT(std::count(main.begin(), main.end(), '\n'), 120) << tool;
    }
}

}  // namespace
