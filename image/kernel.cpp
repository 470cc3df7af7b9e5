#include "image/kernel.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "image/fourier.h"

namespace latent::image {
namespace {

// Integral of the tent max(0, 1 - |t|) from -1.
double tent_before(double t) {
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    const double to_end = 1 - std::abs(t);
    return t < 0 ? to_end * to_end / 2 : 1 - to_end * to_end / 2;
}

// What pixels get of a cell along an axis: the tent is a pixel's width of light, seen by a pixel's width.
struct Shares {
    int first = 0;  // pixel
    std::vector<float> parts;
};
std::vector<Shares> shares_of(int size, double cell, int radius) {
    std::vector<Shares> all(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
        const double from = (i - size / 2 - 0.5) * cell, to = from + cell;
        Shares& shares = all[static_cast<std::size_t>(i)];
        shares.first = std::max(-radius, static_cast<int>(std::floor(from - 1)) + 1);
        const int last = std::min(radius, static_cast<int>(std::ceil(to + 1)) - 1);
        for (int n = shares.first; n <= last; ++n)
            shares.parts.push_back(static_cast<float>((tent_before(to - n) - tent_before(from - n)) / cell));
    }
    return all;
}

}  // namespace

Kernel::Kernel(int radius) : radius_(radius) {
    const std::size_t count = static_cast<std::size_t>(side()) * static_cast<std::size_t>(side());
    for (std::vector<float>& plane : weights_) plane.assign(count, 0.0F);
}

void add_pattern(const Pattern& pattern, double cell, const std::array<float, 3>& weights, Kernel& kernel) {
    const std::vector<Shares> shares = shares_of(pattern.size, cell, kernel.radius());
    const auto side = static_cast<std::size_t>(kernel.side()), size = static_cast<std::size_t>(pattern.size);
    std::vector<float> narrowed(size * side);
    tbb::parallel_for(std::size_t{0}, size, [&](std::size_t y) {
        float* row = &narrowed[y * side];
        for (std::size_t x = 0; x < size; ++x) {
            const float light = pattern.light[y * size + x];
            float* to = row + (shares[x].first + kernel.radius());
            for (std::size_t i = 0; i < shares[x].parts.size(); ++i) to[i] += shares[x].parts[i] * light;
        }
    });
    // Columns in groups: each is summed in the order of its rows.
    constexpr std::size_t kGroup = 64;
    tbb::parallel_for(std::size_t{0}, (side + kGroup - 1) / kGroup, [&](std::size_t group) {
        const std::size_t begin = group * kGroup, count = std::min(kGroup, side - begin);
        std::vector<float> sums(side * count);
        for (std::size_t y = 0; y < size; ++y) {
            for (std::size_t i = 0; i < shares[y].parts.size(); ++i) {
                float* to = &sums[(static_cast<std::size_t>(shares[y].first + kernel.radius()) + i) * count];
                for (std::size_t x = 0; x < count; ++x) to[x] += shares[y].parts[i] * narrowed[y * side + begin + x];
            }
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (weights[c] == 0) continue;
            for (std::size_t y = 0; y < side; ++y) {
                for (std::size_t x = 0; x < count; ++x) kernel.plane(c)[y * side + begin + x] += weights[c] * sums[y * count + x];
            }
        }
    });
}

Kernel in_turn(const Kernel& first, const Kernel& second) {
    const int radius = first.radius() + second.radius();
    const int size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(16, 2 * radius + 1))));
    const SquareFourier fourier(size);
    Kernel out(radius);
    const auto place = [&](int x, int y) {
        return static_cast<std::size_t>(y & (size - 1)) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x & (size - 1));
    };
    const auto count = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    std::vector<float> a(count), b(count), scratch(count);
    const auto fill = [&](const Kernel& kernel, std::size_t c, std::vector<float>& plane) {
        std::ranges::fill(plane, 0.0F);
        std::ranges::fill(scratch, 0.0F);
        double sum = 0;
        for (int y = -kernel.radius(); y <= kernel.radius(); ++y) {
            for (int x = -kernel.radius(); x <= kernel.radius(); ++x) {
                if (x == 0 && y == 0) continue;
                plane[place(x, y)] = kernel.at(c, x, y);
                sum += static_cast<double>(kernel.at(c, x, y));
            }
        }
        plane[0] = static_cast<float>(1 - sum);
        fourier.forward(plane.data(), scratch.data());
    };
    for (std::size_t c = 0; c < 3; ++c) {
        fill(first, c, a);
        fill(second, c, b);
        // Both spectra are real: kernels are symmetric.
        const float scale = 1.0F / (static_cast<float>(size) * static_cast<float>(size));
        for (std::size_t i = 0; i < count; ++i) a[i] *= b[i] * scale;
        std::ranges::fill(scratch, 0.0F);
        fourier.inverse(a.data(), scratch.data());
        for (int y = -radius; y <= radius; ++y) {
            for (int x = -radius; x <= radius; ++x) out.set(c, x, y, a[place(x, y)]);
        }
    }
    return out;
}

}  // namespace latent::image
