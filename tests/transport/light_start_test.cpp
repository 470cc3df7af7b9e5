// The numbers that light subpaths start with: well spread, and independent of those that they meet in a path. docs/rendering.md,
// "The numbers of a sample".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/transport/transport.h"
#include "tests/transport/lit_floor.h"

namespace latent::render::testing {
namespace {

using D = Dimension;
const std::uint32_t kStart[] = {D::kStartU,
                                D::kStartV,
                                D::kStartDirectionU,
                                D::kStartDirectionV,
                                D::of_light_vertex(1, D::kDistance),
                                D::of_light_vertex(1, D::kDirectionU),
                                D::of_light_vertex(1, D::kDirectionV)};

// Every dimension that can be important is: a lens, a medium, dispersion, lights to choose from.
const std::string kEverything =
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .1 .1] \"rgb sigma_s\" [.1 .1 .1]\nLookAt 0 -3 3  0 "
    "0 0  0 0 1\nMediumInterface \"\" \"m\"\n"
    "Camera \"perspective\" \"float lensradius\" 0.1\nWorldBegin\nMediumInterface \"m\" \"m\"\nLightSource \"point\"\n"
    "LightSource \"spot\"\nMaterial \"dielectric\" \"spectrum eta\" \"glass-F11\"\nShape \"sphere\"\n";

// Pearson's chi-square of pairs in 8 x 8 boxes.
double chi_square(const std::vector<float>& x, const std::vector<float>& y) {
    constexpr std::size_t kBoxes = 8;
    std::array<double, kBoxes * kBoxes> count{};
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto box = [](float u) { return static_cast<std::size_t>(u * kBoxes); };
        count[box(x[i]) * kBoxes + box(y[i])] += 1;
    }
    const double expected = static_cast<double>(x.size()) / (kBoxes * kBoxes);
    double sum = 0;
    for (const double c : count) sum += (c - expected) * (c - expected) / expected;
    return sum;
}

// All pairs of a number of the light's ray with another of them, with the film position, or with a number of the camera subpath
// that stays in a path when the two are joined. 63 degrees of freedom: random numbers exceed 134 in one of a million pairs.
void expect_no_two_numbers_related(const sampledb::PositionSamplerSpec& positions) {
    constexpr std::uint64_t kSamples = 1 << 17;
    for (const std::string& text : {floor_under_spot(), floor_under_lamp(), kEverything}) {
        const Scene scene = scene_from(text);
        const std::unique_ptr<World> world = scene.world();
        const std::unique_ptr<const Sampler> made = make_sampler(positions, 11, *world);
        const Sampler& sampler = *made;
        std::vector<std::uint32_t> met = {D::kXi, D::kKeptWavelength, D::kLensU, D::kLensV};
        for (const std::uint32_t vertex : {0u, 1u, 2u}) {
            for (const std::uint32_t what :
                 {D::kDistanceChannel, D::kDistance, D::kLobe, D::kDirectionU, D::kDirectionV, D::kSurvival, D::kConnection}) {
                met.push_back(D::of_camera_vertex(vertex, what));
                met.push_back(D::of_light_vertex(vertex + 1, what));
            }
        }
        const auto numbers = [&](std::uint32_t dimension) {
            std::vector<float> x;
            for (std::uint64_t n = 0; n < kSamples; ++n) x.push_back(sampler.at(n, dimension));
            return x;
        };
        std::array<std::vector<float>, 2> film;
        for (std::uint64_t n = 0; n < kSamples; ++n) {
            const sampledb::FilmPosition p = sampler.position(sampler.key_of(n));
            film[0].push_back(static_cast<float>(p.u >> 8) * 0x1p-24f);
            film[1].push_back(static_cast<float>(p.v >> 8) * 0x1p-24f);
        }
        std::vector<std::vector<float>> others;
        for (const std::uint32_t dimension : met) others.push_back(numbers(dimension));
        for (const std::uint32_t dimension : kStart) {
            const std::vector<float> x = numbers(dimension);
            for (std::size_t i = 0; i < met.size(); ++i) {
                if (met[i] == dimension) continue;
                EXPECT_LT(chi_square(x, others[i]), 134) << dimension << ", " << met[i];
            }
            for (const std::vector<float>& f : film) EXPECT_LT(chi_square(x, f), 134) << dimension << " and the film";
            for (const std::uint32_t other : kStart) {
                if (other <= dimension) continue;
                EXPECT_LT(chi_square(x, numbers(other)), 134) << dimension << ", " << other;
            }
        }
        // The test can fail: what shares a prime is related.
        if (positions.sampler == sampledb::PositionSampler::kHalton23) {
            EXPECT_GT(chi_square(numbers(D::kStartDirectionU), numbers(D::of_camera_vertex(0, D::kLightU))), 134);
        }
    }
}
TEST(LightStart, NoTwoNumbersOfAPathAreRelatedByHalton) {
    expect_no_two_numbers_related({sampledb::PositionSampler::kHalton23, 0, 0});
}
// Sides that are powers of 2, as the sequences' blocks are, and others.
TEST(LightStart, NoTwoNumbersOfAPathAreRelatedByPixels) {
    expect_no_two_numbers_related({sampledb::PositionSampler::kPixels, 1, 2, 64, 64});
    expect_no_two_numbers_related({sampledb::PositionSampler::kPixels, 1, 2, 60, 34});
}

// Root mean square over 8 x 8 blocks of the film of the light image's standard deviation: among `seeds` pictures, and that of as
// many independent samples.
struct Noise {
    double found = 0, independent = 0;
};
Noise light_image_noise(const Scene& scene, std::uint64_t samples, std::uint32_t seeds) {
    constexpr std::size_t kSide = 8, kBlocks = kSide * kSide;
    std::array<double, kBlocks> sum{}, squares{}, of_samples{};
    const double count = static_cast<double>(samples);
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        const std::unique_ptr<Integrator> integrator =
            scene.integrator({.kind = IntegratorKind::kBdpt, .record = sampledb::RecordKind::kXyz, .seed = seed});
        std::array<double, kBlocks> picture{};
        sampledb::Records r;
        RadianceFaults faults;
        for (std::uint64_t n = 0; n < samples; ++n) {
            r.clear();
            integrator->trace(n, r, faults);
            for (std::size_t i = 0; i < r.size(); ++i) {
                if (r.record_class[i] == sampledb::RecordClass::kCamera) continue;
                const std::size_t block = (std::uint64_t{r.v[i]} * kSide >> 32) * kSide + (std::uint64_t{r.u[i]} * kSide >> 32);
                const double y = static_cast<double>(r.y[i]);
                picture[block] += y / count;
                of_samples[block] += y * y;
            }
        }
        for (std::size_t b = 0; b < kBlocks; ++b) sum[b] += picture[b], squares[b] += picture[b] * picture[b];
    }
    Noise noise;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const double mean = sum[b] / seeds;
        noise.found += std::max(0.0, squares[b] / seeds - mean * mean) * seeds / (seeds - 1);
        noise.independent += std::max(0.0, of_samples[b] / (seeds * count) - mean * mean) / count;
    }
    return {std::sqrt(noise.found / kBlocks), std::sqrt(noise.independent / kBlocks)};
}

// With 8 pictures of 64 blocks the ratio is known to 3 % (448 degrees of freedom): limits are 5 standard deviations away and more.
TEST(LightStart, TheLightImageIsLessNoisyThanByIndependentSamples) {
    for (const auto& [text, limit] : {std::pair{floor_under_spot(), 0.25}, std::pair{floor_under_lamp(), 0.85}}) {
        const Noise noise = light_image_noise(scene_from(text), 1 << 15, 8);
        fmt::print("    {:.3f} of the noise of independent samples\n", noise.found / noise.independent);
        EXPECT_LT(noise.found, limit * noise.independent);
        EXPECT_GT(noise.found, 0);
    }
}

}  // namespace
}  // namespace latent::render::testing
