// Looks: what goes with a film.
#include "tools/convert/looks.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Looks : public PrintTest {
 protected:
    void write(const std::string& film) const {
        write_picture(folder_ / "film.exr",
                      {.width = 96,
                       .height = 64,
                       .chromaticities = std::nullopt,
                       .texts = {{"latentFilm", film}, {"latentExposureIndex", "400"}, {"latentPush", "0"}}},
                      [](int x, int y) {
                          std::array<float, 3> light = colourful(x, y);
                          for (float& v : light) v *= 0.14F;
                          return light;
                      });
    }
    std::string run(std::vector<std::string> more, int status = 0) const {
        more.insert(more.begin(), {at("film.exr"), "-o", at("a.png"), "--force"});
        const testing::Outcome done = run_tool(more);
        EXPECT_EQ(done.status, status) << done.err;
        return done.out + done.err;
    }
    Bytes pixels() const { return image::decode_png(folder_ / "a.png").pixels; }
};

TEST_F(Looks, AllTwelveOfTheListPrintTheirFilm) {
    std::istringstream list(list_looks());
    std::string line, name, tool, option, film;
    std::getline(list, line);
    int looks = 0;
    while (list >> name >> tool >> option >> film && std::getline(list, line)) {
        SCOPED_TRACE(name);
        write(film);
        EXPECT_THAT(run({"--look", name}), HasSubstr("film           "));
        ++looks;
    }
    EXPECT_EQ(looks, 12);
}

TEST_F(Looks, AreTheirOptionsAndYieldToThoseThatAreGiven) {
    write("portra-400");
    run({"--look", "portrait"});
    const Bytes look = pixels();
    run({"--paper", "endura", "--format", "6x7", "--grain", "--mtf", "--halation", "backed"});
    EXPECT_EQ(pixels(), look);
    run({"--look", "portrait", "--no-grain", "--no-mtf", "--halation", "none", "--paper", "supra-endura"});
    const Bytes other = pixels();
    EXPECT_NE(other, look);
    run({"--paper", "supra-endura"});
    EXPECT_EQ(pixels(), other);
}

TEST_F(Looks, FullIsAllThatHasASizeOnAnyFilmAsFarAsItIsKnown) {
    write("gold-200");
    EXPECT_THAT(run({"--look", "full"}, 2), HasSubstr("add --paper endura"));
    EXPECT_THAT(run({"--look", "full", "--paper", "endura"}), Not(HasSubstr("note")));
    const Bytes full = pixels();
    run({"--paper", "endura", "--grain", "--mtf", "--halation", "backed"});
    EXPECT_EQ(pixels(), full);
    write("tri-x-400");
    EXPECT_THAT(run({"--look", "full", "--paper", "polymax"}), HasSubstr("its sharpness is not known, and is left out"));
    const Bytes grainy = pixels();
    run({"--paper", "polymax", "--grain", "--halation", "backed"});
    EXPECT_EQ(pixels(), grainy);
    write_picture(folder_ / "film.exr", {});
    EXPECT_THAT(run({"--look", "full", "--paper", "endura"}, 2), HasSubstr("holds no exposures of a film"));
}

TEST_F(Looks, OfAnotherFilmOrNoneSayWhichToDevelopWith) {
    write("gold-200");
    EXPECT_THAT(run({"--look", "portrait"}, 2),
                HasSubstr("is on gold-200, but the look 'portrait' is that of portra-400; develop with --film portra-400"));
    EXPECT_THAT(run({"--look", "portrai"}, 2), HasSubstr("--list-looks shows all"));
    write_picture(folder_ / "film.exr", {});
    EXPECT_THAT(run({"--look", "noir"}, 2), HasSubstr("holds no exposures of a film"));
}

}  // namespace
}  // namespace latent::convert
