// tests/transport/comparison.h: pictures as means over blocks of the film, with errors, and what it means that two agree.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace latent::render::testing {

// A picture of side x side blocks, in XYZ.
struct Blocks {
    std::uint32_t side = 8;
    std::vector<std::array<double, 3>> xyz;
};

// The mean of several independent pictures, and its standard error.
struct Estimate {
    Blocks mean, error;
};
// Of pictures that are independent of each other.
inline Estimate sum_of(const std::vector<Estimate>& estimates) {
    Estimate sum = estimates[0];
    for (std::size_t b = 0; b < sum.mean.xyz.size(); ++b) {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 1; i < estimates.size(); ++i) {
                sum.mean.xyz[b][c] += estimates[i].mean.xyz[b][c];
                sum.error.xyz[b][c] = std::hypot(sum.error.xyz[b][c], estimates[i].error.xyz[b][c]);
            }
        }
    }
    return sum;
}
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

// A file of tests/transport/refs. Throws std::runtime_error.
inline Estimate read_reference(const std::string& path) {
    std::ifstream file(path);
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
        if (!fields) throw std::runtime_error(path + ": not a table of block means");
    }
    return e;
}

// What a comparison says, channel by channel.
struct Verdict {
    double worst_z = 0;         // of the 64 blocks
    double mean_z2 = 0;         // their mean square
    double whole_z = 0;         // of the mean of the picture
    double whole_relative = 0;  // its relative difference
    double whole_error = 0;     // and the standard error of that
};

inline Verdict compare(const Estimate& ours, const Estimate& reference, std::size_t channel) {
    Verdict v;
    double sum = 0, sum_reference = 0, variance = 0;
    const std::size_t blocks = ours.mean.xyz.size();
    for (std::size_t b = 0; b < blocks; ++b) {
        const double error = std::hypot(ours.error.xyz[b][channel], reference.error.xyz[b][channel]);
        const double difference = ours.mean.xyz[b][channel] - reference.mean.xyz[b][channel];
        v.worst_z = std::max(v.worst_z, std::abs(difference / error));
        v.mean_z2 += difference * difference / (error * error) / static_cast<double>(blocks);
        sum += ours.mean.xyz[b][channel];
        sum_reference += reference.mean.xyz[b][channel];
        variance += error * error;
    }
    v.whole_z = (sum - sum_reference) / std::sqrt(variance);
    v.whole_relative = sum / sum_reference - 1;
    v.whole_error = std::sqrt(variance) / sum_reference;
    return v;
}

}  // namespace latent::render::testing
