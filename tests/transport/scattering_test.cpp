// Laws of BSDFs and phase functions: they are drawn as their densities say, reciprocal, and give back no more than they get.
#include "render/bsdf/scattering.h"

#include <array>
#include <cmath>
#include <optional>

#include "render/bsdf/fresnel.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

struct Case {
    std::string name;
    Scattering scattering;
    bool symmetric;  // f(a, b) = f(b, a): everything but refraction, whose radiance is compressed
    double eta = 1;
    std::optional<std::uint32_t> kept = std::nullopt;  // the lane that dispersion follows
    Vec3f ns{0, 0, 1};                                 // the shading normal; ng is z
};

// Batches that outlive the cases.
struct Spectra {
    Batch grey{0.7f}, glass{1.5f}, varying, eta, k;
    Spectra() {
        for (std::uint32_t i = 0; i < kLanes; ++i) {
            varying[i] = 1.7f + 0.003f * static_cast<float>(i);
            eta[i] = 0.3f + 0.04f * static_cast<float>(i);
            k[i] = 3.0f + 0.1f * static_cast<float>(i);
        }
    }
};
const Spectra& spectra() {
    static const Spectra s;
    return s;
}

const Vec3f kUp{0, 0, 1};
const Vec3f kTilted = normalize(Vec3f{0.25f, -0.15f, 1});

std::vector<Case> rough_cases() {
    const Spectra& s = spectra();
    const Frame flat = Frame::from_z(kUp), tilted = Frame::from_z(kTilted);
    return {
        {"diffuse", Scattering::diffuse(flat, kUp, s.grey), true},
        {"diffuse, tilted normal", Scattering::diffuse(tilted, kUp, s.grey), true, 1, {}, kTilted},
        {"conductor 0.3", Scattering::conductor(flat, kUp, s.eta, s.k, 0.3f, 0.3f), true},
        {"conductor 0.1 x 0.5", Scattering::conductor(flat, kUp, s.eta, s.k, 0.1f, 0.5f), true},
        {"conductor 0.8, tilted normal", Scattering::conductor(tilted, kUp, s.eta, s.k, 0.8f, 0.8f), true, 1, {}, kTilted},
        {"dielectric 0.2", Scattering::dielectric(flat, kUp, s.glass, false, 3, 0.2f, 0.2f), false, 1.5},
        {"dielectric 0.5 x 0.25", Scattering::dielectric(flat, kUp, s.glass, false, 3, 0.5f, 0.25f), false, 1.5},
        {"dielectric 0.4, dispersive", Scattering::dielectric(flat, kUp, s.varying, true, 5, 0.4f, 0.4f), false, 1.715, 5},
        {"dielectric 0.4, tilted normal",
         Scattering::dielectric(tilted, kUp, s.glass, false, 3, 0.4f, 0.4f),
         false,
         1.5,
         {},
         kTilted},
        {"phase g = 0", Scattering::phase(0), true},
        {"phase g = 0.6", Scattering::phase(0.6f), true},
        {"phase g = -0.4", Scattering::phase(-0.4f), true},
    };
}

std::vector<Case> smooth_cases() {
    const Spectra& s = spectra();
    std::vector<Case> cases;
    for (const Vec3f& ns : {kUp, kTilted}) {
        const Frame frame = Frame::from_z(ns);
        cases.push_back({"mirror", Scattering::conductor(frame, kUp, s.eta, s.k, 0, 0), true, 1, {}, ns});
        cases.push_back({"smooth glass", Scattering::dielectric(frame, kUp, s.glass, false, 0, 0, 0), false, 1.5, {}, ns});
        cases.push_back(
            {"smooth dispersive glass", Scattering::dielectric(frame, kUp, s.varying, true, 9, 0, 0), false, 1.727, 9, ns});
        cases.push_back({"pane", Scattering::thin_dielectric(frame, kUp, s.glass, false, 0), true, 1, {}, ns});
        cases.push_back({"pane of dispersive glass", Scattering::thin_dielectric(frame, kUp, s.varying, true, 9), true, 1, {}, ns});
    }
    return cases;
}

// From outside, and from within: beyond total reflection of glass and before it.
const std::vector<Vec3f> kDirections = {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.4f}),
                                        normalize(Vec3f{0.5f, -0.4f, -0.6f}), normalize(Vec3f{-0.3f, 0.1f, -0.9f})};

// What a light subpath's step from wo to wi has over f |wi.ns| / pdf [Veach97 5.3].
double light_side(const Case& c, const Vec3f& wo, const Vec3f& wi) {
    if (c.scattering.in_medium()) return 1;
    return static_cast<double>(abs_dot(wo, c.ns) * std::abs(wi.z)) / static_cast<double>(std::abs(wo.z) * abs_dot(wi, c.ns));
}

TEST(Scattering, DirectionsFollowTheirDensity) {
    for (const Case& c : rough_cases()) {
        for (std::size_t d = 0; d < kDirections.size(); ++d) {
            SCOPED_TRACE(c.name + ", direction " + std::to_string(d));
            const Vec3f wo = kDirections[d];
            Numbers u(static_cast<std::uint32_t>(d + 1));
            expect_directions_follow(
                {.sample = [&](std::uint32_t) -> std::optional<Vec3f> {
                     Scattering::Sample s;
                     Batch beta(1.0f);
                     const float lobe = u(), x = u(), y = u();
                     if (!c.scattering.sample(wo, true, lobe, x, y, s, beta)) return std::nullopt;
                     return s.wi;
                 },
                 .pdf_omega = [&](const Vec3f& wi) { return static_cast<double>(c.scattering.pdf_omega(wo, wi)); },
                 .count = 60'000});
        }
    }
}

// The weight of a drawn direction is f |cos| / pdf of evaluating it, from either side.
TEST(Scattering, WeightsAreWhatEvaluationSays) {
    for (const Case& c : rough_cases()) {
        SCOPED_TRACE(c.name);
        Numbers u(7);
        for (int n = 0; n < 2000; ++n) {
            const Vec3f wo = kDirections[static_cast<std::size_t>(n) % kDirections.size()];
            const bool from_eye = n % 2 == 0;
            Scattering::Sample s;
            Batch beta(1.0f), f(1.0f);
            const float lobe = u(), x = u(), y = u();
            if (!c.scattering.sample(wo, from_eye, lobe, x, y, s, beta)) continue;
            ASSERT_FLOAT_EQ(s.pdf, c.scattering.pdf_omega(wo, s.wi));
            ASSERT_FLOAT_EQ(s.pdf_reverse, c.scattering.pdf_omega(s.wi, wo));
            c.scattering.multiply_f_cos(from_eye ? wo : s.wi, from_eye ? s.wi : wo, f);
            const float side = from_eye || c.scattering.in_medium() ? 1 : std::abs(s.wi.z / wo.z);  // ng is z
            for (std::uint32_t i = 0; i < kLanes; ++i) ASSERT_NEAR(beta[i], f[i] * side / s.pdf, 2e-5f * beta[i] + 1e-7f);
        }
    }
}

// f(a, b) = f(b, a); refraction: eta_b^2 f(a, b) = eta_a^2 f(b, a), as radiance is compressed on its way.
TEST(Scattering, IsReciprocal) {
    for (const Case& c : rough_cases()) {
        if (c.name.find("tilted") != std::string::npos) continue;  // cosines to ns are not in both directions
        SCOPED_TRACE(c.name);
        Numbers u(11);
        for (int n = 0; n < 2000; ++n) {
            const auto direction = [&] {
                const float z = 2 * u() - 1, phi = u() * 2 * kPi, s = std::sqrt(1 - z * z);
                return Vec3f{s * std::cos(phi), s * std::sin(phi), z};
            };
            const Vec3f a = direction(), b = direction();
            if (std::abs(a.z) < 0.02f || std::abs(b.z) < 0.02f) continue;
            Batch there(1.0f), back(1.0f);
            c.scattering.multiply_f_cos(a, b, there);
            c.scattering.multiply_f_cos(b, a, back);
            const bool medium = c.scattering.in_medium();
            const double forth = static_cast<double>(there[5]) / (medium ? 1 : std::abs(static_cast<double>(b.z)));
            const double home = static_cast<double>(back[5]) / (medium ? 1 : std::abs(static_cast<double>(a.z)));
            const double eta = c.symmetric || a.z * b.z > 0 ? 1 : a.z > 0 ? c.eta : 1 / c.eta;  // of b's side over a's
            ASSERT_NEAR(forth * eta * eta, home, 2e-4 * home + 1e-5);  // 1 - F loses digits at grazing angles
        }
    }
}

// The two lobes of a delta function come as often as the odds that they say, which weights count on.
TEST(Scattering, SmoothLobesComeAsOftenAsTheirOdds) {
    for (const Case& c : smooth_cases()) {
        if (!(c.ns == kUp)) continue;  // some of their directions are absorbed
        for (const Vec3f& wo : kDirections) {
            SCOPED_TRACE(c.name);
            Numbers u(13);
            constexpr int kCount = 100'000;
            std::array<int, 2> counted{};
            std::array<double, 2> odds{};
            for (int n = 0; n < kCount; ++n) {
                Scattering::Sample s;
                Batch beta(1.0f);
                ASSERT_TRUE(c.scattering.sample(wo, n % 2 == 0, u(), 0, 0, s, beta));
                const std::size_t lobe = s.wi.z * wo.z > 0 ? 0 : 1;
                if (counted[lobe]++ == 0) odds[lobe] = static_cast<double>(s.pdf);
                ASSERT_EQ(static_cast<double>(s.pdf), odds[lobe]);
            }
            EXPECT_NEAR(odds[0] + odds[1], 1, 1e-6);
            const double error = std::sqrt(kCount * odds[0] * (1 - odds[0]));
            EXPECT_LE(std::abs(counted[0] - kCount * odds[0]), 3.891 * error);  // the binomial's two tails of 1e-4
        }
    }
}

// The same path, walked backwards, by the other kind of subpath, and by the other kind backwards, carries the same power: radiance
// is compressed by eta^2, the rest is symmetric, F at an angle outside is F at the refracted angle inside. Coefficients are weights
// times odds.
TEST(Scattering, SmoothScatteringIsReciprocal) {
    int refracted = 0, reflected = 0;
    for (const Case& c : smooth_cases()) {
        for (const Vec3f& wo : kDirections) {
            for (const float lobe : {0.0f, 1 - 0x1p-24f}) {
                SCOPED_TRACE(c.name);
                Scattering::Sample there, back, from_light, light_back;
                Batch beta(1.0f), beta_back(1.0f), beta_light(1.0f), beta_light_back(1.0f);
                if (!c.scattering.sample(wo, true, lobe, 0, 0, there, beta)) continue;
                ASSERT_TRUE(c.scattering.sample(there.wi, true, lobe, 0, 0, back, beta_back));
                ASSERT_TRUE(c.scattering.sample(wo, false, lobe, 0, 0, from_light, beta_light));
                ASSERT_TRUE(c.scattering.sample(there.wi, false, lobe, 0, 0, light_back, beta_light_back));
                ASSERT_LT(length(back.wi - wo), 2e-6f);
                ASSERT_EQ(from_light.wi, there.wi);
                ASSERT_EQ(from_light.pdf, there.pdf);
                const bool refracts = !c.symmetric && there.wi.z * wo.z < 0;
                EXPECT_NEAR(there.eta2, !refracts ? 1 : std::pow(c.eta, wo.z > 0 ? 2 : -2), 1e-6);
                // The reverse density is that of the way back, per solid angle on its own side.
                const float stretch = refracts ? abs_dot(there.wi, c.ns) * there.eta2 / abs_dot(wo, c.ns) : 1;
                EXPECT_NEAR(there.pdf_reverse * stretch, back.pdf, 1e-5f * back.pdf);
                for (std::uint32_t i = 0; i < kLanes; ++i) {
                    if (refracts && c.kept && i != *c.kept) continue;
                    const float power = beta[i] * there.pdf * there.eta2;
                    ASSERT_NEAR(beta_back[i] * back.pdf * back.eta2, power, 1e-5f * power);
                    ASSERT_NEAR(static_cast<double>(beta_light[i] * from_light.pdf) / light_side(c, wo, there.wi), power,
                                1e-5f * power);
                    ASSERT_NEAR(static_cast<double>(beta_light_back[i] * light_back.pdf) / light_side(c, there.wi, wo), power,
                                1e-5f * power);
                }
                ++(refracts ? refracted : reflected);
            }
        }
    }
    EXPECT_GE(refracted, 12);
    EXPECT_GE(reflected, 40);
}

// Every vertex gives back at most what it gets, smooth glass, panes and fog all of it: of a white furnace's radiance, its
// compression taken back, and of the power of light that comes along, the cosines' ratio taken back. In every lane, within 4
// standard errors.
TEST(Scattering, ConservesEnergy) {
    std::vector<Case> cases = rough_cases();
    for (Case& c : smooth_cases()) cases.push_back(std::move(c));
    for (const Case& c : cases) {
        const bool all_of_it = c.scattering.in_medium() || (c.scattering.is_delta() && c.name != "mirror" && c.ns == kUp);
        for (const Vec3f& wo : kDirections) {
            for (const bool from_eye : {true, false}) {
                SCOPED_TRACE(c.name + (from_eye ? ", from the eye" : ", from the light"));
                Numbers u(3);
                constexpr int kCount = 20'000;
                std::array<double, kLanes> sum{}, squares{};
                for (int n = 0; n < kCount; ++n) {
                    Scattering::Sample s;
                    Batch beta(1.0f);
                    const float lobe = u(), x = u(), y = u();
                    if (!c.scattering.sample(wo, from_eye, lobe, x, y, s, beta)) continue;
                    const double back = from_eye ? static_cast<double>(s.eta2) : 1 / light_side(c, wo, s.wi);
                    for (std::uint32_t i = 0; i < kLanes; ++i) {
                        const double given = static_cast<double>(beta[i]) * back;
                        sum[i] += given;
                        squares[i] += given * given;
                    }
                }
                for (std::uint32_t i = 0; i < kLanes; ++i) {
                    if (c.kept && !c.symmetric && i != *c.kept) continue;
                    const double mean = sum[i] / kCount, variance = std::max(0.0, squares[i] / kCount - mean * mean);
                    const double tolerance = 4 * std::sqrt(variance / kCount) + 1e-5;  // and the rounding of floats
                    ASSERT_LT(mean, 1 + tolerance) << i;
                    if (all_of_it) {
                        ASSERT_GT(mean, 1 - tolerance) << i;
                    }
                }
            }
        }
    }
}

// A pane gives back R' = R + T^2 R / (1 - R^2) and lets the rest through, at each wavelength by its own index.
TEST(Scattering, PanesReflectEachWavelengthByItsIndex) {
    const Spectra& s = spectra();
    const Scattering pane = Scattering::thin_dielectric(Frame::from_z(kUp), kUp, s.varying, true, 9);
    for (const Vec3f& wo : kDirections) {
        constexpr int kCount = 10'000;
        std::array<double, kLanes> reflected{}, passed{};
        for (int n = 0; n < kCount; ++n) {
            Scattering::Sample sample;
            Batch beta(1.0f);
            ASSERT_TRUE(pane.sample(wo, n % 2 == 0, (static_cast<float>(n) + 0.5f) / kCount, 0, 0, sample, beta));
            EXPECT_FALSE(pane.disperses(wo, sample.wi));
            const bool back = sample.wi.z * wo.z > 0;
            if (!back) {
                EXPECT_LT(length(sample.wi + wo), 1e-6f);
            }
            for (std::uint32_t i = 0; i < kLanes; ++i) (back ? reflected : passed)[i] += static_cast<double>(beta[i]) / kCount;
        }
        for (std::uint32_t i = 0; i < kLanes; ++i) {
            const double r = fresnel_dielectric(std::abs(wo.z), s.varying[i]), t = 1 - r;
            const double expected = r + t * t * r / (1 - r * r);
            EXPECT_NEAR(reflected[i], expected, 1.5 / kCount);  // the odds are met to one sample
            EXPECT_NEAR(passed[i], 1 - expected, 1.5 / kCount);
        }
    }
}

TEST(Scattering, NoLightLeaksThroughTiltedNormals) {
    const Spectra& s = spectra();
    const Vec3f ns = normalize(Vec3f{1.5f, 0, 1});
    const Frame frame = Frame::from_z(ns);
    const Scattering opaque[] = {Scattering::diffuse(frame, kUp, s.grey),
                                 Scattering::conductor(frame, kUp, s.eta, s.k, 0.5f, 0.5f)};
    Numbers u(5);
    for (const Scattering& scattering : opaque) {
        for (int n = 0; n < 5000; ++n) {
            Scattering::Sample sample;
            Batch beta(1.0f);
            const float lobe = u(), x = u(), y = u();
            if (scattering.sample(kDirections[0], n % 2 == 0, lobe, x, y, sample, beta)) {
                ASSERT_GT(sample.wi.z, 0);
            }
        }
        Batch f(1.0f);
        scattering.multiply_f_cos(kDirections[0], normalize(Vec3f{0.9f, 0, -0.3f}), f);
        EXPECT_EQ(f.max(), 0);
    }
    // What transmits too: reflected light stays on its side of the surface, refracted light does not.
    const Scattering clear[] = {Scattering::dielectric(frame, kUp, s.glass, false, 0, 0, 0),
                                Scattering::dielectric(frame, kUp, s.glass, false, 0, 0.4f, 0.4f),
                                Scattering::thin_dielectric(frame, kUp, s.glass, false, 0)};
    for (const Scattering& scattering : clear) {
        for (int n = 0; n < 5000; ++n) {
            Scattering::Sample sample;
            Batch beta(1.0f);
            const float lobe = u(), x = u(), y = u();
            const Vec3f& wo = kDirections[static_cast<std::size_t>(n) % kDirections.size()];
            if (scattering.sample(wo, n % 2 == 0, lobe, x, y, sample, beta)) {
                ASSERT_EQ(sample.wi.z * wo.z > 0, dot(sample.wi, ns) * dot(wo, ns) > 0);
            }
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
