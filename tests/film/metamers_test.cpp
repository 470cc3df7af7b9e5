// What the eye sees alike, and film does not.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "color/catalogue.h"
#include "color/film/exposure.h"
#include "color/film/process.h"
#include "color/light_name.h"
#include "color/power_of_ten.h"

namespace latent::film {
namespace {

using color::Spectrum;

double sum(const Curve& curve) {
    double all = 0;
    for (const double v : curve) all += v;
    return all;
}

// `reflectance` plus what nobody with the colour matching functions of 1931 sees under `light`: of `wish`, the part that X, Y and Z
// leave.
Curve metamer(const Curve& reflectance, const Curve& wish, const Curve& light) {
    Curves seen = matching();
    for (Curve& curve : seen) {
        for (std::size_t i = 0; i < kNm; ++i) curve[i] *= light[i];
    }
    std::array<Triple, 3> products{};
    Triple target{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) products[i][j] = dot(seen[i], seen[j]);
        target[i] = dot(seen[i], wish);
    }
    const Triple weights = solve(products, target);
    Curve out = reflectance;
    for (std::size_t i = 0; i < kNm; ++i)
        out[i] += wish[i] - weights[0] * seen[0][i] - weights[1] * seen[1][i] - weights[2] * seen[2][i];
    return out;
}

Spectrum spectrum_of(const Curve& curve) {
    std::vector<double> nm, value(curve.begin(), curve.end());
    for (std::size_t i = 0; i < kNm; ++i) nm.push_back(kFirstNm + static_cast<double>(i));
    return *Spectrum::from_samples(nm, value, color::Outside::kZero);
}

Curve product(const Curve& a, const Curve& b) {
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) out[i] = a[i] * b[i];
    return out;
}

Triple print_of(const Material& film, const char* paper, const Triple& exposures) {
    const double grey = color::log10_of(10 / film.exposure_index);
    const Process process = *Process::make({.film = film, .grey = {grey, grey, grey}, .paper = paper});
    const color::Xyz white = color::xyz_from_chromaticity(process.white());
    return lab(process(exposures), {white.x, white.y, white.z});
}

class Metamers : public ::testing::Test {
 protected:
    Curve light_ = light("D55"), grey_, other_;
    void SetUp() override {
        grey_.fill(0.3);
        Curve wish;
        for (std::size_t i = 0; i < kNm; ++i)
            wish[i] = i >= 270 && i < 330 ? 0.3 : i >= 40 && i < 70 ? 0.2 : 0;  // far red and violet
        other_ = metamer(grey_, wish, light_);
    }
};

TEST_F(Metamers, LookTheSameAndPrintDifferently) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(dot(product(light_, other_), matching()[c]), dot(product(light_, grey_), matching()[c]), 1e-9 * sum(light_));
    for (const auto& [name, paper] :
         {std::pair{"portra-400", "endura"}, {"gold-200", "supra-endura"}, {"velvia-50", "light-table"}}) {
        SCOPED_TRACE(name);
        const Material film = *find_material(name, true);
        const color::Observer layers = *film_observer(film, film.exposure_index);
        const auto exposures = [&](const Curve& reflectance) {
            const color::Xyz h = color::xyz_from_spectrum(spectrum_of(product(light_, reflectance)), layers);
            return Triple{h.x, h.y, h.z};
        };
        const Triple a = print_of(film, paper, exposures(grey_)), b = print_of(film, paper, exposures(other_));
        EXPECT_GT(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 3);
    }
}

// The layers are linear in light, so samples of any wavelengths have the integrals as their means.
TEST_F(Metamers, AreToldApartBySamplesAsByIntegrals) {
    const Material film = *find_material("portra-400", true);
    const color::Observer layers = *film_observer(film, 400);
    for (const Curve* reflectance : {&grey_, &other_}) {
        const Spectrum radiance = spectrum_of(product(light_, *reflectance));
        const color::Xyz exact = color::xyz_from_spectrum(radiance, layers);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> uniform(color::kLambdaMin, color::kLambdaMax);
        constexpr int kSamples = 200000;
        Triple mean{}, squares{};
        for (int i = 0; i < kSamples; ++i) {
            const double nm = uniform(random);
            const std::array<double, 3> seen = layers.at(nm);
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = radiance(nm) * seen[c] * (color::kLambdaMax - color::kLambdaMin);
                mean[c] += value / kSamples;
                squares[c] += value * value / kSamples;
            }
        }
        const Triple expected{exact.x, exact.y, exact.z};
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_LT(std::abs(mean[c] - expected[c]), 4.5 * std::sqrt((squares[c] - mean[c] * mean[c]) / kSamples)) << c;
    }
}

// Lamps whose light has the colour of daylight for the eye, or nearly so, and little red of the wavelengths that film sees.
TEST(FluorescentLight, IsGreenOnDaylightFilmUntilAMagentaFilterTakesItAway) {
    const Spectrum lamp = *color::light_by_name("F2");
    const Material film = *find_material("portra-400", true);
    const auto printed = [&](const color::Observer& layers) {
        const color::Xyz h = color::xyz_from_spectrum(lamp, layers);
        // A grey card, exposed so that green is right.
        const double scale = 10 / film.exposure_index / h.y;
        return print_of(film, "endura", {h.x * scale, h.y * scale, h.z * scale});
    };
    const color::Observer bare = *film_observer(film, film.exposure_index);
    const Triple plain = printed(bare), filtered = printed(bare.behind(*color::lens_filter("wratten-cc20m"), "", 1));
    EXPECT_LT(plain[1], -8);                                                              // green
    EXPECT_LT(std::hypot(filtered[1], filtered[2]), std::hypot(plain[1], plain[2]) / 3);  // no longer
}

}  // namespace
}  // namespace latent::film
