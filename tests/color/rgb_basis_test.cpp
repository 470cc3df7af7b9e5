// Spectra of colours as sums of three curves: docs/color.md, "RGB to spectrum".
#include "color/rgb_basis.h"

#include <gtest/gtest.h>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color {
namespace {

// Linear sRGB of a reflectance under D65; white is (1,1,1).
std::array<double, 3> seen(const Spectrum& reflectance) {
    std::array<double, 3> xyz{}, white{};
    for (int i = 0; i < kIntegerNmCount; ++i) {
        const auto& response = Observer::cie1931().responses()[static_cast<std::size_t>(i)];
        const double power = illuminant_d65()(kLambdaMin + i);
        for (std::size_t c = 0; c < 3; ++c) {
            white[c] += response[c] * power;
            xyz[c] += response[c] * power * reflectance(kLambdaMin + i);
        }
    }
    for (double& x : xyz) x /= white[1];
    return RgbSpace::srgb().rgb_from_xyz * xyz;
}

TEST(RgbBasis, CurvesAreReflectancesThatAddUpToOne) {
    const auto& [r, g, b] = rgb_basis();
    for (double nm = 360; nm <= 830; nm += 0.5) {
        for (const Spectrum* s : {&r, &g, &b}) {
            EXPECT_GE((*s)(nm), 0) << nm;
            EXPECT_LE((*s)(nm), 1) << nm;
        }
        EXPECT_NEAR(r(nm) + g(nm) + b(nm), 1, 1e-12) << nm;
    }
}

// Where the thesis allows 3 %. RGB is linear in the spectrum, so what holds for the corners holds for all colours.
TEST(RgbBasis, ColoursAreMetToHalfAPercent) {
    for (int corner = 0; corner < 8; ++corner) {
        const Rgb wanted{static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1), static_cast<double>(corner >> 2)};
        const std::array<double, 3> is = seen(rgb_basis_spectrum(wanted));
        EXPECT_NEAR(is[0], wanted.r, 5e-3) << corner;
        EXPECT_NEAR(is[1], wanted.g, 5e-3) << corner;
        EXPECT_NEAR(is[2], wanted.b, 5e-3) << corner;
    }
}

TEST(RgbBasis, SpectraAreLinearInTheColour) {
    const Spectrum grey = rgb_basis_spectrum({0.3, 0.3, 0.3}), colour = rgb_basis_spectrum({0.5, 0.1, 4}),
                   below = rgb_basis_spectrum({-1, 0.5, 0});
    const auto& [r, g, b] = rgb_basis();
    for (double nm = 360; nm <= 830; ++nm) {
        EXPECT_NEAR(grey(nm), 0.3, 1e-12);
        EXPECT_NEAR(colour(nm), 0.5 * r(nm) + 0.1 * g(nm) + 4 * b(nm), 1e-12);
        EXPECT_NEAR(below(nm), 0.5 * g(nm), 1e-12);  // negative components count as 0
    }
}

}  // namespace
}  // namespace latent::color
