// Films whose two faces interfere: what closures reflect is the sum of all bounces in the film, in each wavelength.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"
#include "render/bsdf/schlick_albedo.h"
#include "render/sampling/warp.h"
#include "tests/transport/closure_examples.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

constexpr double kLambdas[] = {400, 480, 550, 620, 700};

// Textbook: amplitudes of each polarisation, with complex phases, bounce by bounce.
double of_all_bounces(double c, double film, double thickness_nm, double base, double lambda_nm) {
    using Complex = std::complex<double>;
    const double s2 = 1 - c * c, c2 = std::sqrt(1 - s2 / (film * film)), c3 = std::sqrt(1 - s2 / (base * base));
    const auto power = [&](double r12, double t12, double t21, double r23) {
        const Complex round = std::polar(1.0, 4 * std::numbers::pi * film * thickness_nm * c2 / lambda_nm);
        Complex sum = r12, wave = t12 * r23 * t21 * round;
        for (int bounce = 0; bounce < 400; ++bounce) {
            sum += wave;
            wave *= -r12 * r23 * round;  // r21 = -r12
        }
        return std::norm(sum);
    };
    const double s12 = (c - film * c2) / (c + film * c2), s23 = (film * c2 - base * c3) / (film * c2 + base * c3),
                 p12 = (film * c - c2) / (film * c + c2), p23 = (base * c2 - film * c3) / (base * c2 + film * c3);
    const double ts = 2 * c / (c + film * c2) * 2 * film * c2 / (c + film * c2),
                 tp = 2 * c / (film * c + c2) * 2 * film * c2 / (film * c + c2);
    return (power(s12, ts, 1, s23) + power(p12, tp, 1, p23)) / 2;
}

TEST(ThinFilm, IsTheSumOfAllBounces) {
    for (const double c : {1.0, 0.7, 0.3, 0.05}) {
        for (const double film : {1.0, 1.33, 2.2}) {
            for (const double thickness : {0.0, 120.0, 400.0, 1500.0}) {
                for (const double base : {1.2, 1.5, 4.0}) {
                    const ThinFilm::Ray ray(
                        {.share = 1, .eta = static_cast<float>(film), .thickness_nm = static_cast<float>(thickness)},
                        static_cast<float>(c));
                    for (const double nm : kLambdas) {
                        SCOPED_TRACE(::testing::Message() << c << " " << film << " " << thickness << " " << base << " " << nm);
                        // The phase is a float: of 1500 nm up to 16 turns, to 2^-20.
                        ASSERT_NEAR(ray.reflectance(static_cast<float>(base), static_cast<float>(nm)),
                                    of_all_bounces(c, film, thickness, base, nm), 2e-5);
                    }
                }
            }
        }
    }
}

// A film of no thickness, or of the base's index, is not there; a quarter of a wavelength of index sqrt(n) reflects nothing.
TEST(ThinFilm, HasTheLimitsThatOpticiansUse) {
    for (const float c : {1.0f, 0.6f, 0.2f}) {
        EXPECT_NEAR(ThinFilm::Ray({.share = 1, .eta = 1.7f, .thickness_nm = 0}, c).reflectance(1.5f, 550),
                    fresnel_dielectric(c, 1.5f), 2e-6);
        EXPECT_NEAR(ThinFilm::Ray({.share = 1, .eta = 1.5f, .thickness_nm = 700}, c).reflectance(1.5f, 480),
                    fresnel_dielectric(c, 1.5f), 2e-6);
    }
    const float n = std::sqrt(1.5f);
    EXPECT_LT(ThinFilm::Ray({.share = 1, .eta = n, .thickness_nm = 550 / (4 * n)}, 1).reflectance(1.5f, 550), 1e-10f);
    EXPECT_NEAR(ThinFilm::Ray({.share = 1, .eta = 2, .thickness_nm = 100}, 1).reflectance(1.5f, 800),
                std::pow((1.5f - 4) / (1.5f + 4), 2.0f), 1e-6);
}

// Wavelengths of the formula in the first lanes.
SampledSpectra& at_lambdas(SampledSpectra& spectra) {
    spectra.wavelengths.k = 5;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i)
        spectra.wavelengths.lambda_nm[i] = static_cast<float>(kLambdas[std::min<std::uint32_t>(i, 4)]);
    return spectra;
}

// Facets of a metal and of a dielectric without a body, over what they reflect without the film.
TEST(Iridescence, IsTheFilmOnFacets) {
    const SpectrumLibrary none;
    SampledSpectra spectra(none);
    at_lambdas(spectra);
    const Values& v = values();
    const ThinFilm film{.share = 1, .eta = 1.33f, .thickness_nm = 450};
    const Vec3f wo = normalize(Vec3f{0.3f, 0.5f, 0.6f}), wi = normalize(Vec3f{-0.5f, -0.2f, 0.7f}), m = normalize(wo + wi);
    const double c = dot(wo, m), rise = std::pow(1 - c, 5);
    const auto ratio = [&](const SampledSpectrum& base, MetallicRoughness::Parameters p, std::uint32_t i) {
        SampledSpectrum bare(1.0f), filmed(1.0f);
        MetallicRoughness(base, p).multiply_f_cos(wo, wi, bare);
        p.film = film;
        MetallicRoughness(base, p, nullptr, &spectra).multiply_f_cos(wo, wi, filmed);
        return static_cast<double>(filmed[i] / bare[i]);
    };
    const auto index = [](double f0) { return (1 + std::sqrt(f0)) / (1 - std::sqrt(f0)); };
    for (std::uint32_t i = 0; i < 5; ++i) {
        const double nm = kLambdas[i], f0 = 0.1, b = values().grey[i];
        EXPECT_NEAR(ratio(v.grey, {.metallic = 1, .alpha = 0.3f}, i) * (b + (1 - b) * rise),
                    of_all_bounces(c, 1.33F, 450, index(b), nm), 1e-4);
        EXPECT_NEAR(ratio(v.black, {.alpha = 0.3f, .f0 = 0.1f}, i) * (f0 + (1 - f0) * rise),
                    of_all_bounces(c, 1.33F, 450, index(f0), nm), 1e-4);
    }
}

// A soap bubble's wall: R' = 2 R / (1 + R) of two faces, R that of the film.
TEST(Iridescence, IsTheFilmOnPanesAndOnGlass) {
    const SpectrumLibrary none;
    SampledSpectra spectra(none);
    at_lambdas(spectra);
    const ThinFilm film{.share = 1, .eta = 1.33f, .thickness_nm = 300};
    const ThinDielectric pane(values().glass, false, 0, 0, 0, nullptr, film, &spectra.wavelengths);
    const Dielectric glass(values().glass, false, 0, 0, 0, nullptr, film, &spectra.wavelengths);
    for (const double c : {0.95, 0.4}) {
        const auto z = static_cast<float>(c), x = std::sqrt(1 - z * z);
        // From inside the glass, along the ray that leaves at c.
        const Vec3f out{x, 0, z}, in{x / 1.5f, 0, -std::sqrt(1 - x * x / 2.25f)};
        const auto reflected = [](const auto& closure, const Vec3f& w, std::uint32_t i) {
            ClosureSample sample;
            SampledSpectrum weight(1.0f);
            EXPECT_TRUE(closure.sample(w, 0, 0, 0, sample, weight));
            EXPECT_GT(sample.wi.z * w.z, 0);
            return static_cast<double>(weight[i] * sample.probability);
        };
        for (std::uint32_t i = 0; i < 5; ++i) {
            const double r = of_all_bounces(c, 1.33F, 300, 1.5, kLambdas[i]);
            EXPECT_NEAR(reflected(pane, out, i), 2 * r / (1 + r), 2e-5);
            EXPECT_NEAR(reflected(glass, out, i), r, 2e-5);
            EXPECT_NEAR(reflected(glass, in, i), r, 2e-5);
        }
    }
}

// The table's values are those of the integral, at its nodes (alpha 0.3007) and between them.
TEST(SchlickAlbedo, IsTheIntegralOverTheFacets) {
    for (const float alpha : {0.2664f, 0.29f, 0.3007f, 0.5f}) {
        for (const float mu : {0.97f, 0.46f}) {
            const Microfacets facets{alpha, alpha};
            const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
            constexpr int kSteps = 500;
            double sum = 0;
            for (int i = 0; i < kSteps * kSteps; ++i) {  // in cos^2, the middles of strata
                const float c = std::sqrt((static_cast<float>(i / kSteps) + 0.5f) / kSteps);
                const Vec3f wi = render::direction_at(c, (static_cast<float>(i % kSteps) + 0.5f) / kSteps);
                sum +=
                    static_cast<double>(facets.density(normalize(wo + wi)) * facets.masking_shadowing(wo, wi) / (4 * mu * c) * kPi);
            }
            EXPECT_NEAR(SchlickAlbedo(1, 1, alpha)(mu), sum / (kSteps * kSteps), 1e-3) << alpha << " " << mu;
        }
    }
}

// What the facets do not reflect, a white body under them gives back.
TEST(Iridescence, WhiteMatterUnderAFilmLosesLittle) {
    const SpectrumLibrary none;
    SampledSpectra spectra(none);
    at_lambdas(spectra);
    for (const float thickness : {150.0f, 400.0f, 800.0f}) {
        for (const float alpha : {0.05f, 0.4f}) {
            const MetallicRoughness white(
                values().white, {.alpha = alpha, .film = {.share = 1, .eta = 1.8f, .thickness_nm = thickness}}, nullptr, &spectra);
            for (const Vec3f& wo : {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.4f})}) {
                constexpr int kCount = 40'000;
                double sum[5] = {}, squares[5] = {};
                Numbers u(3);
                for (int n = 0; n < kCount; ++n) {
                    ClosureSample s;
                    SampledSpectrum weight(1.0f);
                    const float lobe = u(), x = u(), y = u();
                    if (!white.sample(wo, lobe, x, y, s, weight)) continue;
                    white.multiply_f_cos(wo, s.wi, weight);
                    for (int i = 0; i < 5; ++i) {
                        const double given = weight[static_cast<std::uint32_t>(i)] / white.pdf_omega(wo, s.wi);
                        sum[i] += given, squares[i] += given * given;
                    }
                }
                for (int i = 0; i < 5; ++i) {
                    const double mean = sum[i] / kCount, error = std::sqrt((squares[i] / kCount - mean * mean) / kCount);
                    EXPECT_NEAR(mean, 1, 4 * error + 0.005) << thickness << " " << alpha << " " << kLambdas[i];
                }
            }
        }
    }
}

// Inputs by name, of a place whose coordinates run as `mirrored` says.
MetallicRoughness brushed(std::initializer_list<std::pair<std::string_view, float>> numbers, bool mirrored = false) {
    static const SpectrumLibrary none;
    static SampledSpectra spectra(none);
    render::Values<MetallicRoughness> v({spectra, 0, {}, false, 0, mirrored});
    for (std::size_t i = 0; i < MetallicRoughness::kInputs.size(); ++i) {
        const Input& input = MetallicRoughness::kInputs[i];
        v[i].number = input.otherwise;
        if (input.name == "base_color") v[i].spectrum = &values().white;
        for (const auto& [name, value] : numbers) v[i].number = input.name == name ? value : v[i].number;
    }
    return MetallicRoughness(v);
}

float f_of(const MetallicRoughness& closure, const Vec3f& a, const Vec3f& b) {
    SampledSpectrum f(1.0f);
    closure.multiply_f_cos(a, b, f);
    return f[0];
}

// alpha_t = mix(alpha, 1, strength^2) along the tangent, alpha across [glTF2 KHR_materials_anisotropy]: of a white metal
// f = D G / (4 cos cos).
TEST(Anisotropy, HasTheFacetsThatItsExtensionSays) {
    Numbers u(1);
    const MetallicRoughness metal = brushed({{"metallic", 1}, {"roughness", 0.5f}, {"anisotropy", 0.6f}});
    const Microfacets facets{0.25f + 0.75f * 0.36f, 0.25f};
    for (int n = 0; n < 100; ++n) {
        const float a = u(), b = u(), c = u(), d = u();
        const Vec3f wo = sample_cosine_hemisphere(a, b), wi = sample_cosine_hemisphere(c, d), m = normalize(wo + wi);
        const float expected = facets.density(m) * facets.masking_shadowing(wo, wi) / (4 * wo.z);
        ASSERT_NEAR(f_of(metal, wo, wi), expected, 1e-4f * expected);
    }
}

// A rotation by a quarter, a picture whose vectors point along v, and directions turned the other way are the same; mirrored
// coordinates mirror what is seen.
TEST(Anisotropy, TurnsCounterclockwiseFromTheTangent) {
    using List = std::initializer_list<std::pair<std::string_view, float>>;
    const List turned = {{"metallic", 1}, {"roughness", 0.5f}, {"anisotropy", 0.8f}, {"anisotropy_turns", 0.125f}},
               pictured = {{"metallic", 1},
                           {"roughness", 0.5f},
                           {"anisotropy", 0.8f},
                           {"anisotropy_x", 0.75f},
                           {"anisotropy_y", 0.75f}},
               straight = {{"metallic", 1}, {"roughness", 0.5f}, {"anisotropy", 0.8f}};
    const auto back = [](const Vec3f& w) {
        const float h = std::sqrt(0.5f);
        return Vec3f{h * (w.x + w.y), h * (w.y - w.x), w.z};
    };
    const auto mirrored = [](const Vec3f& w) { return Vec3f{w.x, -w.y, w.z}; };
    Numbers u(2);
    for (int n = 0; n < 100; ++n) {
        const float a = u(), b = u(), c = u(), d = u();
        const Vec3f wo = sample_cosine_hemisphere(a, b), wi = sample_cosine_hemisphere(c, d);
        const float f = f_of(brushed(turned), wo, wi);
        ASSERT_NEAR(f_of(brushed(pictured), wo, wi), f, 1e-4f * f);
        ASSERT_NEAR(f_of(brushed(straight), back(wo), back(wi)), f, 1e-4f * f);
        ASSERT_NEAR(f_of(brushed(turned, true), mirrored(wo), mirrored(wi)), f, 1e-4f * f);
    }
}

}  // namespace
}  // namespace latent::render::testing
