// Laws of distances drawn by the angle that a light sees: they follow their density, and light that is scattered once beside a
// point adds up to the integral, no sample brighter than the distance of the ray allows.
#include "render/medium/equiangular.h"

#include <cmath>

#include "render/medium/medium.h"
#include "tests/transport/chi_square.h"
#include "tests/transport/numbers.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

TEST(Equiangular, DistancesFollowTheirDensity) {
    struct Case {
        double distance, delta, length;  // of the light from the ray, along the ray, of the segment
    };
    constexpr int kBins = 40, kCount = 200'000, kFine = 2000;
    for (const Case& c :
         {Case{0.5, 1, 3}, Case{0.3, -2, 4}, Case{0.7, 6, 2}, Case{0.01, 3, 5}, Case{0.2, 1, 1e30}, Case{2, -1, 1e30}}) {
        SCOPED_TRACE(c.delta);
        const Vec3f o{1, 2, 3}, d = normalize(Vec3f{1, -2, 2}), side = Frame::from_z(d).x;
        const Equiangular e(o, d, static_cast<float>(c.length),
                            o + d * static_cast<float>(c.delta) + side * static_cast<float>(c.distance), {}, 2);
        const double from = std::atan(-c.delta / c.distance), to = std::atan((c.length - c.delta) / c.distance);
        const auto edge = [&](int bin) { return c.delta + c.distance * std::tan(from + (to - from) * bin / kBins); };

        std::vector<double> counted(kBins);
        Numbers u(14);
        for (int n = 0; n < kCount; ++n) {
            const double t = static_cast<double>(e.sample(u()));
            ASSERT_GE(t, 0);
            ASSERT_LE(t, c.length * 1.000001);
            const double angle = std::atan((t - c.delta) / c.distance);
            ++counted[static_cast<std::size_t>(std::clamp(static_cast<int>((angle - from) / (to - from) * kBins), 0, kBins - 1))];
        }
        double chi2 = 0, rest = kCount;  // the last bin may have no end
        for (int b = 0; b < kBins; ++b) {
            double expected = rest;
            if (b < kBins - 1) {
                const double step = (edge(b + 1) - edge(b)) / kFine;
                expected = 0;
                for (int i = 0; i < kFine; ++i)
                    expected += kCount * step * static_cast<double>(e.pdf(static_cast<float>(edge(b) + (i + 0.5) * step)));
            }
            rest -= expected;
            const double difference = counted[static_cast<std::size_t>(b)] - expected;
            chi2 += difference * difference / expected;
        }
        EXPECT_GT(chi_square_tail(chi2, kBins - 1), 1e-4) << chi2;
    }
}

// How probable it is that distances drawn from `e` differ so much from its density; 20 bins between `from` and `to`.
double chi_square_of(const Equiangular& e, float from, float to, Numbers& u) {
    constexpr int kBins = 20, kCount = 5000, kFine = 200;
    std::vector<double> counted(kBins);
    for (int n = 0; n < kCount; ++n) {
        const int bin = static_cast<int>((e.sample(u()) - from) / (to - from) * kBins);
        ++counted[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
    }
    const float step = (to - from) / (kBins * kFine);
    double chi2 = 0;
    for (int b = 0; b < kBins; ++b) {
        double expected = 0;
        for (int i = 0; i < kFine; ++i)
            expected += kCount * static_cast<double>(step * e.pdf(from + step * (static_cast<float>(b * kFine + i) + 0.5f)));
        const double difference = counted[static_cast<std::size_t>(b)] - expected;
        chi2 += difference * difference / expected;
    }
    return chi_square_tail(chi2, kBins - 1);
}

// The segment of a ray in a spot's cone, for rays from anywhere: all of it and nothing else, to a sliver at its edge; u of the
// distances are nearer than sample(u), and they follow their density.
TEST(Equiangular, ASpotHasItsConeAlone) {
    constexpr int kSteps = 20'000;
    int empty = 0, met = 0;
    Numbers u(15);
    for (int n = 0; n < 300; ++n) {
        const auto direction = [&] {
            const float a = u(), b = u();
            return sample_sphere(a, b);
        };
        const Vec3f o = direction() * 2, d = direction(), light = direction(), axis = direction();
        const float length = 1 + 5 * u(), cos_outer = u();
        const Equiangular e(o, d, length, light, axis, 1 - cos_outer);
        empty += e.is_empty();
        double sum = 0;
        std::vector<float> quantiles;
        for (int q = 0; q <= 4; ++q) quantiles.push_back(e.is_empty() ? kInfinity : e.sample(static_cast<float>(q) / 4));
        std::vector<double> below(5);
        for (int i = 0; i < kSteps; ++i) {
            const float t = (static_cast<float>(i) + 0.5f) / kSteps * length;
            const double pdf = static_cast<double>(e.pdf(t)), cosine = static_cast<double>(dot(normalize(o + d * t - light), axis));
            if (cosine > static_cast<double>(cos_outer) + 1e-4) {
                ASSERT_GT(pdf, 0) << n;
            }
            if (cosine < static_cast<double>(cos_outer) - 1e-4) {
                ASSERT_EQ(pdf, 0) << n;
            }
            sum += pdf * static_cast<double>(length) / kSteps;
            for (std::size_t q = 0; q <= 4; ++q) below[q] += t < quantiles[q] ? pdf * static_cast<double>(length) / kSteps : 0;
        }
        if (e.is_empty()) continue;
        const double nearest = static_cast<double>(length_squared(cross(light - o, d)));
        if (nearest < 1e-2 || quantiles[4] - quantiles[0] < 0.05f * length) continue;  // steps too wide for the sums
        ++met;
        for (std::size_t q = 0; q <= 4; ++q) ASSERT_NEAR(below[q], static_cast<double>(q) / 4, 0.01) << n;
        ASSERT_NEAR(sum, 1, 0.01) << n;
        ASSERT_GT(chi_square_of(e, quantiles[0], quantiles[4], u), 1e-6) << n;
    }
    EXPECT_GT(empty, 30);
    EXPECT_GT(met, 60);
}

// A ray through the light itself, or one that starts there, has a density all the same.
TEST(Equiangular, NoRayIsTooNear) {
    for (const Vec3f& light : {Vec3f{0, 0, 2}, Vec3f{0, 0, -2}, Vec3f{0, 0, 0}}) {
        const Equiangular e({0, 0, 0}, {0, 0, 1}, kFar, light, {}, 2);
        for (const float u : {0.0f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-24f}) {
            const float t = e.sample(u);
            EXPECT_TRUE(t >= 0 && t <= kFar) << t;
            EXPECT_TRUE(e.pdf(t) >= 0 && e.pdf(t) < kInfinity) << e.pdf(t);
        }
    }
}

// Grey fog, a ray that passes a point light at a distance D, a black wall. What is scattered once, t along the ray, with theta the
// angle from the light's foot and d = D / cos theta:
//   L = sigma_s I / (4 pi) int e^(-sigma_t (t + d)) / d^2 dt = sigma_s I / (4 pi D) int e^(-sigma_t (t + d)) dtheta
// t + d is at least delta, so no sample whose density is p_E or more exceeds sigma_s I e^(-sigma_t delta) Theta / (4 pi D); there
// may be two, drawn either way. An interface parts the ray into two segments: only walks that pass the first one, a length c, with
// probability e^(-sigma_t c), come to the light.
TEST(Equiangular, LightBesideARayIsTheIntegralAndHasABound) {
    constexpr double kSigmaS = 0.4, kSigmaT = 0.5, kD = 0.02, kDelta = 2, kEnd = 4, kInterface = 1.8;
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0.1 830 0.1] \"spectrum sigma_s\" [360 "
        "0.4 "
        "830 0.4]\n"
        "Integrator \"path\" \"integer maxdepth\" 1\nMediumInterface \"fog\" \"fog\"\nLookAt 0 0 0  0 0 1  0 1 0\n"
        "Camera \"orthographic\" \"float screenwindow\" [-1e-4 1e-4 -1e-4 1e-4]\nWorldBegin\nMediumInterface \"fog\" \"fog\"\n"
        "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" \"point3 from\" [0.02 0 2]\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 0 830 0]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -9 4  9 -9 4  0 9 4] \"integer indices\" [0 1 2]\n";
    const std::string interface =
        "Material \"interface\" Shape \"trianglemesh\" \"point3 P\" [-9 -9 1.8  9 -9 1.8  0 9 1.8] \"integer indices\" [0 1 2]\n";

    const double from = std::atan(-kDelta / kD), angle = std::atan((kEnd - kDelta) / kD) - from;
    double integral = 0;
    constexpr int kSteps = 100'000;
    for (int i = 0; i < kSteps; ++i) {
        const double theta = from + (i + 0.5) / kSteps * angle, t = kDelta + kD * std::tan(theta), d = kD / std::cos(theta);
        integral += std::exp(-kSigmaT * (t + d)) * angle / kSteps;
    }
    const double scale = kSigmaS / (4 * std::numbers::pi * kD);

    for (const bool parted : {false, true}) {
        const double bound = 2 * scale * std::exp(-kSigmaT * (kDelta - (parted ? kInterface : 0))) * angle;
        const Scene scene = scene_from(parted ? fog + interface : fog);
        const std::unique_ptr<Integrator> path =
            scene.integrator({.max_depth = 0, .record = sampledb::RecordKind::kXyz, .seed = 3});
        sampledb::Records r;
        RadianceFaults faults;
        constexpr int kCount = 100'000;
        for (std::uint64_t n = 0; n < kCount; ++n) path->trace(n, r, faults);
        EXPECT_EQ(faults.total(), 0u);
        double sum = 0, squares = 0, brightest = 0;
        for (const float y : r.y) {
            const double value = static_cast<double>(y);
            sum += value;
            squares += value * value;
            brightest = std::max(brightest, value);
        }
        const double mean = sum / kCount, error = std::sqrt((squares / kCount - mean * mean) / kCount);
        EXPECT_NEAR(mean, scale * integral, 5 * error);
        EXPECT_LT(error, 0.005 * mean);
        EXPECT_LT(brightest, 1.05 * bound);  // the 28 wavelengths of one sample are not the whole lamp
    }
}

}  // namespace
}  // namespace latent::render::testing
