// Laws of every closure in the list and of phase functions: they are drawn as their densities say, reciprocal, and give back no
// more than they get.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "render/bsdf/fresnel.h"
#include "render/sampling/warp.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/closure_examples.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

// The shading normal; ng is z.
// The normal of a coat that does not follow the surface.
const Vec3f kCoat = normalize(Vec3f{-0.2f, 0.3f, 1});
const Vec3f kUp{0, 0, 1}, kTilted = normalize(Vec3f{0.25f, -0.15f, 1}), kFarTilted = normalize(Vec3f{1.5f, 0, 1});

Scattering with_normal(const PhaseFunction& phase, const Vec3f&) { return phase; }
Scattering with_normal(const Closure auto& closure, const Vec3f& ns) { return Bsdf(Frame::from_z(ns), kUp, closure); }

struct Case {
    std::string name;
    Scattering scattering;
    Vec3f ns;
    double eta;
    std::optional<std::uint32_t> kept;
    bool loses_nothing;
    bool own_coat = false;  // f is then not that of one normal
};

// Every example under every normal.
template <class T>
std::vector<Case> cases(const std::vector<Vec3f>& normals = {kUp, kTilted}) {
    std::vector<Case> list;
    for (const Example<T>& e : examples<T>()) {
        for (const Vec3f& ns : normals) {
            const bool straight = ns == kUp;
            list.push_back({e.name + (straight ? "" : ", tilted normal"), with_normal(e.scatters, ns), ns, e.eta, e.kept,
                            e.loses_nothing && straight});
            if (std::is_same_v<T, PhaseFunction>) break;
        }
        if constexpr (requires { e.scatters.is_coated(); }) {
            if (!e.scatters.is_coated()) continue;
            Bsdf bsdf(Frame::from_z(normals.back()), kUp, e.scatters);
            bsdf.lay_coat(kCoat);
            list.push_back({e.name + ", a coat of another normal", bsdf, normals.back(), e.eta, e.kept, false, true});
        }
    }
    EXPECT_FALSE(list.empty());
    return list;
}

template <class T>
struct ClosureLaws : ::testing::Test {
    static std::vector<Case> rough() { return chosen(false); }
    static std::vector<Case> smooth() { return chosen(true); }

 private:
    static std::vector<Case> chosen(bool delta) {
        std::vector<Case> list = cases<T>();
        std::erase_if(list, [&](const Case& c) { return c.scattering.is_delta() != delta; });
        return list;
    }
};
TYPED_TEST_SUITE(ClosureLaws, TypesOf<SurfaceClosure>::WithPhase, NameOf);

template <class T>
struct SurfaceLaws : ::testing::Test {};
TYPED_TEST_SUITE(SurfaceLaws, TypesOf<SurfaceClosure>::Closures, NameOf);

// From before the surface, and from behind: beyond total reflection of glass and short of it.
const std::vector<Vec3f> kDirections = {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.4f}),
                                        normalize(Vec3f{0.5f, -0.4f, -0.6f}), normalize(Vec3f{-0.3f, 0.1f, -0.9f})};

// Whether a camera at w sees ns as it is, since its reflection stays on w's side of the surface.
bool keeps_normal(const Case& c, const Vec3f& w) {
    return c.scattering.in_medium() ||
           (2 * dot(c.ns, w) * c.ns.z - w.z) * w.z > std::min(0.9f * std::abs(w.z), 0.011f) * std::abs(w.z);
}

// What a light subpath's step from wo to wi has over f |wi.ns| / pdf [Veach97 5.3].
double light_side(const Case& c, const Vec3f& wo, const Vec3f& wi) {
    if (c.scattering.in_medium()) return 1;
    return static_cast<double>(abs_dot(wo, c.ns) * std::abs(wi.z)) / static_cast<double>(std::abs(wo.z) * abs_dot(wi, c.ns));
}

TYPED_TEST(ClosureLaws, DirectionsFollowTheirDensity) {
    for (const Case& c : this->rough()) {
        for (std::size_t d = 0; d < kDirections.size(); ++d) {
            SCOPED_TRACE(c.name + ", direction " + std::to_string(d));
            const Vec3f wo = kDirections[d];
            Numbers u(static_cast<std::uint32_t>(d + 1));
            for (const bool from_camera : {true, false})
                expect_directions_follow(
                    {.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                         BsdfSample s;
                         SampledSpectrum beta(1.0f);
                         const float lobe = u(), x = u(), y = u();
                         if (!c.scattering.sample(wo, from_camera, lobe, x, y, s, beta) || s.delta) return std::nullopt;
                         return s.wi;
                     },
                     .pdf_omega = [&](const Vec3f& wi) { return static_cast<double>(c.scattering.pdf_omega(wo, wi, from_camera)); },
                     .count = 60'000});
        }
    }
}

// The weight of a drawn direction is f |cos| / pdf of evaluating it, from either side.
TYPED_TEST(ClosureLaws, WeightsAreWhatEvaluationSays) {
    for (const Case& c : this->rough()) {
        SCOPED_TRACE(c.name);
        Numbers u(7);
        for (int n = 0; n < 2000; ++n) {
            const Vec3f wo = kDirections[static_cast<std::size_t>(n) % kDirections.size()];
            const bool from_camera = n % 2 == 0;
            BsdfSample s;
            SampledSpectrum beta(1.0f), f(1.0f);
            const float lobe = u(), x = u(), y = u();
            if (!c.scattering.sample(wo, from_camera, lobe, x, y, s, beta) || s.delta) continue;
            ASSERT_FLOAT_EQ(s.pdf, c.scattering.pdf_omega(wo, s.wi, from_camera));
            ASSERT_FLOAT_EQ(c.scattering.pdf_reverse(wo, s, from_camera), c.scattering.pdf_omega(s.wi, wo, !from_camera));
            c.scattering.multiply_f_cos(from_camera ? wo : s.wi, from_camera ? s.wi : wo, f);
            const float side = from_camera || c.scattering.in_medium() ? 1 : std::abs(s.wi.z / wo.z);  // ng is z
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) ASSERT_NEAR(beta[i], f[i] * side / s.pdf, 2e-5f * beta[i] + 1e-7f);
        }
    }
}

// f(a, b) = f(b, a); refraction: eta_b^2 f(a, b) = eta_a^2 f(b, a), as radiance is compressed on its way.
TYPED_TEST(ClosureLaws, RoughScatteringIsReciprocal) {
    if (std::is_same_v<TypeParam, Measured>) GTEST_SKIP() << "measurements are so but for their errors: measured_test.cpp";
    for (const Case& c : this->rough()) {
        if (c.own_coat) continue;
        SCOPED_TRACE(c.name);
        Numbers u(11);
        for (int n = 0; n < 2000; ++n) {
            const auto direction = [&] {
                const float z = 2 * u() - 1, phi = u() * 2 * kPi, s = std::sqrt(1 - z * z);
                return Vec3f{s * std::cos(phi), s * std::sin(phi), z};
            };
            const Vec3f a = direction(), b = direction();
            const bool medium = c.scattering.in_medium();
            const double cos_a = medium ? 1 : static_cast<double>(dot(a, c.ns)),
                         cos_b = medium ? 1 : static_cast<double>(dot(b, c.ns));
            if (std::abs(cos_a) < 0.02 || std::abs(cos_b) < 0.02) continue;
            if (!keeps_normal(c, a) || !keeps_normal(c, b)) continue;
            SampledSpectrum there(1.0f), back(1.0f);
            c.scattering.multiply_f_cos(a, b, there);
            c.scattering.multiply_f_cos(b, a, back);
            const double forth = static_cast<double>(there[5]) / std::abs(cos_b),
                         home = static_cast<double>(back[5]) / std::abs(cos_a);
            const double eta = cos_a * cos_b > 0 ? 1 : cos_a > 0 ? c.eta : 1 / c.eta;  // of b's side over a's
            ASSERT_NEAR(forth * eta * eta, home, 2e-4 * home + 1e-5);                  // 1 - F loses digits at grazing angles
        }
    }
}

// The two lobes of a delta function come as often as the probabilities that they say, which weights count on.
TYPED_TEST(ClosureLaws, SmoothLobesComeAsOftenAsTheySay) {
    for (const Case& c : this->smooth()) {
        if (!(c.ns == kUp)) continue;  // some of their directions are absorbed
        for (const Vec3f& wo : kDirections) {
            SCOPED_TRACE(c.name);
            Numbers u(13);
            constexpr int kCount = 100'000;
            std::array<int, 2> counted{};
            std::array<double, 2> probability{};
            for (int n = 0; n < kCount; ++n) {
                BsdfSample s;
                SampledSpectrum beta(1.0f);
                ASSERT_TRUE(c.scattering.sample(wo, n % 2 == 0, u(), 0, 0, s, beta));
                const std::size_t lobe = s.wi.z * wo.z > 0 ? 0 : 1;
                if (counted[lobe]++ == 0) probability[lobe] = static_cast<double>(s.pdf);
                ASSERT_EQ(static_cast<double>(s.pdf), probability[lobe]);
            }
            EXPECT_NEAR(probability[0] + probability[1], 1, 1e-6);
            const double error = std::sqrt(kCount * probability[0] * (1 - probability[0]));
            EXPECT_LE(std::abs(counted[0] - kCount * probability[0]), 3.891 * error);  // the binomial's two tails of 1e-4
        }
    }
}

// Beside other directions, the one of a delta function comes as often as it says, mirrored, with the same weight both ways.
TYPED_TEST(ClosureLaws, MirrorsAmongOtherDirectionsComeAsOftenAsTheySay) {
    for (const Case& c : this->rough()) {
        if (!(c.ns == kUp)) continue;
        for (const Vec3f& wo : kDirections) {
            SCOPED_TRACE(c.name);
            Numbers u(17);
            constexpr int kCount = 50'000;
            int counted = 0;
            BsdfSample mirrored{};
            for (int n = 0; n < kCount; ++n) {
                BsdfSample s;
                SampledSpectrum beta(1.0f), back(1.0f);
                const float lobe = u(), x = u(), y = u();
                if (!c.scattering.sample(wo, n % 2 == 0, lobe, x, y, s, beta) || !s.delta) continue;
                if (counted++ > 0) {
                    ASSERT_NEAR(s.pdf, mirrored.pdf, 2e-6f * s.pdf);
                    continue;
                }
                mirrored = s;
                ASSERT_LT(length(s.wi - Vec3f{-wo.x, -wo.y, wo.z}), 1e-6f);
                ASSERT_TRUE(c.scattering.sample(s.wi, n % 2 == 0, 0, x, y, s, back));
                ASSERT_TRUE(s.delta);
                ASSERT_NEAR(s.pdf, mirrored.pdf, 2e-6f * s.pdf);
                ASSERT_NEAR(s.probability_reverse, mirrored.pdf, 2e-6f * s.pdf);
                for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) ASSERT_NEAR(beta[i], back[i], 1e-5f * beta[i]);
            }
            if (counted == 0) continue;
            const double p = static_cast<double>(mirrored.pdf), error = std::sqrt(kCount * p * (1 - p));
            EXPECT_LE(std::abs(counted - kCount * p), 3.891 * error);
        }
    }
}

// The same path, walked backwards, by the other kind of subpath, and by the other kind backwards, carries the same power: radiance
// is compressed by eta^2, the rest is symmetric, F at an angle outside is F at the refracted angle inside. Coefficients are weights
// times probabilities.
TYPED_TEST(ClosureLaws, SmoothScatteringIsReciprocal) {
    int met = 0, refracted = 0;
    for (const Case& c : this->smooth()) {
        for (const Vec3f& wo : kDirections) {
            for (const float lobe : {0.0f, 1 - 0x1p-24f}) {
                SCOPED_TRACE(c.name);
                BsdfSample there, back, from_light, light_back;
                SampledSpectrum beta(1.0f), beta_back(1.0f), beta_light(1.0f), beta_light_back(1.0f);
                if (!c.scattering.sample(wo, true, lobe, 0, 0, there, beta)) continue;
                ASSERT_TRUE(c.scattering.sample(there.wi, true, lobe, 0, 0, back, beta_back));
                if (there.probability_reverse == 0 ||
                    back.probability_reverse == 0) {  // seen about a normal that light does not know
                    ASSERT_FALSE(keeps_normal(c, there.probability_reverse == 0 ? wo : there.wi));
                    continue;
                }
                ASSERT_TRUE(c.scattering.sample(wo, false, lobe, 0, 0, from_light, beta_light));
                ASSERT_TRUE(c.scattering.sample(there.wi, false, lobe, 0, 0, light_back, beta_light_back));
                ASSERT_LT(length(back.wi - wo), 2e-6f);
                ASSERT_EQ(from_light.wi, there.wi);
                ASSERT_EQ(from_light.pdf, there.pdf);
                const bool refracts = c.eta != 1 && there.wi.z * wo.z < 0;
                EXPECT_NEAR(there.eta2, !refracts ? 1 : std::pow(c.eta, wo.z > 0 ? 2 : -2), 1e-6);
                // The reverse density is that of the way back, per solid angle on its own side.
                const float ratio = refracts ? abs_dot(there.wi, c.ns) * there.eta2 / abs_dot(wo, c.ns) : 1;
                EXPECT_NEAR(there.probability_reverse * ratio, back.pdf, 1e-5f * back.pdf);
                for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                    if (refracts && c.kept && i != *c.kept) continue;
                    const float power = beta[i] * there.pdf * there.eta2;
                    ASSERT_NEAR(beta_back[i] * back.pdf * back.eta2, power, 1e-5f * power);
                    ASSERT_NEAR(static_cast<double>(beta_light[i] * from_light.pdf) / light_side(c, wo, there.wi), power,
                                1e-5f * power);
                    ASSERT_NEAR(static_cast<double>(beta_light_back[i] * light_back.pdf) / light_side(c, there.wi, wo), power,
                                1e-5f * power);
                }
                ++met;
                refracted += refracts;
            }
        }
    }
    if (!this->smooth().empty()) {
        EXPECT_GE(met, 12);
    }
    if (std::is_same_v<TypeParam, Dielectric>) {
        EXPECT_GE(refracted, 12);
    }
}

// Every vertex gives back at most what it gets, smooth glass, panes and fog all of it: of a white furnace's radiance, its
// compression taken back, and of the power of light that comes along, the cosines' ratio taken back. In every wavelength, within 4
// standard errors.
TYPED_TEST(ClosureLaws, ConserveEnergy) {
    for (const Case& c : cases<TypeParam>()) {
        for (const Vec3f& wo : kDirections) {
            for (const bool from_camera : {true, false}) {
                if (c.own_coat && !from_camera) continue;  // the ratio of the cosines differs from lobe to lobe
                SCOPED_TRACE(c.name + (from_camera ? ", from the camera" : ", from the light"));
                Numbers u(3);
                constexpr int kCount = 20'000;
                std::array<double, kMaxWavelengths> sum{}, squares{};
                for (int n = 0; n < kCount; ++n) {
                    BsdfSample s;
                    SampledSpectrum beta(1.0f);
                    const float lobe = u(), x = u(), y = u();
                    if (!c.scattering.sample(wo, from_camera, lobe, x, y, s, beta)) continue;
                    const double back = from_camera ? static_cast<double>(s.eta2) : 1 / light_side(c, wo, s.wi);
                    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                        const double given = static_cast<double>(beta[i]) * back;
                        sum[i] += given;
                        squares[i] += given * given;
                    }
                }
                for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                    if (c.kept && i != *c.kept) continue;
                    const double mean = sum[i] / kCount, variance = std::max(0.0, squares[i] / kCount - mean * mean);
                    const double tolerance = 4 * std::sqrt(variance / kCount) + 1e-5;  // and the rounding of floats
                    ASSERT_LT(mean, 1 + tolerance) << i;
                    if (c.loses_nothing) {
                        ASSERT_GT(mean, 1 - tolerance) << i;
                    }
                }
            }
        }
    }
}

// What is reflected stays on its side of the surface, what is transmitted does not, however far the shading normal is tilted.
TYPED_TEST(SurfaceLaws, NoLightLeaksThroughTiltedNormals) {
    for (const Case& c : cases<TypeParam>({kFarTilted})) {
        SCOPED_TRACE(c.name);
        Numbers u(5);
        int drawn = 0;
        for (int n = 0; n < 5000; ++n) {
            const float a = u(), b = u();
            const Vec3f wo = sample_sphere(a, b);
            BsdfSample s;
            SampledSpectrum beta(1.0f);
            const float lobe = u(), x = u(), y = u();
            const bool from_camera = n % 2 == 0;
            if (!c.scattering.sample(wo, from_camera, lobe, x, y, s, beta)) continue;
            ++drawn;
            const bool reflected = s.wi.z * wo.z > 0;
            if (!c.own_coat && keeps_normal(c, from_camera ? wo : s.wi)) {
                ASSERT_EQ(reflected, dot(s.wi, c.ns) * dot(wo, c.ns) > 0);
            }
            ASSERT_TRUE(reflected || TypeParam::kTransmits);
        }
        EXPECT_GT(drawn, 500);
        // On one side of the shading normal, on two of the surface.
        const Vec3f through = normalize(Vec3f{0.9f, 0, -0.3f});
        SampledSpectrum f(1.0f);
        c.scattering.multiply_f_cos(kDirections[0], through, f);
        EXPECT_EQ(f.max(), 0);
        EXPECT_EQ(c.scattering.pdf_omega(kDirections[0], through, true), 0);
    }
}

// Where the shading normal faces away from the camera, or mirrors it into the surface, much of what is drawn still leaves it: of
// smooth surfaces everything.
TYPED_TEST(SurfaceLaws, NoFaceThatTheCameraSeesIsBlack) {
    for (const Case& c : cases<TypeParam>({kFarTilted})) {
        SCOPED_TRACE(c.name);
        Numbers u(23);
        for (const float x : {-0.99f, -0.9f, -0.7f, -0.4f, 0.0f}) {
            const Vec3f wo = normalize(Vec3f{x, 0.1f, std::sqrt(1 - x * x)});
            ASSERT_FALSE(keeps_normal(c, wo));
            int left = 0;
            constexpr int kCount = 2000;
            for (int n = 0; n < kCount; ++n) {
                BsdfSample s;
                SampledSpectrum beta(1.0f);
                const float lobe = u(), a = u(), b = u();
                if (!c.scattering.sample(wo, true, lobe, a, b, s, beta)) continue;
                left += beta.max() > 0;
                ASSERT_TRUE(s.wi.z > 0 || TypeParam::kTransmits);
            }
            EXPECT_GT(left, c.scattering.is_delta() ? kCount - 1 : kCount / 10) << x;
        }
    }
}

// Of GGX with this alpha, 4 % of the mirrored directions are more than 0.01 below the middle one.
TEST(MetallicRoughness, PolishedFacesReflectAllTheyGetHoweverTheirNormalsAreTilted) {
    const MetallicRoughness chrome(values().white, {.metallic = 1, .alpha = MetallicRoughness::kMinAlpha});
    const Bsdf bsdf(Frame::from_z(kFarTilted), kUp, chrome);
    for (const float height : {0.02f, 0.05f, 0.2f, 0.6f}) {
        Numbers u(29);
        const Vec3f wo{-std::sqrt(1 - height * height), 0, height};
        double sum = 0;
        constexpr int kCount = 10'000;
        for (int n = 0; n < kCount; ++n) {
            BsdfSample s;
            SampledSpectrum beta(1.0f);
            const float lobe = u(), a = u(), b = u();
            if (bsdf.sample(wo, true, lobe, a, b, s, beta)) sum += static_cast<double>(beta[0]);
        }
        EXPECT_GT(sum / kCount, 0.93) << height;
        EXPECT_LT(sum / kCount, 1 + 1e-5) << height;
    }
}

// A coat above a black surface reflects as if the surface had its normal, whatever normal it has.
TEST(MetallicRoughness, ACoatReflectsAboutItsOwnNormal) {
    const MetallicRoughness coat(values().black, {.f0 = 0, .f90 = 0, .coat = 0.8f, .coat_alpha = 0.3f});
    const Bsdf alone(Frame::from_z(kCoat), kUp, coat);
    for (const Vec3f& ns : {kUp, kTilted, kFarTilted}) {
        Bsdf laid(Frame::from_z(ns), kUp, coat);
        laid.lay_coat(kCoat);
        Numbers u(29);
        for (int n = 0; n < 2000; ++n) {
            const float x = u(), y = u(), s = u(), t = u();
            const Vec3f a = sample_sphere(x, y), b = sample_sphere(s, t);
            SampledSpectrum f(1.0f), expected(1.0f);
            laid.multiply_f_cos(a, b, f);
            alone.multiply_f_cos(a, b, expected);
            ASSERT_NEAR(f[3], expected[3], 1e-4f * expected[3] + 1e-6f);
            for (const bool from_camera : {true, false}) {
                const float pdf = alone.pdf_omega(a, b, from_camera);
                ASSERT_NEAR(laid.pdf_omega(a, b, from_camera), pdf, 1e-4f * pdf + 1e-6f);
            }
        }
    }
}

// What a smooth surface lets through is its share without a tint times the tint; so is what it reflects, or it is the same.
template <class Glass>
void expect_tinted(const Glass& clear, const Glass& tinted, const SampledSpectrum& tint, bool reflects_it = false) {
    int passed = 0;
    for (const Vec3f& wo : kDirections) {
        for (const float u_lobe : {0.0f, 0.99f}) {
            ClosureSample a, b;
            SampledSpectrum clear_weight(1.0f), weight(1.0f);
            ASSERT_EQ(clear.sample(wo, u_lobe, 0, 0, a, clear_weight), tinted.sample(wo, u_lobe, 0, 0, b, weight));
            EXPECT_EQ(a.wi, b.wi);
            EXPECT_EQ(a.probability, b.probability);
            const bool through = a.wi.z * wo.z < 0;
            passed += through;
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i)
                EXPECT_FLOAT_EQ(weight[i], clear_weight[i] * (through || reflects_it ? tint[i] : 1));
        }
    }
    EXPECT_GT(passed, 2);
}

TEST(Dielectrics, TintWhatTheyTransmit) {
    const Values& v = values();
    expect_tinted(Dielectric(v.glass, false, 3, 0, 0), Dielectric(v.glass, false, 3, 0, 0, &v.falling), v.falling);
    expect_tinted(Dielectric(v.glass, false, 3, 0, 0),
                  Dielectric(v.glass, false, 3, 0, 0, &v.falling, {}, nullptr, {}, false, &v.falling), v.falling, true);
    expect_tinted(ThinDielectric(v.varying, true, 9), ThinDielectric(v.varying, true, 9, 0, 0, &v.falling), v.falling);
}

// A pane gives back R' = R + T^2 R / (1 - R^2) and lets the rest through, at each wavelength by its own index.
TEST(ThinDielectric, ReflectsEachWavelengthByItsIndex) {
    const SampledSpectrum& eta = values().varying;
    const Bsdf pane(Frame::from_z(kUp), kUp, ThinDielectric(eta, true, 9));
    for (const Vec3f& wo : kDirections) {
        constexpr int kCount = 10'000;
        std::array<double, kMaxWavelengths> reflected{}, transmitted{};
        for (int n = 0; n < kCount; ++n) {
            BsdfSample sample;
            SampledSpectrum beta(1.0f);
            ASSERT_TRUE(pane.sample(wo, n % 2 == 0, (static_cast<float>(n) + 0.5f) / kCount, 0, 0, sample, beta));
            EXPECT_FALSE(pane.disperses(wo, sample.wi));
            const bool back = sample.wi.z * wo.z > 0;
            if (!back) {
                EXPECT_LT(length(sample.wi + wo), 1e-6f);
            }
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i)
                (back ? reflected : transmitted)[i] += static_cast<double>(beta[i]) / kCount;
        }
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const double r = fresnel_dielectric(std::abs(wo.z), eta[i]), t = 1 - r;
            const double expected = r + t * t * r / (1 - r * r);
            EXPECT_NEAR(reflected[i], expected, 1.5 / kCount);  // the probabilities are met to one sample
            EXPECT_NEAR(transmitted[i], 1 - expected, 1.5 / kCount);
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
