// tests/transport/pictures.h: small pictures of whole scenes, each the mean of 16 with seeds of their own.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {

inline constexpr std::uint32_t kSeeds = 16;

// As deep as the scene says.
inline Estimate picture_of(const Scene& scene, IntegratorSettings settings, std::uint64_t samples_per_seed) {
    settings.max_depth = 0;
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

// Equal expectations exceed these bounds less than once in ten thousand times.
inline void expect_equal(const Estimate& a, const Estimate& b) {
    for (std::size_t c = 0; c < 3; ++c) {
        const Verdict v = compare(a, b, c);
        EXPECT_LT(v.mean_z2, 2);
        EXPECT_LT(std::abs(v.whole_z), 4.5);
        EXPECT_LT(v.whole_error, 0.02);
    }
}
inline void expect_path_and_bdpt_agree(const Scene& scene, std::uint64_t path_samples, std::uint64_t bdpt_samples) {
    expect_equal(picture_of(scene, {.kind = IntegratorKind::kPath}, path_samples),
                 picture_of(scene, {.kind = IntegratorKind::kBdpt}, bdpt_samples));
}

}  // namespace latent::render::testing
