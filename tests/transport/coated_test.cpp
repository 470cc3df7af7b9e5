// Coated surfaces: closed forms, and photons followed one by one through the layers by the plain laws of optics.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "tests/transport/closure_examples.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

const Vec3f kNormal{0, 0, 1};

// Unpolarised reflectance at cosine c, `eta` the index behind over that before; k: of a metal.
double fresnel(double c, double eta) {
    const double s2 = (1 - c * c) / (eta * eta);
    if (s2 >= 1) return 1;
    const double ct = std::sqrt(1 - s2), p = (eta * c - ct) / (eta * c + ct), s = (c - eta * ct) / (c + eta * ct);
    return (p * p + s * s) / 2;
}
double fresnel(double c, double eta, double k) {
    const double s2 = 1 - c * c, t = eta * eta - k * k - s2, q = std::sqrt(t * t + 4 * eta * eta * k * k),
                 a = std::sqrt(std::max(0.0, (q + t) / 2));
    const double s = (q - 2 * a * c + c * c) / (q + 2 * a * c + c * c);
    return s * (1 + (c * c * q - 2 * a * c * s2 + s2 * s2) / (c * c * q + 2 * a * c * s2 + s2 * s2)) / 2;
}

// What is followed: in one wavelength.
struct Stack {
    double eta, alpha_x, alpha_y, thickness, albedo, g;
    int max_depth;
    std::optional<double> reflectance{};                // of a diffuse base
    double metal_eta = 1, metal_k = 0, base_alpha = 0;  // of a metal
};

// One photon, from w above; its weight is the share of its power that is left.
class Photon {
 public:
    Photon(const Stack& stack, const Vec3d& w, std::mt19937_64& engine) : stack_(stack), towards_(w), engine_(engine) {}

    // Where it leaves to; nothing: it was absorbed.
    std::optional<Vec3d> leave() {
        if (!meet_coat()) return std::nullopt;
        if (towards_.z > 0) return towards_;
        double z = stack_.thickness;  // it goes along towards_, which it leaves a surface in
        for (int events = 0; events < stack_.max_depth; ++events) {
            const double way = -std::log(1 - u()) * towards_.z;
            if (0 < z + way && z + way < stack_.thickness) {
                if (u() >= stack_.albedo) return std::nullopt;
                z += way;
                scatter();
            } else if (towards_.z < 0) {
                z = 0;
                towards_ = -towards_;
                if (!meet_base()) return std::nullopt;
            } else {
                z = stack_.thickness;
                towards_ = -towards_;
                if (!meet_coat()) return std::nullopt;
                if (towards_.z > 0) return towards_;
            }
            // What leaves after the last event is let out.
            if (events + 1 == stack_.max_depth) return let_out(z);
        }
        return std::nullopt;
    }
    double weight = 1;

 private:
    double u() { return std::uniform_real_distribution<double>(0, 1)(engine_); }

    std::optional<Vec3d> let_out(double z) {
        if (towards_.z <= 0 || u() >= std::exp(-(stack_.thickness - z) / towards_.z)) return std::nullopt;
        towards_ = -towards_;
        if (!meet_coat() || towards_.z < 0) return std::nullopt;
        return towards_;
    }

    // A facet's normal by D(m) m.z, tangents of a Gauss-like law: Walter's weight G2 |w.m| / (|w.z| m.z) makes up for it.
    Vec3d facet(double alpha_x, double alpha_y) {
        const double a = u(), r = std::sqrt(a / (1 - a)), phi = 2 * std::numbers::pi * u();
        return normalize(Vec3d{alpha_x * r * std::cos(phi), alpha_y * r * std::sin(phi), 1});
    }
    static double lambda(const Vec3d& w, double ax, double ay) {
        return (std::sqrt(1 + (ax * ax * w.x * w.x + ay * ay * w.y * w.y) / (w.z * w.z)) - 1) / 2;
    }

    // Arrives from towards_, which points away from the coat, on either side of it.
    bool meet_coat() {
        const Vec3d w = towards_;
        const bool smooth = std::max(stack_.alpha_x, stack_.alpha_y) < 1e-3 || stack_.eta == 1;
        Vec3d m = smooth ? Vec3d{0, 0, 1} : facet(stack_.alpha_x, stack_.alpha_y);
        if (w.z < 0) m = -m;
        const double c = dot(w, m), eta = w.z > 0 ? stack_.eta : 1 / stack_.eta;
        if (c <= 0) return false;
        const bool reflected = u() < fresnel(c, eta);
        towards_ = reflected ? m * (2 * c) - w : m * (c / eta - std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta * eta)))) - w / eta;
        if (reflected != (towards_.z * w.z > 0)) return false;
        if (!smooth) {
            weight *= c / std::abs(w.z * m.z) /
                      (1 + lambda(w, stack_.alpha_x, stack_.alpha_y) + lambda(towards_, stack_.alpha_x, stack_.alpha_y));
        }
        return true;
    }
    bool meet_base() {
        const Vec3d w = towards_;
        if (stack_.reflectance) {
            const double z = std::sqrt(u()), s = std::sqrt(1 - z * z), phi = 2 * std::numbers::pi * u();
            towards_ = {s * std::cos(phi), s * std::sin(phi), z};
            return u() < *stack_.reflectance;
        }
        const bool smooth = stack_.base_alpha < 1e-3;
        const Vec3d m = smooth ? Vec3d{0, 0, 1} : facet(stack_.base_alpha, stack_.base_alpha);
        const double c = dot(w, m);
        if (c <= 0 || u() >= fresnel(c, stack_.metal_eta / stack_.eta, stack_.metal_k / stack_.eta)) return false;
        towards_ = m * (2 * c) - w;
        if (towards_.z <= 0) return false;
        if (!smooth) {
            weight *=
                c / (w.z * m.z) /
                (1 + lambda(w, stack_.base_alpha, stack_.base_alpha) + lambda(towards_, stack_.base_alpha, stack_.base_alpha));
        }
        return true;
    }
    // Henyey and Greenstein's turn by rejection.
    void scatter() {
        const double g = stack_.g, most = (1 - g * g) / std::pow(1 + g * g - 2 * std::abs(g), 1.5);
        double c;
        do c = 2 * u() - 1;
        while (u() * most >= (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5));
        const double s = std::sqrt(1 - c * c), phi = 2 * std::numbers::pi * u();
        const Vec3d z = towards_, x = normalize(cross(z, std::abs(z.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), y = cross(z, x);
        towards_ = x * (s * std::cos(phi)) + y * (s * std::sin(phi)) + z * c;
    }

    const Stack& stack_;
    Vec3d towards_;
    std::mt19937_64& engine_;
};

// Moments of where light goes: all of it, and weighed by functions that tell its shape.
struct Moments {
    static constexpr std::size_t kCount = 4;
    std::array<double, kCount> sum{}, squares{};
    double n = 0;

    void add(const std::optional<Vec3d>& w, double weight) {
        ++n;
        if (!w) return;
        const double of[kCount] = {1, w->z, w->x * w->x, w->x + w->y * w->z};
        for (std::size_t i = 0; i < kCount; ++i) {
            sum[i] += weight * of[i];
            squares[i] += weight * weight * of[i] * of[i];
        }
    }
    double mean(std::size_t i) const { return sum[i] / n; }
    double error(std::size_t i) const { return std::sqrt(std::max(0.0, squares[i] / n - mean(i) * mean(i)) / n); }
};

template <class C>
void expect_photons_agree(const Stack& stack, const C& closure) {
    constexpr std::uint32_t kLane = 3;
    const Bsdf bsdf(Frame::from_z(kNormal), kNormal, closure);
    for (const Vec3f& wo : {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.3f})}) {
        std::mt19937_64 engine(5);
        Numbers u(7);
        Moments expected, found;
        for (int n = 0; n < 150'000; ++n) {
            Photon photon(stack, normalize(Vec3d(wo)), engine);
            const std::optional<Vec3d> w = photon.leave();
            expected.add(w, photon.weight);
        }
        for (int n = 0; n < 80'000; ++n) {
            BsdfSample s;
            SampledSpectrum beta(1.0f);
            const float lobe = u(), x = u(), y = u();
            const bool drawn = bsdf.sample(wo, true, lobe, x, y, s, beta);
            found.add(drawn ? std::optional<Vec3d>(s.wi) : std::nullopt, static_cast<double>(beta[kLane]));
        }
        for (std::size_t i = 0; i < Moments::kCount; ++i) {
            const double error = std::hypot(expected.error(i), found.error(i));
            EXPECT_NEAR(found.mean(i), expected.mean(i), 4.2 * error + 1e-6) << i;
            EXPECT_LT(error, 0.02 * expected.mean(0));
        }
    }
}

struct CoatCase {
    std::string name;
    Stack stack;
};

const std::vector<CoatCase> kCoats = {
    {"smooth", {1.5, 0, 0, 0.01, 0, 0, 10}},
    {"smooth, absorbing, one scattering", {1.5, 0, 0, 0.5, 0, 0, 1}},
    {"smooth, three scatterings", {1.8, 0, 0, 0.1, 0, 0, 5}},
    {"rough", {1.5, 0.4, 0.4, 0.01, 0, 0, 10}},
    {"rough by axis, absorbing", {1.3, 0.1, 0.6, 0.3, 0, 0, 4}},
    {"thinner than air", {0.8, 0, 0, 0.1, 0, 0, 10}},
    {"rough, thinner than air", {0.8, 0.3, 0.3, 0.1, 0, 0, 10}},
    {"scattering", {1.5, 0, 0, 0.7, 0.9, 0.5, 10}},
    {"scattering, rough", {1.5, 0.3, 0.3, 1, 0.7, -0.4, 12}},
    {"scattering without an interface", {1, 0, 0, 1, 0.8, 0.2, 20}},
};

Layer layer_of_stack(const Stack& s, const SampledSpectrum& albedo) {
    return {
        .coat = {Microfacets::of_alpha(static_cast<float>(s.alpha_x), static_cast<float>(s.alpha_y)), static_cast<float>(s.eta)},
        .thickness = static_cast<float>(s.thickness),
        .albedo = s.albedo > 0 ? &albedo : nullptr,
        .g = static_cast<float>(s.g),
        .max_depth = static_cast<std::uint32_t>(s.max_depth),
        .key = 23};
}

TEST(CoatedDiffuse, ScattersAsPhotonsDo) {
    for (const CoatCase& c : kCoats) {
        SCOPED_TRACE(c.name);
        Stack stack = c.stack;
        stack.reflectance = 0.7;
        const SampledSpectrum albedo(static_cast<float>(stack.albedo)), reflectance(0.7f);
        const CoatedDiffuse::State state(layer_of_stack(stack, albedo), Diffuse(reflectance));
        expect_photons_agree(stack, CoatedDiffuse(state));
    }
}

TEST(CoatedConductor, ScattersAsPhotonsDo) {
    for (const CoatCase& c : kCoats) {
        for (const double alpha : {0.0, 0.3}) {
            SCOPED_TRACE(c.name + (alpha > 0 ? ", rough base" : ", smooth base"));
            Stack stack = c.stack;
            stack.metal_eta = 0.4;
            stack.metal_k = 2.5;
            stack.base_alpha = alpha;
            const SampledSpectrum albedo(static_cast<float>(stack.albedo)), eta(static_cast<float>(0.4 / stack.eta)),
                k(static_cast<float>(2.5 / stack.eta));
            const CoatedConductor::State state(layer_of_stack(stack, albedo),
                                               Conductor(eta, k, static_cast<float>(alpha), static_cast<float>(alpha)));
            expect_photons_agree(stack, CoatedConductor(state));
        }
    }
}

// Smooth above a diffuse base: f = R / (pi eta^2) T(a) T(b) (1 - (R r)^n) / (1 - R r), by the midpoint rule in double.
TEST(CoatedDiffuse, IsTheClosedFormWhereTheCoatIsSmooth) {
    for (const double eta : {0.7, 1.0, 1.1, 1.5, 2.5}) {
        for (const double t : {0.0, 0.01, 0.4}) {
            for (const std::uint32_t depth : {1u, 2u, 3u, 10u, 100'001u}) {
                for (const double r : {0.2, 1.0}) {
                    SCOPED_TRACE(::testing::Message() << eta << ", " << t << ", " << depth << ", " << r);
                    const SampledSpectrum reflectance(static_cast<float>(r));
                    const CoatedDiffuse::State state({.coat = {Microfacets::of_alpha(0, 0), static_cast<float>(eta)},
                                                      .thickness = static_cast<float>(t),
                                                      .max_depth = depth},
                                                     Diffuse(reflectance));
                    const CoatedDiffuse closure(state);
                    constexpr int kSteps = 20'000;
                    double returned = 0;
                    for (int i = 0; i < kSteps; ++i) {
                        const double c = (i + 0.5) / kSteps;
                        returned += 2 * c * fresnel(c, 1 / eta) * std::exp(-2 * t / c) / kSteps;
                    }
                    double sum = 0, power = 1;
                    for (std::uint32_t j = 0; j < std::min((depth + 1) / 2, 2000u); ++j, power *= r * returned) sum += power;
                    const auto passed = [&](double c) {
                        const double s2 = (1 - c * c) / (eta * eta);
                        return s2 < 1 ? (1 - fresnel(c, eta)) * std::exp(-t / std::sqrt(1 - s2)) : 0;
                    };
                    for (const Vec3f& a : {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.2f})}) {
                        const Vec3f b = normalize(Vec3f{0.5f, -0.4f, 0.6f});
                        SampledSpectrum f(1.0f);
                        closure.multiply_f_cos(a, b, f);
                        const double expected = r / std::numbers::pi / (eta * eta) * passed(static_cast<double>(a.z)) *
                                                passed(static_cast<double>(b.z)) * sum * static_cast<double>(b.z);
                        EXPECT_NEAR(static_cast<double>(f[0]), expected, 2e-4 * expected + 1e-9);
                    }
                }
            }
        }
    }
}

// A dispersive smooth coat does to each wavelength what a coat of its index does to all.
TEST(Coated, SmoothDispersiveOnesKeepEveryWavelengthApart) {
    const Values& v = values();
    const Vec3f a = normalize(Vec3f{0.1f, 0.2f, 0.9f}), b = normalize(Vec3f{0.5f, -0.4f, 0.6f});
    const CoatedDiffuse::State diffuse(dispersive(layer_of(0, 0, 0.2f), 5), Diffuse(v.grey));
    const CoatedConductor::State metal(dispersive(layer_of(0, 0, 0.2f), 5), Conductor(v.eta, v.k, 0, 0));
    EXPECT_FALSE(CoatedDiffuse(diffuse).disperses(a, b));
    EXPECT_FALSE(CoatedConductor(metal).disperses(a, b));
    SampledSpectrum f(1.0f), mirrored(1.0f);
    CoatedDiffuse(diffuse).multiply_f_cos(a, b, f);
    ClosureSample sample;
    ASSERT_TRUE(CoatedConductor(metal).sample(a, 0, 0, 0, sample, mirrored));
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        Layer layer = layer_of(0, 0, 0.2f);
        layer.coat.eta = v.varying[i];
        const CoatedDiffuse::State one(layer, Diffuse(v.grey));
        const CoatedConductor::State one_metal(layer, Conductor(v.eta, v.k, 0, 0));
        SampledSpectrum alone(1.0f), mirrored_alone(1.0f);
        CoatedDiffuse(one).multiply_f_cos(a, b, alone);
        EXPECT_FLOAT_EQ(f[i], alone[i]);
        ASSERT_TRUE(CoatedConductor(one_metal).sample(a, 0, 0, 0, sample, mirrored_alone));
        EXPECT_FLOAT_EQ(mirrored[i], mirrored_alone[i]);
    }
}

// Nothing comes back out of a thick layer that absorbs: what is left is the reflection of glass.
TEST(Coated, ThickAbsorbingLayersLeaveTheReflectionOfTheirCoat) {
    const Values& v = values();
    const CoatedDiffuse::State diffuse(layer_of(0.3f, 0.3f, 60), Diffuse(v.white));
    const CoatedConductor::State metal(layer_of(0.3f, 0.3f, 60), Conductor(v.eta, v.k, 0.2f, 0.2f));
    const Dielectric glass(v.glass, false, 0, 0.3f, 0.3f);
    for (const Vec3f& a : {normalize(Vec3f{0.1f, 0.2f, 0.9f}), normalize(Vec3f{-0.7f, 0.3f, 0.2f})}) {
        const Vec3f b = normalize(Vec3f{0.5f, -0.4f, 0.6f});
        SampledSpectrum of_diffuse(1.0f), of_metal(1.0f), expected(1.0f);
        CoatedDiffuse(diffuse).multiply_f_cos(a, b, of_diffuse);
        CoatedConductor(metal).multiply_f_cos(a, b, of_metal);
        glass.multiply_f_cos(a, b, expected);
        EXPECT_FLOAT_EQ(of_diffuse[0], expected[0]);
        EXPECT_FLOAT_EQ(of_metal[0], expected[0]);
    }
}

}  // namespace
}  // namespace latent::render::testing
