// The pictures of docs/darkroom.md and docs/film.md are made by the script that says so.
#include <regex>

#include "tests/darkroom/darkroom.h"
#include "tests/support/paths.h"

namespace latent::testing {
namespace {

TEST(Tour, MakesEveryPictureOfItsPages) {
    if (run({"/bin/sh", "-c", "command -v oiiotool"}).status != 0) GTEST_SKIP() << "oiiotool is missing: scripts/install test";
    const std::filesystem::path source = in_tree("");
    const TemporaryFolder folder;
    const Outcome outcome =
        run({(source / "scripts/tour").string(), folder.path().string(), "72", "4"}, {{"LATENT_BIN", tools_folder()}});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string page = read_text(source / "docs/darkroom.md") + read_text(source / "docs/film.md");
    const std::regex picture(R"(\(images/darkroom/([a-z]+\.jpg)\))");
    int pictures = 0;
    for (std::sregex_iterator i(page.begin(), page.end(), picture); i != std::sregex_iterator(); ++i, ++pictures) {
        EXPECT_TRUE(std::filesystem::exists(folder.path() / i->str(1))) << i->str(1);
        EXPECT_TRUE(std::filesystem::exists(source / "docs/images/darkroom" / i->str(1))) << i->str(1);
    }
    EXPECT_EQ(pictures, 19);
}

}  // namespace
}  // namespace latent::testing
