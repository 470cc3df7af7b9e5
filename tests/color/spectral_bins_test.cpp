#include "color/spectral_bins.h"

#include <gtest/gtest.h>

#include "color/named_spectra.h"

namespace latent::color {
namespace {

TEST(SpectralBins, TogetherTheyAreTheWholeIntegralHoweverTheyAreCut) {
    const std::vector<double> even{370, 400, 420, 440, 460, 480, 500, 520, 540, 560, 580, 600, 620, 640, 660, 680, 700, 900};
    const std::vector<double> uneven{300, 412.5, 413, 498.7, 600, 601.25, 870};
    for (const char* name : {"cie1931", "kodak_trix_400", "sony_ilce_9"}) {
        const Observer observer = *Observer::by_name(name);
        for (const std::vector<double>& centres : {even, uneven}) {
            std::array<double, 3> sum{};
            for (const auto& integral : bin_integrals(observer, centres)) {
                for (std::size_t c = 0; c < 3; ++c) sum[c] += integral[c];
            }
            const Xyz all = xyz_from_spectrum(Spectrum::constant(1), observer);
            EXPECT_NEAR(sum[0] / all.x, 1, 1e-9) << name;
            EXPECT_NEAR(sum[1] / all.y, 1, 1e-9) << name;
            EXPECT_NEAR(sum[2] / all.z, 1, 1e-9) << name;
        }
    }
}

TEST(SpectralBins, EachIsTheIntegralBetweenTheMiddlesOfItsNeighbours) {
    const Observer& eye = Observer::cie1931();
    const auto integrals = bin_integrals(eye, std::vector<double>{500, 510, 530});
    const auto between = [&](double from, double to) {  // knots are at whole nm
        double sum = 0;
        for (double at = from; at < to; ++at) sum += (eye.at(at)[1] + eye.at(at + 1)[1]) / 2;
        return sum;
    };
    EXPECT_NEAR(integrals[0][1], between(495, 505), 1e-12);
    EXPECT_NEAR(integrals[1][1], between(505, 520), 1e-12);
    EXPECT_NEAR(integrals[2][1], between(520, 540), 1e-12);
}

}  // namespace
}  // namespace latent::color
