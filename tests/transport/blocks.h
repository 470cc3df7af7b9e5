// tests/transport/blocks.h: block means straight from records, which needs no darkroom. Camera image: sum of values over sum of
// shares; light image: sum over N, per area of the film.
#pragma once

#include <array>
#include <vector>

#include "render/transport/integrator.h"
#include "tests/transport/comparison.h"

namespace latent::render::testing {

// Sums XYZ records of N samples.
class BlockSums {
 public:
    explicit BlockSums(std::uint32_t side)
        : side_(side), camera_(std::size_t{side} * side), light_(camera_), shares_(camera_.size()) {}

    void add(const sampledb::Records& r) {
        for (std::size_t i = 0; i < r.size(); ++i) {
            const std::size_t block = (std::uint64_t{r.v[i]} * side_ >> 32) * side_ + (std::uint64_t{r.u[i]} * side_ >> 32);
            auto& sum = r.record_class[i] == sampledb::RecordClass::kCamera ? camera_[block] : light_[block];
            sum[0] += static_cast<double>(r.x[i]);
            sum[1] += static_cast<double>(r.y[i]);
            sum[2] += static_cast<double>(r.z[i]);
            shares_[block] += static_cast<double>(r.share[i]);
        }
    }
    Blocks picture(std::uint64_t samples) const {
        Blocks out{side_, camera_};
        for (std::size_t b = 0; b < out.xyz.size(); ++b) {
            for (std::size_t c = 0; c < 3; ++c) {
                out.xyz[b][c] =
                    camera_[b][c] / shares_[b] + light_[b][c] * static_cast<double>(out.xyz.size()) / static_cast<double>(samples);
            }
        }
        return out;
    }

 private:
    std::uint32_t side_;
    std::vector<std::array<double, 3>> camera_, light_;
    std::vector<double> shares_;
};

}  // namespace latent::render::testing
