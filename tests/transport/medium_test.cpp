// Laws of media: distances are drawn as their density says, and the weights of a step add up to transmittance and single scattering
// in every wavelength, however differently these are absorbed.
#include <cmath>

#include "render/medium/homogeneous.h"
#include "render/sampling/halton_sampler.h"
#include "render/spectral/wavelength_density.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

class Steps : public ::testing::Test {
 protected:
    static color::Spectrum line(double at_360, double at_830) {
        return color::Spectrum::from_function([=](double nm) { return at_360 + (at_830 - at_360) * (nm - 360) / 470; },
                                              color::Outside::kZero);
    }
    Steps() {
        WavelengthSampler(wavelength_density({}), 28).draw(123456789, spectra_.wavelengths);
        spectra_.start_sample();
    }
    SpectrumLibrary library_;
    std::uint32_t sigma_t_ = library_.add(line(4, 0.05), Lookup::kNearestNm);  // red light hardly is absorbed
    std::uint32_t sigma_s_ = library_.add(line(3, 0.02), Lookup::kNearestNm);
    HomogeneousMedium fog_{sigma_t_, sigma_s_, kNone, PhaseFunction{}};
    SampledSpectra spectra_{library_};
    HaltonSampler sampler_{{}, 1, {}};
    SampleState sample_{{sampler_, 0}, spectra_, 0};
};

TEST_F(Steps, DistancesFollowTheMeanDensityOfAllWavelengths) {
    constexpr int kBins = 40, kCount = 200'000;
    constexpr double kLength = 1.5;
    const Segment segment{{}, {0, 0, 1}, 1.5f};
    const SampledSpectrum& sigma = spectra_[sigma_t_];
    const auto transmittance_of = [&](double t) {
        double sum = 0;
        for (std::uint32_t i = 0; i < 28; ++i) sum += std::exp(-static_cast<double>(sigma[i]) * t) / 28;
        return sum;
    };
    std::vector<double> counted(kBins + 1);
    Numbers u(12);
    for (int n = 0; n < kCount; ++n) {
        SampledSpectrum value(1.0f);
        const Uniform channel = u(), x = u();
        const MediumStep step = fog_.sample_step(segment, channel, x, sample_, value, nullptr);
        const double t = static_cast<double>(step.t);
        ++counted[step.scattered ? static_cast<std::size_t>(t / kLength * kBins) : kBins];
        ASSERT_NEAR(step.transmittance, transmittance_of(t), 1e-5);
        if (!step.scattered) {
            ASSERT_EQ(step.density, step.transmittance);
            continue;
        }
        ASSERT_NEAR(step.density, (transmittance_of(t - 1e-4) - transmittance_of(t + 1e-4)) / 2e-4, 1e-4);
        ASSERT_NEAR(fog_.scattering_over_transmittance({}, step.column, sample_), step.density / step.transmittance, 1e-4);
    }
    double chi2 = 0;
    for (int b = 0; b <= kBins; ++b) {
        const double from = transmittance_of(b * kLength / kBins),
                     to = b == kBins ? 0 : transmittance_of((b + 1) * kLength / kBins);
        const double expected = kCount * (from - to);
        chi2 += (counted[static_cast<std::size_t>(b)] - expected) * (counted[static_cast<std::size_t>(b)] - expected) / expected;
    }
    EXPECT_GT(chi_square_tail(chi2, kBins), 1e-4) << chi2;
}

// Means of the weights: e^(-sigma_t d) of what passes, sigma_s / sigma_t (1 - e^(-sigma_t d)) of what is scattered.
TEST_F(Steps, WeightsAddUpToTransmittanceAndScattering) {
    const SampledSpectrum &sigma_t = spectra_[sigma_t_], &sigma_s = spectra_[sigma_s_];
    constexpr int kCount = 400'000;
    constexpr float kLength = 0.7f;
    const Segment segment{{}, {0, 0, 1}, kLength};
    std::array<std::array<double, 2>, 28> unscattered{}, scattered{};  // sum and sum of squares
    Numbers u(13);
    for (int n = 0; n < kCount; ++n) {
        SampledSpectrum value(1.0f);
        const Uniform channel = u(), x = u();
        auto& sums = fog_.sample_step(segment, channel, x, sample_, value, nullptr).scattered ? scattered : unscattered;
        for (std::uint32_t i = 0; i < 28; ++i) {
            sums[i][0] += static_cast<double>(value[i]);
            sums[i][1] += static_cast<double>(value[i]) * static_cast<double>(value[i]);
        }
    }
    const auto expect_mean = [](const std::array<double, 2>& sums, double expected) {
        const double mean = sums[0] / kCount;
        EXPECT_NEAR(mean, expected, 5 * std::sqrt((sums[1] / kCount - mean * mean) / kCount) + 1e-6);
    };
    for (std::uint32_t i = 0; i < 28; ++i) {
        const double t = static_cast<double>(sigma_t[i]), transmittance = std::exp(-t * static_cast<double>(kLength));
        expect_mean(unscattered[i], transmittance);
        expect_mean(scattered[i], static_cast<double>(sigma_s[i]) / t * (1 - transmittance));
    }
}

}  // namespace
}  // namespace latent::render::testing
