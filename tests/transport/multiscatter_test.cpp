// Light that several facets reflect or refract: with it, what absorbs nothing loses nothing, at any roughness.
#include <gtest/gtest.h>

#include <cmath>

#include "render/bsdf/schlick_albedo.h"
#include "tests/transport/closure_examples.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

constexpr float kAlphas[] = {0.02f, 0.1f, 0.35f, 0.64f, 1};
constexpr double kTables = 0.004;  // between the nodes of the tables

// What comes back of a white furnace's light towards wo, its compression taken back, in the first wavelength.
template <class C>
void expect_albedo(const C& closure, const Vec3f& wo, double expected) {
    constexpr int kCount = 40'000;
    double sum = 0, squares = 0;
    Numbers u(3);
    for (int n = 0; n < kCount; ++n) {
        ClosureSample s;
        SampledSpectrum weight(1.0f);
        const float lobe = u(), x = u(), y = u();
        if (!closure.sample(wo, lobe, x, y, s, weight)) continue;
        closure.multiply_f_cos(wo, s.wi, weight);
        const double given = static_cast<double>(weight[0] / closure.pdf_omega(wo, s.wi) * s.eta2);
        sum += given, squares += given * given;
    }
    const double mean = sum / kCount, error = std::sqrt((squares / kCount - mean * mean) / kCount);
    EXPECT_NEAR(mean, expected, 4 * error + kTables) << wo.z;  // 4 standard errors
}

Vec3f direction(float mu) { return {std::sqrt(1 - mu * mu), 0, mu}; }

TEST(Multiscatter, WhiteMetalLosesNothing) {
    const SampledSpectrum eta(1.0f), k(2e4f);
    for (const float alpha : kAlphas) {
        SCOPED_TRACE(alpha);
        for (const float mu : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f, -0.6f}) {
            expect_albedo(MetallicRoughness(values().white, {.metallic = 1, .alpha = alpha, .multiscatter = true}), direction(mu),
                          1);
            expect_albedo(Conductor(eta, k, alpha, alpha, false, true), direction(mu), 1);
        }
    }
}

TEST(Multiscatter, WhiteMatterUnderRoughGlossLosesNothing) {
    for (const float alpha : kAlphas) {
        SCOPED_TRACE(alpha);
        for (const float mu : {0.2f, 0.9f}) {
            for (const SampledSpectrum* color : {static_cast<const SampledSpectrum*>(nullptr), &values().half})
                expect_albedo(MetallicRoughness(values().white, {.alpha = alpha, .f0 = 0.5f, .multiscatter = true}, color),
                              direction(mu), 1);
        }
    }
}

TEST(Multiscatter, ClearGlassLosesNothingFromEitherSide) {
    for (const float index : {1.1f, 1.5f, 2.4f, 1 / 1.5f}) {
        const SampledSpectrum eta(index);
        for (const float alpha : kAlphas) {
            SCOPED_TRACE(::testing::Message() << index << " " << alpha);
            for (const float mu : {0.1f, 0.4f, 0.7f, 1.0f, -0.1f, -0.4f, -0.7f, -1.0f})
                expect_albedo(Dielectric(eta, false, 0, alpha, alpha, nullptr, {}, nullptr, {}, true), direction(mu), 1);
        }
    }
}

// Of facets that reflect the share r at any angle, r^n of what n facets reflect remains. The rest after one, 1 - E, is taken to be
// reflected as diffuse light is, of which E_mean leaves at each further facet: r E + (1 - E) r sum r^n (1 - E_mean)^(n - 1) E_mean.
TEST(Multiscatter, GreyFacetsTakeTheirShareAtEachReflection) {
    for (const float alpha : kAlphas) {
        const SchlickAlbedo white(1, 1, alpha);
        for (const float mu : {0.2f, 0.9f}) {
            const double r = 0.6, e = static_cast<double>(white(mu)), mean = static_cast<double>(white.mean());
            double further = 0;
            for (int n = 1; n < 60; ++n) further += std::pow(r, n) * std::pow(1 - mean, n - 1) * mean;
            expect_albedo(MetallicRoughness(values().black, {.alpha = alpha, .f0 = 0.6f, .f90 = 0.6f, .multiscatter = true}),
                          direction(mu), r * e + (1 - e) * r * further);
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
