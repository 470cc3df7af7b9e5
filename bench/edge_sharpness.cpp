// bench/edge_sharpness.cpp: sharpness of a picture of a slanted edge, for bench/filters.
//   edge_sharpness EDGE.exr DEGREES
// EDGE shows black and a uniform bright half plane, whose border passes through the middle, DEGREES from upright (clockwise is
// positive). The profile across the edge is taken from the distances of all pixel centres from it, in bins of 1/10 pixel within 8
// pixels. Prints MTF50, the frequency in cycles per pixel at which the profile's derivative has half of its Fourier transform at
// zero, and how far the profile leaves [0, 1] of the step, in percent.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <exception>

#include "bench/exr.h"

namespace {

constexpr double kPi = 3.14159265358979323846, kReach = 8, kBin = 0.1;

std::vector<double> profile_of(const latent::bench::Planes& picture, double degrees) {
    const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
    const std::size_t bins = static_cast<std::size_t>(std::lround(2 * kReach / kBin));
    std::vector<double> sum(bins), count(bins);
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const double distance = (x + 0.5 - picture.width / 2.0) * c + (y + 0.5 - picture.height / 2.0) * s;
            const double bin = std::floor((distance + kReach) / kBin);
            if (bin < 0 || bin >= static_cast<double>(bins)) continue;
            sum[static_cast<std::size_t>(bin)] +=
                static_cast<double>(picture.channels[1][static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                                        static_cast<std::size_t>(x)]);
            count[static_cast<std::size_t>(bin)] += 1;
        }
    }
    for (std::size_t i = 0; i < bins; ++i) {
        if (count[i] == 0) throw std::runtime_error("the picture is too small");
        sum[i] /= count[i];
    }
    const double first = sum.front(), step = sum.back() - sum.front();
    for (double& value : sum) value = (value - first) / step;
    return sum;
}

// Of the derivative; differences and bins are each a box of width kBin.
double transfer(const std::vector<double>& profile, double frequency) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i)
        sum += (profile[i + 1] - profile[i]) * std::polar(1.0, -2 * kPi * frequency * kBin * static_cast<double>(i));
    const double x = kPi * frequency * kBin, box = x == 0 ? 1 : std::sin(x) / x;
    return std::abs(sum) / (box * box);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return fmt::print(stderr, "usage: edge_sharpness EDGE.exr DEGREES\n"), 2;
    try {
        const std::vector<double> profile = profile_of(latent::bench::read_planes(argv[1]), std::stod(argv[2]));
        double low = 0, high = 2;
        while (high - low > 1e-4) {
            const double middle = (low + high) / 2;
            (transfer(profile, middle) > 0.5 * transfer(profile, 0) ? low : high) = middle;
        }
        const auto [least, most] = std::ranges::minmax(profile);
        fmt::print("{:.4f} {:.2f}\n", low, 100 * std::max(-least, most - 1));
    } catch (const std::exception& e) {
        return fmt::print(stderr, "edge_sharpness: {}\n", e.what()), 1;
    }
    return 0;
}
