// Textures: values at points computed by hand, filters that keep means and edges.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "render/sampling/random.h"
#include "render/texture/footprint.h"
#include "render/texture/noise.h"
#include "render/texture/procedural.h"
#include "render/texture/textures.h"
#include "tests/faults/process.h"
#include "tests/render/textures.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using ::testing::ElementsAre;
using testing::Folder;
using ::testing::HasSubstr;
using testing::TextureTest;

TEST_F(TextureTest, ScaleMultipliesAndMixWeighs) {
    load_float(
        "\"mix\" \"float tex1\" 2 \"texture tex2\" \"five\" \"float amount\" .25\n"
        "Texture \"five\" \"float\" \"scale\" \"float tex\" 10 \"float scale\" .5");
    EXPECT_FLOAT_EQ(at(0, 0), 0.75f * 2 + 0.25f * 5);
    load_spectrum("\"scale\" \"rgb tex\" [.5 .5 .5] \"float scale\" .5");
    for (const float x : spectrum_at(0, 0).v) EXPECT_EQ(x, 0.25f);
}

TEST_F(TextureTest, MappingsLeadToWhereTheyShould) {
    // A ramp along s, and one along t.
    const auto ramp_s = [](const std::string& mapping) { return "\"bilerp\" \"float v10\" 1 \"float v01\" 0 " + mapping; };
    const auto ramp_t = [](const std::string& mapping) { return "\"bilerp\" \"float v11\" 1 " + mapping; };
    load_float(ramp_s("\"float uscale\" 3 \"float udelta\" .25"));
    EXPECT_FLOAT_EQ(at(0.5f, 0.125f), 1.75f);
    load_float(ramp_t("\"float vscale\" 2 \"float vdelta\" -1"));
    EXPECT_FLOAT_EQ(at(0.5f, 0.125f), -0.75f);
    // pbrt's spherical mapping: s is the angle from z over pi, t the angle about it over 2 pi.
    load_float(ramp_s("\"string mapping\" \"spherical\""));
    EXPECT_NEAR(at(Vec3f(0, 2, 2)), 0.25f, 1e-6);
    EXPECT_NEAR(at(Vec3f(0, 0, -3)), 1, 1e-6);
    load_float(ramp_t("\"string mapping\" \"spherical\""));
    EXPECT_NEAR(at(Vec3f(0, 2, 2)), 0.25f, 1e-6);
    EXPECT_NEAR(at(Vec3f(0, -2, 2)), 0.75f, 1e-6);
    load_float(ramp_s("\"string mapping\" \"cylindrical\""));
    EXPECT_NEAR(at(Vec3f(0, 2, 7)), 0.75f, 1e-6);
    load_float(ramp_t("\"string mapping\" \"cylindrical\""));
    EXPECT_NEAR(at(Vec3f(0, 2, 7)), 7, 1e-6);
    load_float(ramp_s("\"string mapping\" \"planar\" \"vector3 v1\" [2 1 0] \"float udelta\" .5"));
    EXPECT_NEAR(at(Vec3f(1, 3, 9)), 5.5f, 1e-6);
    load_float(ramp_t("\"string mapping\" \"planar\" \"vector3 v2\" [0 0 .5]"));
    EXPECT_NEAR(at(Vec3f(1, 3, 9)), 4.5f, 1e-6);
}

TEST_F(TextureTest, MappingsFollowTheTransformationAndTheOriginOfTheScene) {
    load(
        "Translate 10 0 0\nScale 2 2 2\nTexture \"t\" \"float\" \"bilerp\" \"float v10\" 1 \"float v01\" 0 \"string mapping\" "
        "\"planar\"\nTexture \"s\" \"spectrum\" \"constant\"\nIdentity\nTranslate 100 0 0\n");
    EXPECT_NE(scene_.origin, Vec3d());
    EXPECT_NEAR(at(Vec3f(Vec3d(16, 0, 0) - scene_.origin)), 3, 1e-5);
}

TEST_F(TextureTest, BilerpMeetsItsCorners) {
    load_float("\"bilerp\" \"float v00\" 1 \"float v01\" 2 \"float v10\" 3 \"float v11\" 4");
    EXPECT_FLOAT_EQ(at(0, 0), 1);
    EXPECT_FLOAT_EQ(at(0, 1), 2);
    EXPECT_FLOAT_EQ(at(1, 0), 3);
    EXPECT_FLOAT_EQ(at(1, 1), 4);
    EXPECT_FLOAT_EQ(at(0.5f, 0.25f), 2.25f);
}

TEST_F(TextureTest, CheckerboardAlternates) {
    load_float("\"checkerboard\" \"float tex1\" 3 \"float tex2\" 7 \"float uscale\" 4 \"float vscale\" 4");
    EXPECT_EQ(at(0.1f, 0.1f), 3);
    EXPECT_EQ(at(0.3f, 0.1f), 7);
    EXPECT_EQ(at(0.3f, 0.3f), 3);
    EXPECT_EQ(at(-0.1f, 0.1f), 7);
    load_float("\"checkerboard\" \"integer dimension\" 3 \"float tex1\" 3 \"float tex2\" 7");
    EXPECT_EQ(at(Vec3f(0.5f, 0.5f, 0.5f)), 3);
    EXPECT_EQ(at(Vec3f(0.5f, 0.5f, -0.5f)), 7);
    EXPECT_EQ(at(Vec3f(0.5f, 1.5f, -0.5f)), 3);
}

TEST_F(TextureTest, AFilteredCheckerboardIsItsMeanWhereItIsMinifiedAndSharpWhereItIsMagnified) {
    load_float("\"checkerboard\" \"float tex1\" 1 \"float tex2\" 0");
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0, 1000);
    for (int i = 0; i < 1000; ++i) {
        const float u = uniform(random), v = uniform(random);
        EXPECT_NEAR(at(u, v, 10), 0.5f, 2e-3) << u << ' ' << v;  // 1 / (pi 1.5 10)^2 of either wave
        EXPECT_NEAR(at(u, v, 1e4f), 0.5f, 1e-6);
        // Nothing within the filter's reach: the cell's own value, exactly.
        const float du = u - std::floor(u), dv = v - std::floor(v);
        if (std::min({du, dv, 1 - du, 1 - dv}) < 0.02f) continue;
        const bool first = (static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v))) % 2 == 0;
        EXPECT_EQ(at(u, v, 0.01f), first ? 1 : 0) << u << ' ' << v;
    }
    // On an edge, half; far out, where a filter is narrower than the numbers there can say, still between both.
    EXPECT_NEAR(at(3, 0.5f, 0.01f), 0.5f, 1e-6);
    for (int i = 0; i < 1000; ++i) {
        const float x = at(static_cast<float>(i), 0.5f, 1e-4f);
        EXPECT_TRUE(x >= -1e-4f && x <= 1 + 1e-4f) << i << ' ' << x;
    }
}

// The filtered checkerboard against the mean of many points under the triangle.
TEST_F(TextureTest, AFilteredCheckerboardIsTheMeanUnderItsFilter) {
    load_float("\"checkerboard\" \"float tex1\" 1 \"float tex2\" 0");
    for (const float width : {0.1f, 0.4f, 1.0f}) {
        for (const float u : {0.0f, 0.3f, 0.8f, 1.1f}) {
            double sum = 0, weights = 0;
            constexpr int kSteps = 2000;
            for (int i = 0; i < kSteps; ++i) {
                const double t = (i + 0.5) / kSteps * 2 - 1, weight = 1 - std::abs(t), x = u + 1.5 * t * width;
                weights += weight;
                sum += std::fmod(std::floor(x) + 100, 2) == 0 ? weight : 0;
            }
            point_.uv = {u, 0.5f};
            point_.duvdx = {width, 0};
            point_.duvdy = {};
            EXPECT_NEAR(number_.at(point_), sum / weights, 1e-3) << width << ' ' << u;
        }
    }
}

TEST_F(TextureTest, DotsAreWhereTheirNoiseIs) {
    load_float("\"dots\" \"float inside\" 1 \"float outside\" 0 \"float uscale\" 100 \"float vscale\" 100");
    double sum = 0;
    for (int i = 0; i < 200; ++i) {
        for (int j = 0; j < 200; ++j) {
            const float x = at((static_cast<float>(i) + 0.5f) / 200, (static_cast<float>(j) + 0.5f) / 200);
            EXPECT_TRUE(x == 0 || x == 1);
            sum += x;
        }
    }
    EXPECT_NEAR(sum / 40000, 0.5 * std::numbers::pi * 0.35 * 0.35, 0.03);  // half of the cells have one
}

TEST_F(TextureTest, DirectionMixFollowsTheNormal) {
    load_float("\"directionmix\" \"float tex1\" 2 \"float tex2\" 6 \"vector3 dir\" [0 0 3]");
    point_.n = {0, 0, -1};
    EXPECT_FLOAT_EQ(at(0, 0), 2);
    point_.n = {1, 0, 0};
    EXPECT_FLOAT_EQ(at(0, 0), 6);
    point_.n = {0.8f, 0, 0.6f};
    EXPECT_FLOAT_EQ(at(0, 0), 0.6f * 2 + 0.4f * 6);
}

TEST(TextureNoise, IsZeroAtWholePointsAndSmoothBetween) {
    EXPECT_EQ(noise({3, -7, 12}), 0);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(-50, 50);
    double sum = 0, squares = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f p(uniform(random), uniform(random), uniform(random));
        const float x = noise(p);
        EXPECT_LE(std::abs(x), 1);
        EXPECT_NEAR(noise(p + Vec3f(1e-3f, 0, 0)), x, 5e-3);
        sum += x;
        squares += x * x;
    }
    EXPECT_NEAR(sum / 20000, 0, 0.01);
    EXPECT_GT(squares / 20000, 0.04);
    // A footprint wider than everything leaves nothing to see, of turbulence its mean.
    const SpacePoint wide{{0.3f, 0.2f, 0.7f}, {4, 0, 0}, {0, 4, 0}};
    EXPECT_EQ(fractal_noise(wide, 0.5f, 8), 0);
    EXPECT_NEAR(turbulence(wide, 0.5f, 8), 0.2f * (1 + 2 * (1 - std::pow(0.5f, 8.0f))), 1e-5);
}

TEST_F(TextureTest, NoiseTexturesAreFiniteEverywhere) {
    for (const char* kind : {"fbm", "wrinkled", "windy"}) {
        load_float(fmt::format("\"{}\"", kind));
        EXPECT_NE(at(Vec3f(0.3f, 0.6f, 0.2f)), at(Vec3f(0.35f, 0.6f, 0.2f))) << kind;
        for (const float far : {1e6f, 1e12f, 1e30f, INFINITY}) EXPECT_TRUE(std::isfinite(at(Vec3f(far, -far, 0)))) << kind << far;
    }
    load_spectrum("\"marble\"");
    for (const float x : spectrum_at(0, 0).v) EXPECT_TRUE(x >= 0 && x <= 1);
}

TEST_F(TextureTest, APictureHasItsFirstRowAtTheTopAndItsTexelsCentred) {
    write_grey("p.pgm", 2, 2, {0, 255, 51, 102});
    load_float("\"imagemap\" \"string filename\" \"p.pgm\" \"string encoding\" \"linear\" \"string filter\" \"point\"");
    EXPECT_NEAR(at(0.25f, 0.75f), 0, 1e-6);
    EXPECT_NEAR(at(0.75f, 0.75f), 1, 1e-6);
    EXPECT_NEAR(at(0.25f, 0.25f), 0.2f, 1e-6);
    EXPECT_NEAR(at(0.75f, 0.25f), 0.4f, 1e-6);
    load_float("\"imagemap\" \"string filename\" \"p.pgm\" \"string encoding\" \"linear\"");
    EXPECT_NEAR(at(0.75f, 0.75f), 1, 1e-6);
    EXPECT_NEAR(at(0.5f, 0.75f), 0.5f, 1e-6);
    EXPECT_NEAR(at(0.5f, 0.5f), 0.4f, 1e-6);
    EXPECT_NEAR(at(0.375f, 0.75f), 0.25f, 1e-2);
}

// One picture, 8 x 2 pixels, whose four quarters are 1, 2, 4 and 1/2.
TEST_F(TextureTest, RadiancePicturesAreTheSameInEveryForm) {
    const std::string a("\x80\x80\x80\x81", 4), b("\x80\x80\x80\x82", 4), c("\x80\x80\x80\x83", 4), d("\x80\x80\x80\x80", 4);
    const auto times_4 = [](const std::string& pixel) { return pixel + pixel + pixel + pixel; };
    const auto in_runs = [](const std::string& pixel) { return pixel + std::string("\1\1\1\3", 4); };
    const std::string upper = times_4(a) + times_4(b), lower = times_4(c) + times_4(d), size = "-Y 2 +X 8\n";
    const auto expect = [&](const std::string& name, const std::string& lines, const std::string& pixels, float factor = 1) {
        SCOPED_TRACE(name);
        folder_.write(name, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + lines + pixels);
        load_float("\"imagemap\" \"string filename\" \"" + name + "\" \"string filter\" \"point\"");
        EXPECT_NEAR(at(0.25f, 0.75f), factor, 1e-4f * factor);
        EXPECT_NEAR(at(0.75f, 0.75f), 2 * factor, 1e-4f * factor);
        EXPECT_NEAR(at(0.25f, 0.25f), 4 * factor, 1e-4f * factor);
        EXPECT_NEAR(at(0.75f, 0.25f), 0.5f * factor, 1e-4f * factor);
    };
    expect("flat.hdr", "\n" + size, upper + lower);
    expect("runs.hdr", "\n" + size, in_runs(a) + in_runs(b) + in_runs(c) + in_runs(d));
    std::string planes("\2\2\0\10", 4);  // of the upper row as runs, of the lower one as they are
    for (const char* plane : {"\x84\x80\x84\x80", "\x84\x80\x84\x80", "\x84\x80\x84\x80", "\x84\x81\x84\x82"})
        planes += std::string(plane, 4);
    planes += std::string("\2\2\0\10", 4);
    for (const char* plane : {"\x80\x80\x80\x80\x80\x80\x80\x80", "\x80\x80\x80\x80\x80\x80\x80\x80",
                              "\x80\x80\x80\x80\x80\x80\x80\x80", "\x83\x83\x83\x83\x80\x80\x80\x80"})
        planes += "\10" + std::string(plane, 8);
    expect("planes.hdr", "\n" + size, planes);
    expect("from_the_bottom.hdr", "\n+Y 2 +X 8\n", lower + upper);
    expect("from_the_right.hdr", "\n-Y 2 -X 8\n", times_4(b) + times_4(a) + times_4(d) + times_4(c));
    expect("exposed.hdr", "EXPOSURE=0.5\nEXPOSURE=0.25\nCOLORCORR=2 2 2\n\n" + size, upper + lower, 4);
    // X = Y = Z is grey.
    const std::array<float, 3> rgb{0.5f, 0.5f, 0.5f};
    folder_.write("rgb.pfm", "PF\n1 1\n-1.0\n" + std::string(reinterpret_cast<const char*>(rgb.data()), sizeof(rgb)));
    load_spectrum("\"imagemap\" \"string filename\" \"rgb.pfm\"");
    const SampledSpectrum expected = spectrum_at(0.5f, 0.5f);
    folder_.write("xyz.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + d);
    load_spectrum("\"imagemap\" \"string filename\" \"xyz.hdr\"");
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) EXPECT_NEAR(spectrum_at(0.5f, 0.5f)[i], expected[i], 1e-3f) << i;
    // A colour whose primaries are those of sRGB, with red and blue exchanged.
    const auto of_primaries = [&](const std::string& name, const std::string& line, const std::string& pixel) {
        folder_.write(name, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + line + "\n-Y 1 +X 1\n" + pixel);
        load_spectrum("\"imagemap\" \"string filename\" \"" + name + "\"");
        return spectrum_at(0.5f, 0.5f);
    };
    const SampledSpectrum plain = of_primaries("plain.hdr", "", std::string("\x80\x40\x20\x80", 4)),
                          exchanged = of_primaries("exchanged.hdr", "PRIMARIES= 0.15 0.06 0.3 0.6 0.64 0.33 0.3127 0.329\n",
                                                   std::string("\x20\x40\x80\x80", 4));
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) EXPECT_NEAR(exchanged[i], plain[i], 1e-3f) << i;
    folder_.write("turned.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+X 8 -Y 2\n" + upper + lower);
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    ASSERT_TRUE(pictures);
    const Result<image::PictureInfo> turned = (*pictures)->open(folder_ / "turned.hdr", "turned.hdr", {});
    ASSERT_FALSE(turned);
    EXPECT_THAT(turned.error().message, HasSubstr("turned.hdr: cannot be read as a picture: its rows run from top to bottom"));
}

// A PNG of one pixel: `row` begins with the filter.
std::string png_of(int depth, int color, const std::string& row, const std::string& palette = "", const std::string& alphas = "") {
    const auto big_endian = [](std::size_t x) {
        return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8), static_cast<char>(x)};
    };
    const auto chunk = [&](const std::string& type, const std::string& data) {
        const std::string body = type + data;
        return big_endian(data.size()) + body +
               big_endian(crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
    };
    std::string packed(64, '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(row.data()), row.size());
    packed.resize(size);
    std::string out = "\x89PNG\r\n\x1a\n" + chunk("IHDR", big_endian(1) + big_endian(1) + static_cast<char>(depth) +
                                                              static_cast<char>(color) + std::string(3, '\0'));
    if (!palette.empty()) out += chunk("PLTE", palette);
    if (!alphas.empty()) out += chunk("tRNS", alphas);
    return out + chunk("IDAT", packed) + chunk("IEND", "");
}

// Grey level 128 is 0.2159, encoded as sRGB, whatever its alpha is.
TEST_F(TextureTest, PngsOfEveryKindHaveTheirColours) {
    const auto expect = [&](const std::string& name, const std::string& png, float value) {
        folder_.write(name, png);
        load_spectrum("\"imagemap\" \"string filename\" \"" + name + "\"");
        for (const float x : spectrum_at(0.5f, 0.5f).v) EXPECT_NEAR(x, value, 1e-4f) << name;
    };
    constexpr float kGrey = 0.21586f;
    const std::string grey("\x80\x80\x80", 3), wide = grey + grey, none(1, '\0');
    expect("grey.png", png_of(8, 0, none + "\x80"), kGrey);
    expect("grey_alpha.png", png_of(8, 4, none + "\x80\x40"), kGrey);
    expect("grey_16.png", png_of(16, 0, none + "\x80\x80"), kGrey);
    expect("grey_alpha_16.png", png_of(16, 4, none + "\x80\x80" + std::string(2, '\0')), kGrey);
    expect("white_1.png", png_of(1, 0, none + "\x80"), 1);
    expect("rgb.png", png_of(8, 2, none + grey, "", std::string("\0\x80\0\x80\0\x80", 6)), kGrey);
    expect("rgb_16.png", png_of(16, 2, none + wide), kGrey);
    expect("rgba_16.png", png_of(16, 6, none + wide + std::string(2, '\0')), kGrey);
    expect("palette_1.png", png_of(1, 3, none + "\x80", "\xFF\xFF\xFF" + grey), kGrey);
    expect("palette_4.png", png_of(4, 3, none + "\x10", "\xFF\xFF\xFF" + grey, std::string("\xFF\x40", 2)), kGrey);
}

TEST_F(TextureTest, WrapsContinueAPictureBeyondItsEdges) {
    write_grey("p.pgm", 2, 2, {0, 255, 51, 102});
    const auto load_wrap = [&](const std::string& wrap) {
        load_float(
            "\"imagemap\" \"string filename\" \"p.pgm\" \"string encoding\" \"linear\" \"string filter\" \"point\" \"string wrap\" "
            "\"" +
            wrap + "\"");
    };
    load_wrap("repeat");
    EXPECT_NEAR(at(1.75f, -0.25f), 1, 1e-6);
    load_wrap("clamp");
    EXPECT_NEAR(at(5.25f, -3), 0.4f, 1e-6);
    load_wrap("black");
    EXPECT_EQ(at(1.25f, 0.75f), 0);
    EXPECT_NEAR(at(0.75f, 0.75f), 1, 1e-6);
    load_wrap("octahedralsphere");
    EXPECT_NEAR(at(1.25f, 0.75f), 0.4f, 1e-6);  // over the right edge: reflected there, and turned over
    EXPECT_NEAR(at(0.75f, 0.75f), 1, 1e-6);
}

TEST_F(TextureTest, EncodingsScaleAndInvertMakeLinearValues) {
    write_grey("p.pgm", 1, 1, {188});
    const auto value = [&](const std::string& more) {
        load_float("\"imagemap\" \"string filename\" \"p.pgm\" " + more);
        return at(0.5f, 0.5f);
    };
    EXPECT_NEAR(value(""), 0.50289f, 1e-4);
    EXPECT_NEAR(value("\"string encoding\" \"linear\""), 188 / 255.0f, 1e-6);
    EXPECT_NEAR(value("\"string encoding\" \"gamma 2\""), 188 / 255.0f * 188 / 255.0f, 1e-5);
    EXPECT_NEAR(value("\"string encoding\" \"linear\" \"float scale\" 2"), 376 / 255.0f, 1e-5);
    EXPECT_NEAR(value("\"string encoding\" \"linear\" \"bool invert\" true"), 67 / 255.0f, 1e-6);
    EXPECT_EQ(value("\"string encoding\" \"linear\" \"float scale\" 2 \"bool invert\" true"), 0);
}

// What is encoded is filtered as light: half black and half white is half as bright, not grey level 128.
TEST_F(TextureTest, AMinifiedPictureIsTheMeanOfItsLight) {
    std::vector<int> board;
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; ++x) board.push_back((x / 4 + y / 4) % 2 == 0 ? 255 : 0);
    }
    write_grey("p.pgm", 256, 256, board);
    for (const char* filter : {"trilinear", "ewa", "bilinear", "point"}) {
        load_float(fmt::format("\"imagemap\" \"string filename\" \"p.pgm\" \"string filter\" \"{}\"", filter));
        for (const float u : {0.1f, 0.35f, 0.8f}) EXPECT_NEAR(at(u, 0.3f, 0.5f), 0.5f, 1e-3) << filter;
    }
}

TEST_F(TextureTest, AMagnifiedPictureIsNotBlurredMoreThanItsFilterSays) {
    write_grey("p.pgm", 4, 1, {0, 0, 255, 255});
    for (const char* filter : {"bilinear", "trilinear", "ewa"}) {
        load_float(
            fmt::format("\"imagemap\" \"string filename\" \"p.pgm\" \"string filter\" \"{}\" \"string wrap\" \"clamp\"", filter));
        EXPECT_EQ(at(0.37f, 0.5f, 1e-3f), 0) << filter;
        EXPECT_EQ(at(0.63f, 0.5f, 1e-3f), 1) << filter;
        EXPECT_NEAR(at(0.5f, 0.5f, 1e-3f), 0.5f, 1e-2) << filter;
    }
}

// (1 - rho)^2 (1 + 2 rho - 6 rho^2), rho half the distance in texels.
double quartic(double x, double y) {
    const double rho = std::min(std::hypot(x, y) / 2, 1.0);
    return (1 - rho) * (1 - rho) * (1 + 2 * rho - 6 * rho * rho);
}

TEST_F(TextureTest, TheQuarticReconstructsATexelWithRotationalSymmetry) {
    std::vector<int> values(16 * 16, 100);
    values[8 * 16 + 7] = 200;
    write_grey("dot.pgm", 16, 16, values);
    load_float("\"imagemap\" \"string filename\" \"dot.pgm\" \"string encoding\" \"linear\" \"string filter\" \"latent:quartic\"");
    const auto over = [&](double x, double y) {  // texels from the middle of the bright one
        return (static_cast<double>(at(static_cast<float>((7.5 + x) / 16), static_cast<float>(1 - (8.5 + y) / 16))) * 255 - 100) /
               100;
    };
    for (int i = 0; i < 500; ++i) {
        const double x = -2.4 + 4.8 * (i % 25) / 24, y = -2.4 + 4.8 * (i / 25) / 19;
        double sum = 0;
        for (int row = -5; row <= 5; ++row) {
            for (int column = -5; column <= 5; ++column) sum += quartic(x - column, y - row);
        }
        EXPECT_NEAR(over(x, y), quartic(x, y) / sum, 2e-4) << x << ", " << y;
    }
    EXPECT_LT(over(1.5, 0), -0.02);  // it rings, as sharp filters do
}

TEST_F(TextureTest, TheQuarticKeepsConstantsAndTheMeanOfMinifiedPictures) {
    std::vector<int> values;
    std::mt19937 random(3);
    double mean = 0;
    for (int i = 0; i < 64 * 64; ++i) {
        values.push_back(64 + static_cast<int>(random() % 128));  // far enough from 0 for the lobes
        mean += values.back() / 255.0 / (64 * 64);
    }
    write_grey("noise.pgm", 64, 64, values);
    write_grey("even.pgm", 5, 3, std::vector<int>(15, 51));
    load_float("\"imagemap\" \"string filename\" \"even.pgm\" \"string encoding\" \"linear\" \"string filter\" \"latent:quartic\"");
    for (const float width : {0.0f, 0.1f, 0.7f, 40.0f}) EXPECT_NEAR(at(0.63f, -1.2f, width), 0.2f, 1e-6f);
    load_float(
        "\"imagemap\" \"string filename\" \"noise.pgm\" \"string encoding\" \"linear\" \"string filter\" \"latent:quartic\"");
    EXPECT_NEAR(at(0.3f, 0.4f, 1), mean, 2e-3);
    // Texel after texel, over a whole period.
    double sum = 0;
    constexpr int kSteps = 256;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const auto u = static_cast<float>(i % kSteps) / kSteps, v = static_cast<float>(i / kSteps) / kSteps;
        sum += static_cast<double>(at(u, v)) / (kSteps * kSteps);
    }
    EXPECT_NEAR(sum, mean, 2e-3);
}

TEST_F(TextureTest, ColoursOfAPictureKeepTheirColour) {
    folder_.write("p.ppm", std::string("P6\n2 1\n255\n") + "\xff\x80\x20\x80\x80\x80");
    load_spectrum("\"imagemap\" \"string filename\" \"p.ppm\" \"string encoding\" \"linear\" \"string filter\" \"point\"");
    const SampledSpectrum& grey = spectrum_at(0.75f, 0.5f);
    for (const float x : grey.v) EXPECT_NEAR(x, 128 / 255.0f, 1e-5);
    const SampledSpectrum& orange = spectrum_at(0.25f, 0.5f);
    EXPECT_LT(orange.v[5], 0.2f);   // 440 nm
    EXPECT_GT(orange.v[19], 0.9f);  // 636 nm
    for (const float x : orange.v) EXPECT_TRUE(x >= 0 && x <= 1);
}

TEST_F(TextureTest, MemoryOfPicturesStaysBelowTheLimit) {
    constexpr int kSize = 4096;
    std::string bytes = fmt::format("P5\n{} {}\n255\n", kSize, kSize);  // 64 MiB as floats, 85 with its smaller sizes
    for (int y = 0; y < kSize; ++y) bytes += std::string(kSize, static_cast<char>(y % 256));
    folder_.write("p.pgm", bytes);
    bytes = {};
    load_float("\"imagemap\" \"string filename\" \"p.pgm\" \"string filter\" \"trilinear\"", 8 << 20);
    const auto resident = [] {
        std::ifstream statm("/proc/self/statm");
        std::uint64_t size = 0, pages = 0;
        statm >> size >> pages;
        return pages * 4096;
    };
    at(0.5f, 0.5f);
    const std::uint64_t before = resident();
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) at(static_cast<float>(j) / 64, static_cast<float>(i) / 64, 1e-4f);
    }
    EXPECT_LT(static_cast<double>(resident()) - static_cast<double>(before), 32 << 20);
}

TEST_F(TextureTest, ThreadsReadTheSizesOfOnePictureAtOnce) {
    if (latent::testing::run({"/bin/sh", "-c", "command -v maketx"}).status != 0)
        GTEST_SKIP() << "maketx is missing: scripts/install test";
    constexpr int kSize = 512;
    std::minstd_rand random(1);
    std::vector<int> values(kSize * kSize);
    for (int& x : values) x = static_cast<int>(random() % 256);
    write_grey("p.pgm", kSize, kSize, values);
    const std::string picture = folder_ / "p.pgm", tiled = folder_ / "p.tif";
    ASSERT_EQ(latent::testing::run({"/usr/bin/env", "maketx", "--compression", "none", "--tile", "32", "32", picture, "-o", tiled})
                  .status,
              0);
    // The cache holds a quarter of it, so that tiles of all sizes are read again and again.
    load_float("\"imagemap\" \"string filename\" \"p.tif\" \"string filter\" \"trilinear\"", 256 << 10);
    const auto value_at = [&](std::size_t i) {
        TexturePoint point = point_;
        const std::uint64_t h = mix(i + 1);
        point.uv = {static_cast<float>(h & 0xffff) / 0x10000, static_cast<float>((h >> 16) & 0xffff) / 0x10000};
        const float width = std::ldexp(1.0f, -static_cast<int>(1 + (h >> 32) % 9));
        point.duvdx = {width, 0};
        point.duvdy = {0, width};
        return number_.at(point);
    };
    std::vector<float> alone(4000);
    for (std::size_t i = 0; i < alone.size(); ++i) alone[i] = value_at(i);
    std::array<std::vector<float>, 4> together;
    {
        std::vector<std::jthread> threads;
        for (std::vector<float>& found : together) {
            threads.emplace_back([&] {
                for (std::size_t i = 0; i < alone.size(); ++i) found.push_back(value_at(i));
            });
        }
    }
    ASSERT_TRUE(textures_->status());
    for (const std::vector<float>& found : together) EXPECT_EQ(found, alone);
}

// One without tiles is decoded again and again where it does not fit.
TEST_F(TextureTest, ACacheThatIsTooSmallIsWarnedOf) {
    write_grey("p.pgm", 400, 300, std::vector<int>(400 * 300, 100));  // 625 KiB as floats, with its smaller sizes
    const std::string texture = "\"imagemap\" \"string filename\" \"p.pgm\"";
    load_float(texture, 1 << 19);
    EXPECT_THAT(textures_->warnings(), ElementsAre(HasSubstr("1 picture without tiles may need 703.1 KiB when decoded, more than "
                                                             "--texture-cache (512.0 KiB)")));
    for (const int enough : {1 << 20, 0}) {
        load_float(texture, enough);
        EXPECT_TRUE(textures_->warnings().empty()) << enough;
    }
}

TEST_F(TextureTest, AFloatPictureKeepsItsSign) {
    write_floats("p.pfm", 2, 1, {-0.5f, 1.5f});
    const auto load = [&](const std::string& parameters) {
        load_float("\"imagemap\" \"string filename\" \"p.pfm\" \"string filter\" \"point\" " + parameters);
    };
    load("");
    EXPECT_EQ(at(0.25f, 0.5f), -0.5f);
    EXPECT_EQ(at(0.75f, 0.5f), 1.5f);
    load("\"float scale\" -2");
    EXPECT_EQ(at(0.25f, 0.5f), 1);
    EXPECT_EQ(at(0.75f, 0.5f), -3);
    load("\"bool invert\" true");
    EXPECT_EQ(at(0.25f, 0.5f), 1.5f);
    EXPECT_EQ(at(0.75f, 0.5f), 0);
    load_spectrum("\"imagemap\" \"string filename\" \"p.pfm\" \"string filter\" \"point\"");
    for (const float x : spectrum_at(0.25f, 0.5f).v) EXPECT_EQ(x, 0);
}

TEST_F(TextureTest, ValuesThatAreNoNumberCountAsZeroAndAreCountedOnce) {
    constexpr int kSide = 300;  // more than the cache holds, so its tiles are read again and again
    std::vector<float> values(std::size_t{kSide} * kSide, 2.0f);
    values[0] = std::numeric_limits<float>::quiet_NaN();
    values[3] = values.back() = std::numeric_limits<float>::infinity();
    write_floats("p.pfm", kSide, kSide, values);
    load_float("\"imagemap\" \"string filename\" \"p.pfm\" \"string filter\" \"bilinear\"", 1 << 18);
    EXPECT_THAT(textures_->warnings(), ElementsAre(HasSubstr("more than --texture-cache")));
    const float texel = 1.0f / kSide;
    for (int round = 0; round < 3; ++round) {
        for (int y = 0; y < kSide; ++y) at(0.5f * texel, (static_cast<float>(y) + 0.5f) * texel);
    }
    EXPECT_NEAR(at(1.0f * texel, 0.5f * texel), 1, 1e-4);  // half of it is the texel that is no number
    EXPECT_THAT(textures_->warnings(),
                ::testing::Contains(::testing::EndsWith("p.pfm: 3 values are NaN or infinite, and count as 0")));
}

TEST(TextureFootprint, IsAQuarterOfAPixelSeenFromTheCamera) {
    CameraDescription camera{.x0 = -1, .x1 = 1, .y0 = -1, .y1 = 1};
    const Footprint footprint(camera, 200, 200);
    Vec3f dx, dy;
    footprint.at({0, 0, 10}, {0, 0, -1}, dx, dy);
    EXPECT_NEAR(length(dx), 0.25 * 10 * 2 / 200, 1e-6);
    EXPECT_NEAR(length(dy), 0.25 * 10 * 2 / 200, 1e-6);
    EXPECT_NEAR(dot(dx, dy), 0, 1e-6);
    const float c = 0.5f;  // seen at 60 degrees from the normal: twice as long along the plane of both
    footprint.at({0, 0, 10}, {0, std::sqrt(1 - c * c), -c}, dx, dy);
    EXPECT_NEAR(std::max(length(dx), length(dy)) / std::min(length(dx), length(dy)), 2, 1e-5);
    EXPECT_NEAR(std::min(length(dx), length(dy)), 0.25 * 10 * 2 / 200, 1e-6);
    // Behind the camera and at its centre it is small, and finite.
    footprint.at({0, 0, -10}, {0, 0, -1}, dx, dy);
    EXPECT_LE(length(dx), 0.25 * 10 * 2 / 200);
    footprint.at({0, 0, 0}, {0, 0, -1}, dx, dy);
    EXPECT_EQ(length(dx), 0);
}

}  // namespace
}  // namespace latent::render
