// tests/transport/blocks.h: pictures as means over blocks of the film, straight from records: the box filter of blueprint-size pixels
// needs no darkroom. Camera image: mean of values over sum of shares; light image: sum over N, per area.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/integrator.h"

namespace latent::render::testing {

// A picture of side x side blocks, in XYZ.
struct Blocks {
    std::uint32_t side = 8;
    std::vector<std::array<double, 3>> xyz;
};

// Sums XYZ records of N samples.
class BlockSums {
 public:
    explicit BlockSums(std::uint32_t side) : side_(side), camera_(std::size_t{side} * side), light_(camera_), shares_(camera_.size()) {}

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
                out.xyz[b][c] = camera_[b][c] / shares_[b] + light_[b][c] * static_cast<double>(out.xyz.size()) / static_cast<double>(samples);
            }
        }
        return out;
    }

 private:
    std::uint32_t side_;
    std::vector<std::array<double, 3>> camera_, light_;
    std::vector<double> shares_;
};

// The mean of several independent pictures, and its standard error.
struct Estimate {
    Blocks mean, error;
};
inline Estimate mean_of(const std::vector<Blocks>& pictures) {
    Estimate e{pictures[0], pictures[0]};
    const double n = static_cast<double>(pictures.size());
    for (std::size_t b = 0; b < e.mean.xyz.size(); ++b) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0, squares = 0;
            for (const Blocks& p : pictures) sum += p.xyz[b][c] / n;
            for (const Blocks& p : pictures) squares += (p.xyz[b][c] - sum) * (p.xyz[b][c] - sum);
            e.mean.xyz[b][c] = sum;
            e.error.xyz[b][c] = std::sqrt(squares / (n - 1) / n);
        }
    }
    return e;
}

// A file of tests/transport/refs.
inline Estimate read_reference(const std::string& name) {
    std::ifstream file(std::string(LATENT_SOURCE_DIR) + "/tests/transport/refs/" + name + ".csv");
    std::string line;
    std::getline(file, line);
    Estimate e{{8, std::vector<std::array<double, 3>>(64)}, {8, std::vector<std::array<double, 3>>(64)}};
    for (std::size_t b = 0; b < 64; ++b) {
        std::getline(file, line);
        for (char& c : line) c = c == ',' ? ' ' : c;
        std::istringstream fields(line);
        int x = 0, y = 0;
        fields >> x >> y;
        for (double& v : e.mean.xyz[b]) fields >> v;
        for (double& v : e.error.xyz[b]) fields >> v;
        if (!fields) throw std::runtime_error("reference " + name + ": bad line");
    }
    return e;
}

}  // namespace latent::render::testing
