#include "image/fourier.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include "image/fourier_strip.h"

namespace latent::image {
namespace {

// Unit vectors at equal angles, by halving the angle between neighbours: square roots are rounded alike everywhere, sines are not.
void fill_circle(std::vector<float>& cosine, std::vector<float>& sine) {
    const std::size_t size = cosine.size();
    std::vector<double> c(size + 1), s(size + 1);
    for (std::size_t quarter = 0; quarter <= 4; ++quarter) {
        constexpr double kCos[] = {1, 0, -1, 0, 1}, kSin[] = {0, 1, 0, -1, 0};
        c[quarter * size / 4] = kCos[quarter];
        s[quarter * size / 4] = kSin[quarter];
    }
    for (std::size_t step = size / 4; step > 1; step /= 2) {
        for (std::size_t i = 0; i < size; i += step) {
            const double x = c[i] + c[i + step], y = s[i] + s[i + step], length = std::sqrt(x * x + y * y);
            c[i + step / 2] = x / length;
            s[i + step / 2] = y / length;
        }
    }
    for (std::size_t i = 0; i < size; ++i) {
        cosine[i] = static_cast<float>(c[i]);
        sine[i] = static_cast<float>(s[i]);
    }
}

// Rows become columns, of a square as wide as a strip.
void turn(const float* from, std::size_t from_stride, float* to, std::size_t to_stride) {
    float square[kStripLanes][kStripLanes];
    for (std::size_t y = 0; y < kStripLanes; ++y) {
        for (std::size_t x = 0; x < kStripLanes; ++x) square[y][x] = from[y * from_stride + x];
    }
    for (std::size_t x = 0; x < kStripLanes; ++x) {
        for (std::size_t y = 0; y < kStripLanes; ++y) to[x * to_stride + y] = square[y][x];
    }
}

}  // namespace

SquareFourier::SquareFourier(int size) : size_(size), cos_(static_cast<std::size_t>(size)), sin_(static_cast<std::size_t>(size)) {
    assert(std::has_single_bit(static_cast<unsigned>(size)) && size >= 16);
    fill_circle(cos_, sin_);
}

int SquareFourier::negative(int place) {
    if (place == 0) return 0;
    return place ^ static_cast<int>(std::bit_floor(static_cast<unsigned>(place)) - 1);
}

int SquareFourier::frequency(int place) const {
    int reversed = 0;
    for (int bit = 1; bit < size_; bit *= 2) reversed = 2 * reversed + ((place & bit) != 0 ? 1 : 0);
    return reversed;
}

// Strips of columns, or of rows, are copied together: columns of a large array evict each other from a cache. So rows are read, and
// written, in whole lines of it.
template <bool kForward>
void SquareFourier::along_both(float* re, float* im) const {
    const std::size_t size = static_cast<std::size_t>(size_);
    tbb::enumerable_thread_specific<std::vector<float>> buffers;
    const auto each_strip = [&](const auto& work) {
        tbb::parallel_for(std::size_t{0}, size / kStripLanes, [&](std::size_t strip) {
            std::vector<float>& buffer = buffers.local();
            buffer.resize(2 * size * kStripLanes);
            work(strip * kStripLanes, std::array{std::pair{re, buffer.data()}, std::pair{im, buffer.data() + size * kStripLanes}});
        });
    };
    const auto transform = [&](const auto& parts) {
        fourier_strip(kForward, parts[0].second, parts[1].second, size, cos_.data(), sin_.data());
    };
    const auto columns = [&](std::size_t first, const auto& parts) {
        for (const auto& [plane, part] : parts) {
            for (std::size_t y = 0; y < size; ++y) std::copy_n(plane + y * size + first, kStripLanes, part + y * kStripLanes);
        }
        transform(parts);
        for (const auto& [plane, part] : parts) {
            for (std::size_t y = 0; y < size; ++y) std::copy_n(part + y * kStripLanes, kStripLanes, plane + y * size + first);
        }
    };
    const auto rows = [&](std::size_t first, const auto& parts) {
        for (const auto& [plane, part] : parts) {
            for (std::size_t x = 0; x < size; x += kStripLanes)
                turn(plane + first * size + x, size, part + x * kStripLanes, kStripLanes);
        }
        transform(parts);
        for (const auto& [plane, part] : parts) {
            for (std::size_t x = 0; x < size; x += kStripLanes)
                turn(part + x * kStripLanes, kStripLanes, plane + first * size + x, size);
        }
    };
    if constexpr (kForward) each_strip(columns);
    each_strip(rows);
    if constexpr (!kForward) each_strip(columns);
}

void SquareFourier::forward(float* re, float* im) const { along_both<true>(re, im); }
void SquareFourier::inverse(float* re, float* im) const { along_both<false>(re, im); }

}  // namespace latent::image
