// Whole pictures against pbrt-v4's, in block means (refs/README.md): the short form of bench/validate. Agreement is a statement about
// errors: each difference is measured in its own combined standard error, and an error of 2 % in the picture must be seen.
#include <fmt/format.h>

#include <algorithm>

#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {
namespace {

constexpr std::uint32_t kSeeds = 16;

Estimate render(const Scene& scene, IntegratorSettings settings, std::uint64_t samples_per_seed) {
    settings.record = sampledb::RecordKind::kXyz;
    std::vector<Blocks> pictures;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
        settings.seed = seed;
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(8);
        RadianceFaults faults;
        sampledb::Records records;
        for (std::uint64_t n = 0; n < samples_per_seed; ++n) {
            records.clear();
            integrator->trace(n, records, faults);
            sums.add(records);
        }
        EXPECT_EQ(faults.total(), 0u);
        pictures.push_back(sums.picture(samples_per_seed));
    }
    return mean_of(pictures);
}

// What a comparison says, channel by channel.
struct Verdict {
    double worst_z = 0;           // of the 64 blocks
    double mean_z2 = 0;           // their mean square
    double whole_z = 0;           // of the mean of the picture
    double whole_relative = 0;    // its relative difference
    double whole_error = 0;       // and the standard error of that
};

Verdict compare(const Estimate& ours, const Estimate& reference, std::size_t channel) {
    Verdict v;
    double sum = 0, sum_reference = 0, variance = 0;
    for (std::size_t b = 0; b < 64; ++b) {
        const double error = std::hypot(ours.error.xyz[b][channel], reference.error.xyz[b][channel]);
        const double difference = ours.mean.xyz[b][channel] - reference.mean.xyz[b][channel];
        v.worst_z = std::max(v.worst_z, std::abs(difference / error));
        v.mean_z2 += difference * difference / (error * error) / 64;
        sum += ours.mean.xyz[b][channel];
        sum_reference += reference.mean.xyz[b][channel];
        variance += error * error;
    }
    v.whole_z = (sum - sum_reference) / std::sqrt(variance);
    v.whole_relative = sum / sum_reference - 1;
    v.whole_error = std::sqrt(variance) / sum_reference;
    return v;
}

// With 15 degrees of freedom in our errors z is a little wider than normal: of 192 values the largest stays below 4.9 but once in a
// thousand pictures, and the mean of 64 squares lies in 0.55 .. 1.65 (Student's t: mean 1.15, standard deviation 0.23).
bool agrees(const Verdict& v) {
    return v.worst_z < 4.9 && v.mean_z2 > 0.5 && v.mean_z2 < 1.75 && (std::abs(v.whole_relative) < 0.003 || std::abs(v.whole_z) < 3.5);
}

void expect_agreement(const Estimate& ours, const Estimate& reference) {
    for (std::size_t c = 0; c < 3; ++c) {
        const Verdict v = compare(ours, reference, c);
        const std::string what = fmt::format("{}: worst z {:.2f}, mean z^2 {:.2f}, whole {:+.3f} % ({:.1f} standard errors)", "XYZ"[c], v.worst_z,
                                             v.mean_z2, 100 * v.whole_relative, v.whole_z);
        EXPECT_TRUE(agrees(v)) << what;
        EXPECT_LT(v.whole_error, 0.004) << "too noisy to see an error of 2 %";
        fmt::print("    {}\n", what);
    }
}

struct Case {
    const char* scene;
    IntegratorKind kind;
    Connections connections;
    std::uint64_t samples;  // of each seed
};

class Validation : public ::testing::TestWithParam<Case> {};

TEST_P(Validation, BlockMeansAreThoseOfTheReference) {
    const Case& c = GetParam();
    const Scene scene = scene_named(std::string(c.scene) + ".pbrt");
    const Estimate reference = read_reference(c.scene);
    const Estimate ours = render(scene, {.kind = c.kind, .connections = c.connections, .max_depth = 0}, c.samples);
    expect_agreement(ours, reference);

    // The same picture, 2 % brighter, is refused: in every channel, by the blocks or by the whole.
    Estimate wrong = ours;
    for (auto& xyz : wrong.mean.xyz) {
        for (double& v : xyz) v *= 1.02;
    }
    for (std::size_t channel = 0; channel < 3; ++channel) EXPECT_FALSE(agrees(compare(wrong, reference, channel))) << "XYZ"[channel];
}

INSTANTIATE_TEST_SUITE_P(Scenes, Validation,
                         ::testing::Values(Case{"cornell", IntegratorKind::kPath, Connections::kOne, 786432},
                                           Case{"cornell", IntegratorKind::kBdpt, Connections::kOne, 262144},
                                           Case{"sodium", IntegratorKind::kPath, Connections::kOne, 65536},
                                           Case{"sodium", IntegratorKind::kBdpt, Connections::kAll, 49152},
                                           Case{"conductors", IntegratorKind::kPath, Connections::kOne, 32768}),
                         [](const auto& instance) {
                             const Case& c = instance.param;
                             return std::string(c.scene) + (c.kind == IntegratorKind::kPath            ? "_path"
                                                            : c.connections == Connections::kOne ? "_bdpt_one"
                                                                                                       : "_bdpt_all");
                         });

}  // namespace
}  // namespace latent::render::testing
