// The glare of lenses and eyes: its pattern against optics, and prints that have it.
#include "tools/convert/glare.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "image/convolver.h"
#include "image/exr_reader.h"
#include "tests/convert/test_picture.h"

namespace latent::convert {
namespace {

using ::testing::HasSubstr;

image::Kernel pattern_of(const std::string& glare, double pixel_um, double nm) {
    const Result<image::Kernel> kernel =
        lens_kernel(*parse_glare(glare), pixel_um, {{nm, {1, 1, 1}}}, image::Convolver::kMaxRadius);
    EXPECT_TRUE(kernel);
    return *kernel;
}

double total(const image::Kernel& kernel) {
    double sum = 0;
    for (const float v : kernel.plane(0)) sum += static_cast<double>(v);
    return sum;
}

TEST(Glare, ARoundApertureIsDarkFirstAt1Point22LambdaN) {
    for (const double nm : {450.0, 550.0, 650.0}) {
        for (const double f_number : {8.0, 16.0}) {
            const image::Kernel kernel = pattern_of("f:" + std::to_string(f_number), 1, nm);
            int dark = 1;
            while (kernel.at(0, dark + 1, 0) < kernel.at(0, dark, 0)) ++dark;
            EXPECT_NEAR(dark, 1.2197 * nm / 1000 * f_number, 1) << nm << " nm, f/" << f_number;
            EXPECT_NEAR(total(kernel), 1, 2e-3);  // what goes farther than half the reach is faded
        }
    }
}

// [BornWolf99] 8.5.2: within radius r, 1 - J0^2(v) - J1^2(v), v = pi r / (lambda N).
TEST(Glare, ARoundAperturesLightLiesWithinRadiiAsRayleighFound) {
    const image::Kernel kernel = pattern_of("f:16", 1, 550);
    for (const double radius : {8.0, 15.0, 30.0, 60.0, 120.0}) {
        double sum = 0;
        for (int y = -130; y <= 130; ++y) {
            for (int x = -130; x <= 130; ++x) sum += std::hypot(x, y) <= radius ? static_cast<double>(kernel.at(0, x, y)) : 0;
        }
        const double v = std::numbers::pi * radius / (0.55 * 16), j0 = std::cyl_bessel_j(0, v), j1 = std::cyl_bessel_j(1, v);
        EXPECT_NEAR(sum, 1 - j0 * j0 - j1 * j1, 0.01) << radius;
    }
}

TEST(Glare, BladesMakeStarsOfAsManyRaysOrTwiceAsManyIfTheyAreOdd) {
    for (const auto& [blades, rays] : {std::pair{6, 6}, {8, 8}, {5, 10}, {7, 14}}) {
        constexpr double kTurned = 4;  // degrees, which no polygon here has as a symmetry
        const image::Kernel kernel = pattern_of(fmt::format("f:16,blades:{}:{}", blades, kTurned), 4, 550);
        EXPECT_NEAR(total(kernel), 1, 4e-3);
        constexpr int kDirections = 720;
        std::vector<double> light(kDirections);
        for (int y = -150; y <= 150; ++y) {
            for (int x = -150; x <= 150; ++x) {
                const double r = std::hypot(x, y);
                if (r < 100 || r > 150) continue;
                const double turn = (std::atan2(y, x) + std::numbers::pi) / (2 * std::numbers::pi);
                light[static_cast<std::size_t>(turn * kDirections) % kDirections] += static_cast<double>(kernel.at(0, x, y));
            }
        }
        const double mean = total(kernel) > 0 ? std::accumulate(light.begin(), light.end(), 0.0) / kDirections : 0;
        int found = 0;
        bool inside = false;
        for (const double l : light) inside = l > 3 * mean || (inside && l >= mean);  // at the end, which is the beginning
        for (const double l : light) {
            if (l > 3 * mean && !inside) ++found;
            // Rays are several directions wide and do not touch.
            if (l > 3 * mean) inside = true;
            if (l < mean) inside = false;
        }
        EXPECT_EQ(found, rays) << blades;
        // They are perpendicular to the blades; rows of the picture run downwards.
        for (int blade = 0; blade < blades; ++blade) {
            const double turn = 1.5 - (kTurned / 360 + (blade + 0.5) / blades);
            const auto at = static_cast<std::size_t>(turn * kDirections);
            EXPECT_GT(std::max({light[(at - 1) % kDirections], light[at % kDirections], light[(at + 1) % kDirections]}), 3 * mean);
        }
    }
}

TEST(Glare, IsWiderInRedThanInBlue) {
    const image::Kernel red = pattern_of("f:8", 2, 650), blue = pattern_of("f:8", 2, 450);
    EXPECT_LT(red.at(0, 0, 0), blue.at(0, 0, 0));
}

// The general glare equation of [CIE146], to its own accuracy, from 2 to 30 degrees.
TEST(Glare, AnEyesVeilIsThatOfTheGeneralGlareEquation) {
    constexpr double kPixel = 0.1, kPigment = 0.5;
    const double steradians = std::pow(kPixel * std::numbers::pi / 180, 2);
    double younger = 0;
    for (const double age : {25.0, 75.0}) {
        const image::Kernel kernel = eye_kernel(*parse_glare("eye,age:" + std::to_string(age)), kPixel, 300);
        for (const int x : {20, 50, 100, 200, 300}) {
            const double theta = x * kPixel;
            const double expected = 10 / (theta * theta * theta) +
                                    (5 / (theta * theta) + 0.1 * kPigment / theta) * (1 + std::pow(age / 62.5, 4)) +
                                    0.0025 * kPigment;
            EXPECT_NEAR(static_cast<double>(kernel.at(0, x, 0)) / steradians / expected, 1, 0.2) << theta << " degrees, " << age;
        }
        EXPECT_LT(total(kernel), 1);
        EXPECT_GT(total(kernel), younger);
        younger = total(kernel);
    }
}

class GlarePrint : public PrintTest {
 protected:
    static std::array<float, 3> lamps(int x, int y) {
        std::array<float, 3> light = colourful(x, y);
        if ((x == 150 && y == 100) || (x == 3 && y == 5)) light = {2000, 3000, 1000};
        return light;
    }
};

TEST_F(GlarePrint, IsTheSameForAnyThreadsMemoryFileAndCrop) {
    write_picture(folder_ / "a.exr", {}, lamps);
    write_picture(folder_ / "tiled.exr", {.tile = 32, .zip = true}, lamps);
    for (const char* glare : {"blades:6,f:22", "eye"}) {
        ConvertOptions options;
        options.glare = *parse_glare(glare);
        options.threads = 1;
        options.replace = true;
        const std::vector<float> whole = light("a.exr", "whole.exr", options);
        options.threads = 3;
        options.memory = 128 << 20;
        EXPECT_EQ(light("a.exr", "b.exr", options), whole);
        EXPECT_EQ(light("tiled.exr", "c.exr", options), whole);
        options.crop = image::Rect{33, 21, 133, 71};
        const std::vector<float> crop = light("tiled.exr", "d.exr", options);
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t y = 0; y < 50; ++y) {
                for (std::size_t x = 0; x < 100; ++x)
                    ASSERT_EQ(crop[(c * 50 + y) * 100 + x], whole[(c * 200 + y + 21) * 300 + x + 33]);
            }
        }
    }
}

TEST_F(GlarePrint, MovesLightButLosesNone) {
    write_picture(folder_ / "a.exr", {}, lamps);
    const std::vector<float> before = light("a.exr", "before.exr", {});
    for (const char* glare : {"f:64", "blades:5,f:22", "eye"}) {
        ConvertOptions options;
        options.glare = *parse_glare(glare);
        options.replace = true;
        const std::vector<float> after = light("a.exr", "after.exr", options);
        ASSERT_EQ(after.size(), before.size());
        for (std::size_t c = 0; c < 3; ++c) {
            const auto sum = [&](const std::vector<float>& v) {
                return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(c * 60000),
                                       v.begin() + static_cast<std::ptrdiff_t>((c + 1) * 60000), 0.0);
            };
            EXPECT_NEAR(sum(after) / sum(before), 1, 1e-5) << glare;
        }
        const std::size_t lamp = 60000 + 100 * 300 + 150;
        EXPECT_LT(after[lamp], 0.99F * before[lamp]);
        EXPECT_GT(after[lamp + 4], before[lamp + 4]);
    }
}

// A small kernel on a larger picture makes many tiles, whose rows wait in a file that is written over and over.
TEST_F(GlarePrint, OfManyTilesIsOnePicture) {
    constexpr int kWidth = 900, kHeight = 700;
    write_picture(folder_ / "a.exr", {.width = kWidth, .height = kHeight}, lamps);
    write_picture(folder_ / "tiled.exr", {.width = kWidth, .height = kHeight, .tile = 32, .zip = true}, lamps);
    const std::vector<float> before = light("a.exr", "before.exr", {});
    ConvertOptions options;
    options.glare = *parse_glare("blades:6,f:2");
    options.replace = true;
    options.threads = 1;
    const std::vector<float> whole = light("a.exr", "whole.exr", options);
    EXPECT_NEAR(std::accumulate(whole.begin(), whole.end(), 0.0) / std::accumulate(before.begin(), before.end(), 0.0), 1, 1e-5);
    options.threads = 3;
    options.memory = 64 << 20;
    EXPECT_EQ(light("tiled.exr", "b.exr", options), whole);
    options.crop = image::Rect{133, 421, 733, 671};
    const std::vector<float> crop = light("a.exr", "c.exr", options);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t y = 0; y < 250; ++y) {
            for (std::size_t x = 0; x < 600; ++x)
                ASSERT_EQ(crop[(c * 250 + y) * 600 + x], whole[(c * kHeight + y + 421) * kWidth + x + 133]);
        }
    }
}

TEST_F(GlarePrint, ShapesAreRefusedWithWhatWouldDo) {
    for (const auto& [text, why] : {std::pair{"blades:2,f:8", "3 to 64 blades"},
                                    {"blades:6.5", "3 to 64 blades"},
                                    {"blades:6:400", "a rotation"},
                                    {"f:0", "0.5 to 1000"},
                                    {"f:x", "not a kind of glare"},
                                    {"f:8:9", "0.5 to 1000"},
                                    {"lens", "not a kind of glare"},
                                    {"", "not a kind of glare"},
                                    {"f:8,eye", "not a kind of glare"},
                                    {"eye,f:8", "age and field only"},
                                    {"f:8,age:50", "those of an eye"},
                                    {"eye,age:500", "0 to 100 years"},
                                    {"blades:6,f:8,colour:3", "not part of a glare"},
                                    {"a.exr,blades:6", "needs no blades"}}) {
        const Result<Glare> glare = parse_glare(text);
        ASSERT_FALSE(glare) << text;
        EXPECT_EQ(glare.error().code, ErrorCode::kUsage);
        EXPECT_THAT(glare.error().message, HasSubstr(why));
    }
    write_picture(folder_ / "a.exr", {});
    write_picture(folder_ / "black.exr", {}, [](int, int) { return std::array{0.0F, 0.0F, 0.0F}; });
    const auto refused = [&](const std::string& glare, const std::string& memory = "512M") {
        const testing::Outcome done = run_tool({at("a.exr"), "-o", at("a.png"), "--glare", glare, "--memory", memory});
        EXPECT_EQ(done.status, memory == "512M" ? 1 : 2);
        EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
        return done.err;
    };
    EXPECT_THAT(refused(at("none.exr") + ",f:8"), HasSubstr("none.exr"));
    EXPECT_THAT(refused(at("black.exr") + ",f:8"), HasSubstr("no light passes"));
    EXPECT_THAT(refused("f:22", "4M"), HasSubstr("needs at least"));
}

// cos^4 at the centre of each pixel: (1 + x^2 + y^2)^-2 in a window at unit distance, of the whole picture.
TEST_F(GlarePrint, AVignetteIsTheFourthPowerOfTheCosine) {
    write_picture(folder_ / "a.exr", {}, [](int, int) { return std::array{1.0F, 2.0F, 3.0F}; });
    write_picture(folder_ / "tiled.exr", {.tile = 32}, [](int, int) { return std::array{1.0F, 2.0F, 3.0F}; });
    const std::vector<float> before = light("a.exr", "before.exr", {});
    ConvertOptions options;
    options.replace = true;
    options.vignette = *parse_vignette("cos4:60");
    const std::vector<float> whole = light("a.exr", "whole.exr", options);
    const double half = std::tan(std::numbers::pi / 6);  // of 300 x 200 pixels
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t y = 0; y < 200; ++y) {
            for (std::size_t x = 0; x < 300; ++x) {
                const double wx = (static_cast<double>(x) - 149.5) / 150 * half, wy = (static_cast<double>(y) - 99.5) / 150 * half;
                const double cosine = 1 / std::sqrt(1 + wx * wx + wy * wy);
                const std::size_t at = (c * 200 + y) * 300 + x;
                const double expected = std::pow(cosine, 4) * static_cast<double>(before[at]);
                ASSERT_NEAR(static_cast<double>(whole[at]), expected, 1e-6 * expected);
            }
        }
    }
    options.crop = image::Rect{33, 21, 133, 71};
    const std::vector<float> crop = light("tiled.exr", "crop.exr", options);
    for (std::size_t y = 0; y < 50; ++y) {
        for (std::size_t x = 0; x < 100; ++x) ASSERT_EQ(crop[y * 100 + x], whole[(y + 21) * 300 + x + 33]);
    }
    // What glare spreads has fallen off already: it moves light from the bright middle, and loses none.
    options.crop.reset();
    options.glare = *parse_glare("f:64");
    const std::vector<float> spread = light("a.exr", "spread.exr", options);
    EXPECT_NEAR(std::accumulate(spread.begin(), spread.end(), 0.0) / std::accumulate(whole.begin(), whole.end(), 0.0), 1, 1e-5);
    EXPECT_LT(spread[100 * 300 + 150], whole[100 * 300 + 150]);
    for (const char* bad : {"", "cos3", "cos4:0", "cos4:151", "cos4:40:2", "cos4:x"}) EXPECT_FALSE(parse_vignette(bad)) << bad;
}

// A picture of a round hole is a round hole.
TEST_F(GlarePrint, AnApertureMayBeAPicture) {
    write_picture(folder_ / "hole.exr", {.width = 400, .height = 400}, [](int x, int y) {
        return std::hypot(x - 199.5, y - 199.5) < 200 ? std::array{1.0F, 1.0F, 1.0F} : std::array{0.0F, 0.0F, 0.0F};
    });
    const image::Kernel drawn = pattern_of(at("hole.exr") + ",f:16", 4, 550), round = pattern_of("f:16", 4, 550);
    for (int x = 0; x <= 20; ++x) EXPECT_NEAR(drawn.at(0, x, 0), round.at(0, x, 0), 0.01 * round.at(0, 0, 0)) << x;
}

}  // namespace
}  // namespace latent::convert
