#include "color/rgb_to_spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color {
namespace {

const RgbToSpectrum& srgb() {
    static const RgbToSpectrum uplift(RgbSpace::srgb(), illuminant_d65());
    return uplift;
}

double distance(Rgb a, Rgb b) { return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}); }

// The way back as a renderer goes it: reflectance times D65 to XYZ by exact integrals, then the matrix of the standard.
Rgb seen_under_d65(const SigmoidSpectrum& s) {
    std::vector<double> lambda_nm, value;
    for (double lambda = kLambdaMin; lambda <= kLambdaMax; lambda += 0.5) {
        lambda_nm.push_back(lambda);
        value.push_back(s(static_cast<float>(lambda)) * illuminant_d65()(lambda));
    }
    const Xyz seen = xyz_from_spectrum(*Spectrum::from_samples(lambda_nm, value, Outside::kZero), Observer::cie1931());
    const double white = xyz_from_spectrum(illuminant_d65(), Observer::cie1931()).y;
    const auto rgb = RgbSpace::srgb().rgb_from_xyz * std::array{seen.x / white, seen.y / white, seen.z / white};
    return {rgb[0], rgb[1], rgb[2]};
}

TEST(RgbToSpectrum, RoundTripOverADenseCube) {
    constexpr int kSteps = 24;
    double worst = 0, lowest = 0, highest = 0;
    for (int r = 0; r <= kSteps; ++r) {
        for (int g = 0; g <= kSteps; ++g) {
            for (int b = 0; b <= kSteps; ++b) {
                const Rgb rgb{r / double{kSteps}, g / double{kSteps}, b / double{kSteps}};
                const SigmoidSpectrum s = srgb().reflectance(rgb);
                worst = std::max(worst, distance(srgb().rgb_of(s), rgb));
                for (float lambda = 360; lambda <= 830; lambda += 10) {
                    lowest = std::min(lowest, double{s(lambda)});
                    highest = std::max(highest, double{s(lambda)});
                }
            }
        }
    }
    EXPECT_LT(worst, 3e-6);  // the solver's tolerance and float coefficients
    EXPECT_EQ(lowest, 0);
    EXPECT_EQ(highest, 1);
}

TEST(RgbToSpectrum, RoundTripThroughARenderersEyes) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 300; ++i) {
        Rgb rgb{uniform(random), uniform(random), uniform(random)};
        if (i < 8) rgb = {double(i & 1), double(i >> 1 & 1), double(i >> 2)};
        EXPECT_LT(distance(seen_under_d65(srgb().reflectance(rgb)), rgb), 1e-3) << rgb.r << ' ' << rgb.g << ' ' << rgb.b;
    }
}

TEST(RgbToSpectrum, ColoursNearTheFacesAndCornersAreMetToo) {
    const double near[] = {0, 1e-6, 1e-4, 0.01, 0.49999, 0.5, 0.50001, 0.99, 0.9999, 0.999999, 1};
    for (const double r : near) {
        for (const double g : near) {
            for (const double b : near) {
                EXPECT_LT(distance(srgb().rgb_of(srgb().reflectance({r, g, b})), {r, g, b}), 3e-6) << r << ' ' << g << ' ' << b;
            }
        }
    }
}

TEST(RgbToSpectrum, GreysBlackAndWhiteAreExactAndFlat) {
    for (const float grey : {0.0F, 1e-6F, 0.18F, 0.5F, 0.75F, 1.0F}) {
        const SigmoidSpectrum s = srgb().reflectance({grey, grey, grey});
        for (float lambda = 360; lambda <= 830; ++lambda) EXPECT_EQ(s(lambda), grey);
        EXPECT_EQ(s.max_value(), grey);
    }
}

TEST(RgbToSpectrum, DarkColoursAreDimmedBrightOnes) {
    const SigmoidSpectrum bright = srgb().reflectance({0.5, 0.25, 0.05}), dark = srgb().reflectance({0.5e-5, 0.25e-5, 0.05e-5});
    for (float lambda = 360; lambda <= 830; lambda += 10) EXPECT_NEAR(dark(lambda) / bright(lambda), 1e-5, 1e-10);
}

TEST(RgbToSpectrum, ReflectancesOutsideTheCubeAreClampedToIt) {
    const auto same = [](Rgb a, Rgb b) {
        for (float lambda = 360; lambda <= 830; lambda += 10) {
            EXPECT_EQ(srgb().reflectance(a)(lambda), srgb().reflectance(b)(lambda));
        }
    };
    same({1.5, 0.2, -0.1}, {1, 0.2, 0});
    same({-1, -2, -3}, {0, 0, 0});
    same({std::nan(""), 0.5, 2}, {0, 0.5, 1});
    same({9, 9, 9}, {1, 1, 1});
}

TEST(RgbToSpectrum, LightsHaveAnyMagnitudeAndWhiteOnesTheIlluminantsShape) {
    const SigmoidSpectrum white = srgb().unbounded({2, 2, 2});
    for (float lambda = 360; lambda <= 830; lambda += 10) EXPECT_EQ(white(lambda), 2);
    for (const double magnitude : {1e-6, 0.3, 1.0, 7.0, 1e6}) {
        for (const Rgb& rgb : {Rgb{1, 0.5, 0.2}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0.9, 1, 0.95}}) {
            const Rgb scaled{rgb.r * magnitude, rgb.g * magnitude, rgb.b * magnitude};
            EXPECT_LT(distance(srgb().rgb_of(srgb().unbounded(scaled)), scaled), 3e-6 * 2 * magnitude);
        }
    }
    EXPECT_EQ(srgb().unbounded({0, 0, 0})(500), 0);
}

TEST(RgbToSpectrum, MaxValueIsAnUpperBoundThatIsReached) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0, 3);
    for (int i = 0; i < 200; ++i) {
        const SigmoidSpectrum s = srgb().unbounded({uniform(random), uniform(random), uniform(random)});
        float seen = 0;
        for (float lambda = 360; lambda <= 830; lambda += 0.25F) seen = std::max(seen, s(lambda));
        EXPECT_LE(seen, s.max_value() * 1.000001F);
        EXPECT_GE(seen, s.max_value() * 0.9F);
    }
}

// The corners of wide gamuts are beyond any reflectance: what is taken instead is in [0,1], and no change of its coefficients comes
// nearer by a twentieth.
TEST(RgbToSpectrum, WideGamutsGiveTheNearestReflectance) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> magnitude(-4, 0);
    for (const char* name : {"display-p3", "rec2020", "adobe-rgb"}) {
        const RgbToSpectrum wide(*RgbSpace::parse(name), illuminant_d65());
        for (int corner = 0; corner < 27; ++corner) {
            const Rgb rgb{corner % 3 / 2.0, corner / 3 % 3 / 2.0, corner / 9 / 2.0};
            SCOPED_TRACE(::testing::Message() << name << ' ' << rgb.r << ' ' << rgb.g << ' ' << rgb.b);
            const auto error_of = [&](const SigmoidSpectrum& s) {
                const Rgb back = wide.rgb_of(s);
                return std::hypot(back.r - rgb.r, back.g - rgb.g, back.b - rgb.b);
            };
            const SigmoidSpectrum s = wide.reflectance(rgb);
            for (float lambda = 360; lambda <= 830; lambda += 10) ASSERT_TRUE(s(lambda) >= 0 && s(lambda) <= 1);
            const double error = error_of(s);
            EXPECT_LT(error, 0.23);
            double nearest = error;
            for (int i = 0; i < 100 && error > 1e-3; ++i) {
                const float size = std::pow(10.0F, magnitude(random));
                SigmoidSpectrum other = s;
                for (float* c : {&other.c0, &other.c1, &other.c2}) *c *= 1 + size * normal(random);
                nearest = std::min(nearest, error_of(other));
            }
            EXPECT_GT(nearest, 0.95 * error - 1e-9);
        }
    }
}

}  // namespace
}  // namespace latent::color
