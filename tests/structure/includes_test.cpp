// The arrows of README.md's diagram, read from the includes: libraries build on base, programs on libraries, nothing points back.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Rooms = std::set<std::string>;

// Room -> rooms whose headers it may include, besides its own.
const std::map<std::string, Rooms>& arrows() {
    static const std::map<std::string, Rooms> table = {
        {"base", {}},
        {"sampledb", {"base"}},
        {"color", {"base"}},
        {"image", {"base"}},
        {"render", {"base", "sampledb", "color", "image"}},
        {"tools/merge", {"base", "sampledb"}},
        {"tools/develop", {"base", "sampledb", "color", "image"}},
        {"tools/convert", {"base", "color", "image"}},
        {"tools/inspect", {"base", "sampledb"}},
    };
    return table;
}

// The room of a path relative to the source tree; "" if it is in none.
std::string room_of(const std::string& path) {
    for (const auto& [room, allowed] : arrows()) {
        if (path.rfind(room + "/", 0) == 0) return room;
    }
    return "";
}

bool is_source(const fs::path& path) { return path.extension() == ".h" || path.extension() == ".cpp"; }

// The name between quotes that a line includes; "" if there is none.
std::string included(std::string line) {
    constexpr std::string_view kInclude = "#include\"";
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    return line.starts_with(kInclude) ? line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size()) : "";
}

// "FILE includes HEADER" for every include from a room to one that it may not know.
std::vector<std::string> reversed_arrows(const std::string& file, std::istream& text) {
    std::vector<std::string> wrong;
    const std::string from = room_of(file);
    std::string line;
    while (std::getline(text, line)) {
        const std::string header = included(line), to = room_of(header);
        if (!to.empty() && to != from && arrows().at(from).count(to) == 0) wrong.push_back(file + " includes " + header);
    }
    return wrong;
}

TEST(Structure, EveryIncludePointsDownTheArrows) {
    const fs::path source = LATENT_SOURCE_DIR;
    std::size_t files = 0;
    for (const auto& [room, allowed] : arrows()) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source / room)) {
            if (!entry.is_regular_file() || !is_source(entry.path())) continue;
            ++files;
            std::ifstream text(entry.path());
            for (const std::string& wrong : reversed_arrows(fs::relative(entry.path(), source).string(), text))
                ADD_FAILURE() << wrong;
        }
    }
    EXPECT_GT(files, 10u);
}

TEST(Structure, AReversedArrowIsCaught) {
    std::istringstream up("#include \"render/scene.h\"\n");
    EXPECT_EQ(reversed_arrows("sampledb/data/page.h", up).size(), 1u);
    std::istringstream across("  # include  \"sampledb/data/page.h\"\n");
    EXPECT_EQ(reversed_arrows("tools/convert/convert.cpp", across).size(), 1u);
    std::istringstream down("#include \"base/result.h\"\n");
    EXPECT_TRUE(reversed_arrows("sampledb/data/page.h", down).empty());
}

TEST(Structure, EveryMainIsATableOfContents) {
    for (const char* tool : {"render", "tools/merge", "tools/develop", "tools/convert", "tools/inspect"}) {
        const fs::path main = fs::path(LATENT_SOURCE_DIR) / tool / "main.cpp";
        std::ifstream text(main);
        ASSERT_TRUE(text) << main;
        const auto lines = std::count(std::istreambuf_iterator<char>(text), {}, '\n');
        EXPECT_LT(lines, 120) << main;
    }
}

}  // namespace
