// Laws of wavelengths and spectra: sums over a batch are unbiased for any response; tables are the functions that they stand for.
#include "render/spectral/spectra.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "color/light_spectrum.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/visible_density.h"
#include "render/spectral/wavelength_density.h"
#include "tests/transport/chi_square.h"

namespace latent::render::testing {
namespace {

color::Spectrum samples(std::vector<double> nm, std::vector<double> value, color::Outside outside = color::Outside::kZero) {
    return *color::Spectrum::from_samples(std::move(nm), std::move(value), outside);
}

color::Spectrum sodium() { return samples({360, 586.5, 588.5, 590.5, 592.5, 830}, {0, 0, 1, 1, 0, 0}); }

// Average of sum_i f(lambda_i) / (k p(lambda_i)) over an even grid of offsets: what a file's pairs add up to.
double estimate(const sampledb::WavelengthDensity& density, std::uint32_t k, const std::function<double(double)>& f,
                int offsets = 4096) {
    const WavelengthSampler sampler(density, k);
    Wavelengths w;
    double sum = 0;
    for (int n = 0; n < offsets; ++n) {
        sampler.draw(static_cast<std::uint32_t>((n + 0.5) / offsets * 0x1p32), w);
        for (std::uint32_t i = 0; i < k; ++i) sum += f(static_cast<double>(w.lambda_nm[i])) * static_cast<double>(w.weight[i]);
    }
    return sum / offsets;
}

TEST(Wavelengths, AnyResponseIsMetOnAverage) {
    const auto smooth = [](double nm) { return 1 + std::sin(nm / 37); };
    const double exact = 470 - 37 * (std::cos(830.0 / 37) - std::cos(360.0 / 37));
    for (const bool spike : {false, true}) {
        std::vector<LightSpectrum> lights{{color::illuminant_d65(), 1}};
        if (spike) lights.push_back({sodium(), 3});
        const sampledb::WavelengthDensity density = wavelength_density(lights);
        for (const std::uint32_t k : {4u, 28u, 32u}) {
            EXPECT_NEAR(estimate(density, k, smooth), exact, 1e-4 * exact);
            EXPECT_NEAR(estimate(density, k, [](double nm) { return nm >= 585 && nm < 595 ? 1.0 : 0.0; }), 10, 0.01);
        }
    }
}

// Beside the finest line there is p 2000 times smaller than within it: a wavelength that floats round across the edge must weigh
// what it was drawn with. 470 nm are whole to 1e-5, of which the eye sees most in 100.
TEST(Wavelengths, AContinuumIsAsBrightBesideALine) {
    for (const double line : {435.83, 546.074, 589.0, 632.8, 700.3}) {
        for (const double width : {0.05, 0.2, 1.0}) {
            const color::Spectrum lamp =
                samples({360, line - width / 2, line - width / 4, line + width / 4, line + width / 2, 830}, {0, 0, 1, 1, 0, 0});
            const sampledb::WavelengthDensity density = wavelength_density({{lamp, 1}, {color::illuminant_d65(), 1}});
            const auto near = [&](double nm) { return std::abs(nm - line) < 1.5 ? 1.0 : 0.0; };
            EXPECT_NEAR(estimate(density, 28, near, 1 << 16), 3, 3e-3) << line << " " << width;
        }
    }
}

// One wavelength of each of many independent batches, in cells of 10 nm, about a line of 1/2 nm.
TEST(Wavelengths, FollowTheDensityOfTheJob) {
    for (const bool line : {false, true}) {
        std::vector<LightSpectrum> lights{{color::illuminant_d65(), 1}};
        if (line) lights.push_back({sodium(), 3});
        const sampledb::WavelengthDensity density = wavelength_density(lights);
        std::vector<double> edges;
        for (int nm = 360; nm <= 830; nm += 10) edges.push_back(nm);
        for (double nm = 586; nm <= 593; nm += 0.5) {
            if (nm != 590) edges.push_back(nm);
        }
        std::sort(edges.begin(), edges.end());
        for (const std::uint32_t k : {4u, 28u}) {
            SCOPED_TRACE(fmt::format("{} wavelengths, {}", k, line ? "a line" : "no line"));
            constexpr int kCount = 400'000;
            std::vector<double> counted(edges.size() - 1), expected(counted.size());
            for (std::size_t i = 0; i < expected.size(); ++i) {
                // The density is constant between multiples of 1/2 nm.
                for (double nm = edges[i]; nm < edges[i + 1]; nm += 0.5) {
                    expected[i] += kCount * 0.5 * static_cast<double>(density.pdf_lambda(static_cast<float>(nm + 0.25)));
                }
            }
            const WavelengthSampler sampler(density, k);
            std::mt19937 engine(16);
            Wavelengths w;
            for (int n = 0; n < kCount; ++n) {
                sampler.draw(static_cast<std::uint32_t>(engine()), w);
                const float nm = w.lambda_nm[static_cast<std::uint32_t>(n) % k];
                const auto above = std::upper_bound(edges.begin(), edges.end(), static_cast<double>(nm));
                ++counted.at(static_cast<std::size_t>(above - edges.begin()) - 1);
            }
            expect_counts_follow(counted, expected);
        }
    }
}

TEST(Wavelengths, WithoutLinesTheyGoWhereTheEyeLooks) {
    const color::Spectrum tungsten = *color::Spectrum::blackbody(2856);
    const sampledb::WavelengthDensity density = wavelength_density({{color::illuminant_d65(), 1}, {tungsten, 1}});
    for (const double nm : {400.5, 500.5, 538.5, 600.5, 700.5}) {
        EXPECT_NEAR(density.pdf_lambda(static_cast<float>(nm)), 0.91 * color::visible_pdf_lambda(nm) + 0.09 / 470, 1e-6);
    }
}

TEST(Wavelengths, OfALampWithLinesAQuarterGoesThere) {
    const sampledb::WavelengthDensity density = wavelength_density({{color::illuminant_d65(), 5}, {sodium(), 1}});
    const auto at = [&](double nm) { return static_cast<double>(density.pdf_lambda(static_cast<float>(nm))); };
    const auto others = [](double nm) { return 0.63 * color::visible_pdf_lambda(nm) + 0.09 / 470; };
    // Steps of the table by integer nm: 1/4, 3/4, 1, 1, 3/4, 1/4 nm from 586.5 on, 4 nm in all.
    EXPECT_NEAR(at(589.2), others(589.2) + 0.28 / 4, 1e-5);
    EXPECT_NEAR(at(587.1), others(587.1) + 0.28 / 16, 1e-5);
    EXPECT_NEAR(at(500.2), others(500.2), 1e-5);
}

TEST(Wavelengths, ThePowerOfLightsWithLinesMixesThem) {
    const color::Spectrum green = samples({360, 545, 546, 547, 830}, {0, 0, 1, 0, 0});
    const sampledb::WavelengthDensity density = wavelength_density({{sodium(), 3}, {green, 1}});
    const auto others = [](double nm) { return 0.63 * color::visible_pdf_lambda(nm) + 0.09 / 470; };
    EXPECT_NEAR(density.pdf_lambda(546.1f), others(546.1) + 0.28 / 4, 1e-4);
    EXPECT_NEAR(density.pdf_lambda(589.1f), others(589.1) + 0.28 * 3 / 4 / 4, 1e-4);
}

TEST(Wavelengths, AWidenedLineIsLightThatWavelengthsFindAndWhosePowerTheyKeep) {
    const color::Spectrum line = samples({360, 588.999, 589, 589.001, 830}, {0, 0, 1000, 0, 0});
    const color::Spectrum wide = with_lines_widened(line);
    const sampledb::WavelengthDensity density = wavelength_density({{line, 1}});
    EXPECT_GT(density.pdf_lambda(589.0f), 1);
    const SpectrumTable table(wide, Lookup::kNearestNm);
    const WavelengthSampler sampler(wavelength_density({{wide, 1}}), 28);
    double sum = 0;
    Wavelengths w;
    SampledSpectrum value;
    for (int n = 0; n < 65536; ++n) {
        sampler.draw(static_cast<std::uint32_t>(n) << 16, w);
        table.evaluate(w, value);
        for (std::uint32_t i = 0; i < w.k; ++i) sum += static_cast<double>(value[i] * w.weight[i]) / 65536;
    }
    EXPECT_NEAR(sum, 1, 2e-3);
}

// A spectrometer's file: more knots than a header holds.
TEST(Wavelengths, OfManyKnotsNearOnesAreJoinedAndTheLineIsFound) {
    std::vector<double> nm, value;
    for (int i = 0; i <= 9400; ++i) {
        nm.push_back(360 + 0.05 * i);
        value.push_back(std::exp(-std::pow((nm.back() - 589) / 0.3, 2)));
    }
    const sampledb::WavelengthDensity density = wavelength_density({{samples(nm, value), 1}});
    EXPECT_LE(density.knots().size(), 4096u);
    double share = 0;  // of 588..590 nm: all of the line
    for (int i = 0; i < 2000; ++i) share += 0.001 * static_cast<double>(density.pdf_lambda(static_cast<float>(588 + 0.001 * i)));
    EXPECT_NEAR(share, 0.28 + 2 * (0.63 * color::visible_pdf_lambda(589) + 0.09 / 470), 1e-3);
    EXPECT_NEAR(estimate(density, 28, [](double) { return 1.0; }), 470, 0.05);
}

class Table : public ::testing::Test {
 protected:
    void expect_equal(const color::Spectrum& s, Lookup lookup, const std::function<double(double)>& exact, double tolerance) {
        const sampledb::WavelengthDensity density = wavelength_density({});
        const WavelengthSampler sampler(density, 28);
        const SpectrumTable table(s, lookup);
        Wavelengths w;
        SampledSpectrum value;
        for (std::uint32_t n = 0; n < 5000; ++n) {
            sampler.draw(n * 858993u, w);
            table.evaluate(w, value);
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                ASSERT_NEAR(value[i], exact(static_cast<double>(w.lambda_nm[i])), tolerance) << w.lambda_nm[i];
            }
        }
    }
};

TEST_F(Table, OfIntegerKnotsIsThePiecewiseLinearFunction) {
    const color::Spectrum s = samples({360, 560, 580, 600, 620, 650, 830}, {0.05, 0.05, 0.12, 0.4, 0.58, 0.64, 0.66});
    expect_equal(
        s, Lookup::kLinear, [&](double nm) { return s(nm); }, 1e-6);
}
TEST_F(Table, OfOtherKnotsIsThePiecewiseLinearFunctionToo) {
    const color::Spectrum s = samples({400.3, 560.71, 580.2, 612.9, 700.5}, {0.05, 0.85, 0.12, 0.4, 0.58});
    expect_equal(
        s, Lookup::kLinear, [&](double nm) { return s(nm); }, 2e-6);
    const color::Spectrum c =
        samples({400.3, 560.71, 580.2, 612.9, 700.5}, {0.05, 0.85, 0.12, 0.4, 0.58}, color::Outside::kClamped);
    expect_equal(
        c, Lookup::kLinear, [&](double nm) { return c(nm); }, 2e-6);
}
TEST_F(Table, OfLightsHoldsTheNearestInteger) {
    const color::Spectrum s = color::illuminant_d65();
    expect_equal(
        s, Lookup::kNearestNm, [&](double nm) { return s(std::floor(nm + 0.5)); }, 1e-4);
}

TEST(SpectrumLibrary, StoresEqualSpectraOnce) {
    SpectrumLibrary library;
    const std::uint32_t a = library.add(sodium(), Lookup::kLinear);
    EXPECT_EQ(library.add(sodium(), Lookup::kLinear), a);
    EXPECT_NE(library.add(sodium(), Lookup::kNearestNm), a);
    EXPECT_EQ(library.size(), 2u);
}

TEST(SampledSpectra, LevelsAreTheValuesOfASpectrumThatHasFew) {
    SpectrumLibrary library;
    const std::uint32_t few = library.add(samples({400, 500, 501, 700}, {2, 2, 0, 0}), Lookup::kNearestNm);  // 0 before 400 nm, too
    const std::uint32_t many = library.add(samples({360, 830}, {1, 3}), Lookup::kNearestNm);
    SampledSpectra spectra(library);
    const WavelengthSampler sampler(wavelength_density({}), 28);
    for (std::uint32_t xi = 0; xi < 4000000000u; xi += 99999999u) {
        sampler.draw(xi, spectra.wavelengths);
        spectra.start_sample();
        EXPECT_EQ(spectra.levels(many).count, 0u);
        const SpectrumLevels& levels = spectra.levels(few);
        ASSERT_EQ(levels.count, 2u);
        EXPECT_NEAR(levels.share[0] + levels.share[1], 1, 1e-5);
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float in0 = (*levels.members[0])[i], in1 = (*levels.members[1])[i];
            EXPECT_EQ(in0 + in1, i < 28 ? 1 : 0);
            EXPECT_EQ(in0 * levels.value[0] + in1 * levels.value[1], i < 28 ? spectra[few][i] : 0);
        }
    }
}

// Of scene spectra and of values at single points alike, also in a sample that needs more of them than any before.
TEST(SampledSpectra, ValuesHoldUntilTheNextSample) {
    SpectrumLibrary library;
    const std::uint32_t first = library.add(sodium(), Lookup::kLinear),
                        second = library.add(color::illuminant_d65(), Lookup::kLinear);
    const WavelengthSampler sampler(wavelength_density({}), 28);
    SampledSpectra spectra(library);
    for (const std::uint32_t count : {3u, 1000u, 5u}) {
        sampler.draw(count * 858993u, spectra.wavelengths);
        spectra.start_sample();
        const SampledSpectrum& line = spectra[first];
        std::vector<const SampledSpectrum*> points;
        for (std::uint32_t i = 0; i < count; ++i) {
            SampledSpectrum& value = spectra.allocate();
            value = SampledSpectrum(static_cast<float>(i));
            points.push_back(&value);
        }
        const SampledSpectrum& daylight = spectra[second];
        for (std::uint32_t wavelength = 0; wavelength < kMaxWavelengths; ++wavelength) {
            const double nm = static_cast<double>(spectra.wavelengths.lambda_nm[wavelength]);
            ASSERT_NEAR(line[wavelength], sodium()(nm), 1e-6);
            ASSERT_NEAR(daylight[wavelength], color::illuminant_d65()(nm), 1e-4);
            for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ((*points[i])[wavelength], static_cast<float>(i));
        }
        EXPECT_EQ(&spectra[first], &line);
    }
}

}  // namespace
}  // namespace latent::render::testing
