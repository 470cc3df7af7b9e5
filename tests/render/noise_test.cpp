// Noise: textures and clouds against numbers computed apart from them, in double precision: noise_values.py, which is written from
// pbrt-v4's formulas. One octave more or less, a roughness of 0.1 or a wispiness of 0.2 more differs by many times the tolerances.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "render/medium/cloud.h"
#include "render/medium/make_medium.h"
#include "render/texture/rgb_spectrum.h"
#include "tests/render/textures.h"

namespace latent::render {
namespace {

const std::array<Vec3f, 3> kPoints = {Vec3f{0.296875f, 0.609375f, 0.203125f}, Vec3f{-1.390625f, 2.71875f, -0.578125f},
                                      Vec3f{3.140625f, -0.453125f, 1.859375f}};

// Points of the eighth octave are up to 400 away from the origin, where floats are 3e-5 apart; its weight is 1/128. The numbers
// below have six digits.
constexpr double kTolerance = 2e-5;

struct Octaves {
    int octaves;
    double roughness;
    float footprint, values[3];
};
struct Veins {
    int octaves;
    double roughness, scale, variation;
    float rgb[3][3];
};
struct Cloud {
    double density, wispiness, frequency;
    float values[4];
};

class NoiseTest : public testing::TextureTest {
 protected:
    // At a point with a round footprint.
    float seen(const Vec3f& p, float footprint) {
        point_.dpdx = {footprint, 0, 0};
        point_.dpdy = {0, 0, footprint};
        return at(p);
    }
    void expect_values(const std::string& kind, const Octaves& c) {
        load_float(fmt::format("\"{}\" \"integer octaves\" {} \"float roughness\" {}", kind, c.octaves, c.roughness));
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(seen(kPoints[i], c.footprint), c.values[i], kTolerance) << c.octaves << ' ' << c.roughness << ' ' << i;
    }
};

TEST_F(NoiseTest, FbmIsTheSumOfItsOctaves) {
    for (const Octaves& c :
         {Octaves{8, 0.5, 0, {0.124799, 0.229712, 0.743492}}, Octaves{3, 0.6, 0, {0.194136, 0.23247, 0.767955}},
          Octaves{4, 0.9, 0, {0.383706, 0.0357166, 1.22243}}, Octaves{6, 0.7, 0.09, {0.150049, 0.32031, 0.67858}}})
        expect_values("fbm", c);
}

TEST_F(NoiseTest, WrinkledIsTheSumOfItsOctavesWithoutSign) {
    for (const Octaves& c :
         {Octaves{8, 0.5, 0, {0.282015, 0.535068, 0.756227}}, Octaves{3, 0.6, 0, {0.362478, 0.600481, 0.811155}},
          Octaves{4, 0.9, 0, {0.728346, 0.972095, 1.35365}}, Octaves{6, 0.7, 0.09, {0.581951, 0.805148, 0.98534}}})
        expect_values("wrinkled", c);
}

TEST_F(NoiseTest, WindyIsWavesTimesTheStrengthOfTheWind) {
    load_float("\"windy\"");
    const std::array<float, 3> values = {0.0146949, 0.116654, 0.0325236};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(seen(kPoints[i], 0), values[i], kTolerance) << i;
}

TEST_F(NoiseTest, DefaultsAreEightOctavesOfRoughnessOneHalf) {
    for (const char* kind : {"fbm", "wrinkled"}) {
        load_float(fmt::format("\"{}\" \"integer octaves\" 8 \"float roughness\" .5", kind));
        const float given = seen(kPoints[0], 0);
        load_float(fmt::format("\"{}\"", kind));
        EXPECT_EQ(seen(kPoints[0], 0), given) << kind;
    }
    load_spectrum("\"marble\" \"integer octaves\" 8 \"float roughness\" .5 \"float scale\" 1 \"float variation\" .2");
    point_.p = kPoints[0];
    const SampledSpectrum given = spectrum_at(0, 0);
    load_spectrum("\"marble\"");
    const SampledSpectrum& otherwise = spectrum_at(0, 0);
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) EXPECT_EQ(otherwise[i], given[i]);
}

TEST_F(NoiseTest, MarbleHasTheColoursOfItsVeins) {
    for (const Veins& c :
         {Veins{8, 0.5, 1, 0.2, {{0.601986, 0.601822, 0.709007}, {0.890928, 0.880142, 0.877972}, {0.841489, 0.841078, 0.862513}}},
          Veins{3, 0.7, 2.5, 1.3, {{0.868362, 0.868362, 0.898836}, {0.679722, 0.679722, 0.764803}, {0.87, 0.87, 0.9}}},
          Veins{2, 0.4, 1.5, 3, {{0.812144, 0.812144, 0.858892}, {0.829891, 0.828802, 0.844962}, {0.84207, 0.83394, 0.8285}}}}) {
        load_spectrum(
            fmt::format("\"marble\" \"integer octaves\" {} \"float roughness\" {} \"float scale\" {} \"float variation\" {}",
                        c.octaves, c.roughness, c.scale, c.variation));
        const RgbColors colors(color::RgbSpectra::kSmooth, library_);
        for (std::size_t i = 0; i < 3; ++i) {
            point_.p = kPoints[i];
            const SampledSpectrum found = spectrum_at(0, 0);
            SampledSpectrum expected;
            colors.evaluate(c.rgb[i], SpectrumRole::kReflectance, *spectra_, expected);
            for (std::uint32_t w = 0; w < kMaxWavelengths; ++w)
                EXPECT_NEAR(found[w], expected[w], 3 * kTolerance) << c.octaves << ' ' << i << ' ' << w;
        }
    }
}

TEST_F(NoiseTest, DotsAreRoundAndEachInAPlaceOfItsOwn) {
    load_float("\"dots\"");
    constexpr float kRadius = 0.35f, kMargin = 0.002f;
    for (const auto& [s, t, x, y] : std::initializer_list<std::array<float, 4>>{{-5, 2, -4.98723, 2.07832},
                                                                                {2, 5, 1.98652, 5.06071},
                                                                                {-3, 1, -3.05511, 0.970319},
                                                                                {-2, -5, -2.07636, -4.88685},
                                                                                {1, -8, 0.984348, -8.00136},
                                                                                {-5, -4, -4.99375, -3.98375}}) {
        for (int i = 0; i < 16; ++i) {
            const float turn = static_cast<float>(i) * static_cast<float>(std::numbers::pi) / 8;
            const auto from_centre = [&, x = x, y = y](float r) { return at(x + r * std::cos(turn), y + r * std::sin(turn)); };
            EXPECT_EQ(from_centre(kRadius - kMargin), 1) << s << ' ' << t << ' ' << i;
            EXPECT_EQ(from_centre(kRadius + kMargin), 0) << s << ' ' << t << ' ' << i;
        }
    }
    for (const Vec2f cell : {Vec2f{-6, 2}, Vec2f{-5, 0}, Vec2f{-3, 4}}) {
        for (int i = 0; i < 100; ++i) {
            const float x = cell.x - 0.45f + 0.1f * static_cast<float>(i % 10),
                        y = cell.y - 0.45f + 0.1f * static_cast<float>(i / 10);
            EXPECT_EQ(at(x, y), 0) << x << ' ' << y;
        }
    }
}

// Slopes of the noise are differences over 0.01 at points up to 90 away, where floats are 8e-6 apart: slopes are off by some 1e-3,
// points by a twentieth of that, and densities by a few times as much.
TEST_F(NoiseTest, ACloudIsAsDenseAsItsNoise) {
    const std::array<Vec3f, 4> points = {Vec3f{0.890625f, 0.609375f, 0.703125f}, Vec3f{0.171875f, 0.796875f, 0.390625f},
                                         Vec3f{0.640625f, 0.90625f, 0.09375f}, Vec3f{0.453125f, 0.421875f, 0.546875f}};
    const auto cloud_of = [&](const std::string& parameters) {
        load("MakeNamedMedium \"m\" \"string type\" \"cloud\" " + parameters +
             "\nMediumInterface \"m\" \"\"\nTexture \"t\" \"float\" \"constant\"\nTexture \"s\" \"spectrum\" \"constant\"\n");
        return make_medium(scene_.media, 0, library_);
    };
    const auto density = [](const Medium& medium, const Vec3f& p) { return dynamic_cast<const CloudMedium&>(medium).density(p); };
    for (const Cloud& c :
         {Cloud{1, 1, 5, {0.298495, 0.0788229, 0.123601, 0.15625}}, Cloud{2, 0, 3, {0.0717351, 0.613981, 0.221062, 0.15625}},
          Cloud{1.5, 0.5, 4, {0.409738, 0.132008, 0.0887202, 0.238666}},
          Cloud{1, 2, 2.5, {0.25224, 0.191957, 0.0662171, 0.15625}}}) {
        const std::string parameters =
            fmt::format("\"float density\" {} \"float wispiness\" {} \"float frequency\" {} ", c.density, c.wispiness, c.frequency);
        const auto unit = cloud_of(parameters), box = cloud_of(parameters + "\"point3 p0\" [-1 0 -2] \"point3 p1\" [1 1 2]");
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3f& p = points[i];
            EXPECT_NEAR(density(*unit, p), c.values[i], 2e-4) << c.density << ' ' << i;
            // The noise is fixed to the medium's space, not to the box.
            EXPECT_NEAR(density(*box, {(p.x + 1) / 2, p.y, (p.z + 2) / 4}), c.values[i], 2e-4) << c.density << ' ' << i;
        }
    }
    const auto given = cloud_of("\"float density\" 1 \"float wispiness\" 1 \"float frequency\" 5"), otherwise = cloud_of("");
    for (const Vec3f& p : points) EXPECT_EQ(density(*otherwise, p), density(*given, p));
}

}  // namespace
}  // namespace latent::render
