// Light that spreads in the film.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "image/convolver.h"
#include "tests/convert/test_picture.h"
#include "tools/convert/film_kernel.h"

namespace latent::convert {
namespace {

// Contrast of waves along x.
double response(const image::Kernel& kernel, std::size_t channel, double cycles_per_pixel) {
    double sum = 0, all = 0;
    for (int y = -kernel.radius(); y <= kernel.radius(); ++y) {
        for (int x = -kernel.radius(); x <= kernel.radius(); ++x) {
            if (x == 0 && y == 0) continue;
            sum += static_cast<double>(kernel.at(channel, x, y)) * std::cos(2 * std::numbers::pi * cycles_per_pixel * x);
            all += static_cast<double>(kernel.at(channel, x, y));
        }
    }
    return 1 - all + sum;
}

TEST(FilmKernel, KeepsAsMuchContrastAsTheFilm) {
    const film::Triple half{35, 50, 65};
    for (const double pixel_um : {1.5, 3.0}) {
        const image::Kernel kernel = film_kernel({half, {}}, pixel_um, image::Convolver::kMostRadius);
        for (std::size_t c = 0; c < 3; ++c) {
            for (const double cycles_per_mm : {10.0, 30.0, 60.0}) {
                // Pixels that wide lose a few per cent themselves.
                const double wave = std::numbers::pi * cycles_per_mm * pixel_um / 1000, pixel = std::pow(std::sin(wave) / wave, 2);
                EXPECT_NEAR(response(kernel, c, cycles_per_mm * pixel_um / 1000), film::contrast_left(half[c], cycles_per_mm),
                            0.01 + (1 - pixel))
                    << cycles_per_mm << " cycles/mm, " << pixel_um << " um";
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            for (const float weight : kernel.plane(c)) ASSERT_GE(weight, -1e-6F);
        }
    }
}

TEST(FilmKernel, ReturnsItsShareOfTheLightWithinAMillimetre) {
    const film::Triple share{0.1, 0.04, 0};
    for (const double pixel_um : {5.0, 36.0}) {
        const image::Kernel kernel = film_kernel({std::nullopt, share}, pixel_um, image::Convolver::kMostRadius);
        for (std::size_t c = 0; c < 3; ++c) {
            double returned = 0;
            for (int y = -kernel.radius(); y <= kernel.radius(); ++y) {
                for (int x = -kernel.radius(); x <= kernel.radius(); ++x) {
                    if (x != 0 || y != 0) returned += static_cast<double>(kernel.at(c, x, y));
                }
            }
            EXPECT_NEAR(returned, share[c], 0.001) << pixel_um;
        }
        // As the film is, not as the pixels are: the ring is 229 um away.
        const int ring = static_cast<int>(std::lround(260 / pixel_um));
        EXPECT_GT(kernel.at(0, ring, 0), 3 * kernel.at(0, static_cast<int>(std::lround(130 / pixel_um)), 0));
    }
}

class FilmBlurPrint : public PrintTest {
 protected:
    void write(const std::string& name, const std::string& film) const {
        write_picture(
            folder_ / name,
            {.chromaticities = std::nullopt, .texts = {{"latentFilm", film}, {"latentExposureIndex", "400"}, {"latentPush", "0"}}},
            [](int x, int y) {
                std::array<float, 3> light = colourful(x, y);
                for (float& v : light) v *= x == 100 && y == 90 ? 200 : 0.14F;
                return light;
            });
    }
    Bytes pixels(const std::string& output, const ConvertOptions& options) const {
        const Result<ConvertReport> report = print("film.exr", output, options);
        EXPECT_TRUE(report) << (report ? "" : report.error().message);
        return report ? image::decode_png(folder_ / output).pixels : Bytes{};
    }
    void SetUp() override { write("film.exr", "portra-400"); }
};

TEST_F(FilmBlurPrint, IsTheSameForAnyThreadsMemoryAndCrop) {
    ConvertOptions options;
    options.darkroom.paper = "endura";
    options.darkroom.frame_mm = 8;
    const Bytes sharp = pixels("sharp.png", options);
    options.darkroom.halation = Halation::kBare;
    options.darkroom.mtf = true;
    options.darkroom.grain = true;
    options.glare = *parse_glare("f:11");
    options.threads = 1;
    const Bytes whole = pixels("a.png", options);
    EXPECT_NE(whole, sharp);
    options.threads = 3;
    options.memory = 160 << 20;
    EXPECT_EQ(pixels("b.png", options), whole);
    options.crop = image::Rect{33, 21, 133, 71};
    const Bytes crop = pixels("c.png", options);
    for (std::size_t y = 0; y < 50; ++y) {
        for (std::size_t i = 0; i < 300; ++i) ASSERT_EQ(crop[y * 300 + i], whole[(y + 21) * 900 + 99 + i]);
    }
}

TEST_F(FilmBlurPrint, NeedsAFilmWhoseSharpnessIsKnown) {
    write_picture(folder_ / "plain.exr", {});
    write("tri-x.exr", "tri-x-400");
    const auto refused = [&](const std::string& input, std::vector<std::string> more) {
        more.insert(more.begin(), {at(input), "-o", at("a.png")});
        const testing::Outcome done = run_tool(more);
        EXPECT_NE(done.status, 0);
        return done.err;
    };
    EXPECT_THAT(refused("plain.exr", {"--mtf"}), ::testing::HasSubstr("--mtf: needs --paper"));
    EXPECT_THAT(refused("plain.exr", {"--halation", "bare"}), ::testing::HasSubstr("--halation: needs --paper"));
    EXPECT_THAT(refused("film.exr", {"--paper", "endura", "--halation", "much"}), ::testing::HasSubstr("none, backed, bare"));
    EXPECT_THAT(refused("tri-x.exr", {"--paper", "polymax", "--mtf"}), ::testing::HasSubstr("its sharpness is not known"));
}

}  // namespace
}  // namespace latent::convert
