// Laws of the spectra of lights: lines keep their power, whole nm keep pbrt's sum.
#include "color/light_spectrum.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color::testing {
namespace {

Spectrum samples(std::vector<double> nm, std::vector<double> value, Outside outside = Outside::kZero) {
    return *Spectrum::from_samples(std::move(nm), std::move(value), outside);
}

Spectrum sodium() { return samples({360, 586.5, 588.5, 590.5, 592.5, 830}, {0, 0, 1, 1, 0, 0}); }

TEST(LightSpectrum, LinesAreWidenedToTheFinestThatFloatsResolve) {
    const Spectrum line = samples({360, 588.999, 589, 589.001, 830}, {0, 0, 1000, 0, 0});
    const Spectrum wide = with_lines_widened(line);
    EXPECT_NEAR(wide.lambda_nm()[3] - wide.lambda_nm()[1], 0.05, 1e-9);
    EXPECT_NEAR(integral_of_product(wide, Spectrum::constant(1)), 1, 1e-9);
    EXPECT_NEAR(wide.lambda_nm()[2], 589, 1e-9);
    const Spectrum broad = sodium();
    const Spectrum same = with_lines_widened(broad);
    EXPECT_TRUE(std::equal(same.values().begin(), same.values().end(), broad.values().begin(), broad.values().end()));
}

TEST(LightSpectrum, LuminanceIsPbrtsSumOverWholeNmOrTheIntegralWhereLinesAreFine) {
    for (const Spectrum& s : {illuminant_d65(), *Spectrum::blackbody(2856), sodium()})
        EXPECT_EQ(luminance(s), photometric_sum(s));  // the sum over whole nm, to the bit
    const auto integral = [](const Spectrum& s) { return xyz_from_spectrum(s, Observer::cie1931()).y; };
    const std::vector<double> nm = {350, 400, 588.25, 588.5, 589.75, 700, 900}, value = {1, 2, 0, 5, 1, 1, 3};
    for (const Outside outside : {Outside::kZero, Outside::kClamped}) {
        const Spectrum s = samples(nm, value, outside);
        EXPECT_NEAR(luminance(s), integral(s), 1e-12 * integral(s));
    }
    const Spectrum inner = samples({588.25, 588.5, 589.75}, {4, 5, 1}, Outside::kClamped);
    EXPECT_NEAR(luminance(inner), integral(inner), 1e-12 * integral(inner));
    EXPECT_EQ(luminance(samples({200, 200.5, 300}, {1, 1, 1})), 0);
}

}  // namespace
}  // namespace latent::color::testing
