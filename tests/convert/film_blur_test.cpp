// Light that spreads in the film.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "image/convolver.h"
#include "tests/convert/test_picture.h"
#include "tools/convert/film_kernel.h"
#include "tools/convert/spread_light.h"

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
        const image::Kernel kernel = sharpness_kernel(half, pixel_um, image::Convolver::kMaxRadius);
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
        const image::Kernel kernel = returned_kernel(share, pixel_um, image::Convolver::kMaxRadius);
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
    for (const double frame_mm : {8.0, 1.0}) {  // light returns from pixel to pixel, and in cells of 3 x 3
        ConvertOptions options;
        options.replace = true;
        options.darkroom.paper = "endura";
        options.darkroom.frame_mm = frame_mm;
        const Bytes sharp = pixels("sharp.png", options);
        options.darkroom.halation = Halation::kBare;
        options.darkroom.mtf = true;
        options.darkroom.grain = true;
        if (frame_mm > 1) options.glare = *parse_glare("f:11");
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
}

// Pixels of 5 um, after light has returned in cells of `cell` pixels: of the layer that sees red.
class ReturnedLight : public PrintTest {
 protected:
    static constexpr int kSide = 421;  // pixels, and no multiple of a cell
    std::vector<float> pixels(const Light& light, int cell) const {
        write_picture(folder_ / "film.exr", {.width = kSide, .height = kSide}, light);
        ConvertOptions options;
        options.input = folder_ / "film.exr";
        const auto source = open_source(options);
        EXPECT_TRUE(source);
        const image::Rect picture{0, 0, kSide, kSide};
        const auto plan = plan_bands(source->reader.image(), picture, {}, 1 << 30, 1);
        const auto rows =
            light_rows(*source, {.near = std::nullopt, .far = returned_kernel({0.1, 0, 0}, 5.0 * cell, 1024), .cell = cell}, *plan,
                       folder_.path(), 1);
        EXPECT_TRUE(rows && (*rows)->make(kSide));
        std::vector<float> out(picture.pixels());
        for (int y = 0; y < kSide; ++y)
            EXPECT_TRUE((*rows)->read(0, 0, y, std::span(out).subspan(static_cast<std::size_t>(y) * kSide, kSide)));
        return out;
    }
};

TEST_F(ReturnedLight, OfALampIsTheSameInCellsButForAFiftiethOfIt) {
    constexpr int kLamp = 207;
    const auto lamp = [](int x, int y) { return std::array<float, 3>{x == kLamp && y == kLamp ? 1.0F : 0.0F, 0, 0}; };
    const std::vector<float> exact = pixels(lamp, 1), in_cells = pixels(lamp, 2);
    double moved = 0, sum = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        sum += static_cast<double>(in_cells[i]);
        if (i != kLamp * kSide + kLamp) moved += std::abs(static_cast<double>(in_cells[i] - exact[i])) / 2;
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    // Integrals of the ring, blurred by cells of 10 um whose middle is 3.5 um from the lamp, give 0.015.
    EXPECT_LT(moved, 0.02 * 0.1);
    EXPECT_GT(moved, 0);
}

TEST_F(ReturnedLight, LeavesAnEvenPictureEvenToItsEdges) {
    for (const float value : pixels([](int, int) { return std::array<float, 3>{0.7F, 0, 0}; }, 2)) ASSERT_NEAR(value, 0.7, 1e-6);
}

TEST_F(ReturnedLight, OfAPixelThatIsNoNumberIsNone) {
    const auto broken = [](int x, int y) {
        return std::array<float, 3>{x == 100 && y == 100 ? std::numeric_limits<float>::quiet_NaN() : 0.5F, 0, 0};
    };
    const std::vector<float> out = pixels(broken, 2);
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(std::isnan(out[i]), i == 100 * kSide + 100);
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
