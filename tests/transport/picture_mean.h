// tests/transport/picture_mean.h: what a picture has on the whole, straight from records.
#pragma once

#include <array>
#include <cmath>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

struct Mean {
    std::array<double, 3> xyz{}, error{};
};
// XYZ of the whole picture, and the standard error of as many independent samples.
inline Mean mean_of_picture(const Scene& scene, IntegratorSettings settings, std::uint64_t samples) {
    settings.record = sampledb::RecordKind::kXyz;
    const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
    Mean mean;
    sampledb::Records r;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < samples; ++n) {
        r.clear();
        integrator->trace(n, r, faults);
        std::array<double, 3> sum{};
        for (std::size_t i = 0; i < r.size(); ++i) {
            sum[0] += static_cast<double>(r.x[i]);
            sum[1] += static_cast<double>(r.y[i]);
            sum[2] += static_cast<double>(r.z[i]);
        }
        for (std::size_t c = 0; c < 3; ++c) mean.xyz[c] += sum[c], mean.error[c] += sum[c] * sum[c];
    }
    EXPECT_EQ(faults.total(), 0u);
    const double count = static_cast<double>(samples);
    for (std::size_t c = 0; c < 3; ++c) {
        mean.xyz[c] /= count;
        mean.error[c] = std::sqrt(std::max(0.0, mean.error[c] / count - mean.xyz[c] * mean.xyz[c]) / count);
    }
    return mean;
}

}  // namespace latent::render::testing
