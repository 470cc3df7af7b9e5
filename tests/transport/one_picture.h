// tests/transport/one_picture.h: whether scenes and integrators make the same picture.
#pragma once

#include "tests/transport/blocks.h"
#include "tests/transport/world_builder.h"

namespace latent::render::testing {

// 8 x 8 blocks of 8 pictures of independent seeds.
inline Estimate picture_of(const Scene& scene, IntegratorSettings settings, std::uint64_t samples) {
    settings.max_depth = 0;
    settings.record = sampledb::RecordKind::kXyz;
    std::vector<Blocks> pictures;
    for (std::uint64_t i = 0; i < 8; ++i, ++settings.seed) {
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(8);
        sampledb::Records r;
        RadianceFaults faults;
        for (std::uint64_t n = 0; n < samples; ++n) {
            r.clear();
            integrator->trace(n, r, faults);
            sums.add(r);
        }
        EXPECT_EQ(faults.total(), 0u);
        pictures.push_back(sums.picture(samples));
    }
    return mean_of(pictures);
}

// Over 192 comparisons with errors of 14 degrees of freedom, |t| > 6 has a probability of 0.6 %, and a picture as a whole of |t| >
// 4 one of 0.4 %. A difference of 4 % of the whole is thus seen.
inline void expect_same(const Estimate& a, const Estimate& b) {
    for (std::size_t c = 0; c < 3; ++c) {
        const Verdict v = compare(a, b, c);
        EXPECT_LT(v.worst_z, 6) << "XYZ"[c];
        EXPECT_LT(std::abs(v.whole_z), 4) << "XYZ"[c];
        EXPECT_LT(v.whole_error, 0.01);
    }
}

// By path, and by bdpt with both kinds of connections.
inline void expect_agreement(const Scene& scene, std::uint64_t samples) {
    const Estimate path = picture_of(scene, {.kind = IntegratorKind::kPath, .seed = 1}, samples);
    for (const Connections connections : {Connections::kOne, Connections::kAll}) {
        expect_same(picture_of(scene, {.kind = IntegratorKind::kBdpt, .connections = connections, .seed = 100}, samples), path);
    }
}

}  // namespace latent::render::testing
