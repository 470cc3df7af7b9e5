#include "image/fourier.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <cassert>
#include <cmath>

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

// Strips of columns, or of rows, are copied together: columns of a large array evict each other from a cache.
template <bool kForward>
void SquareFourier::along_both(float* re, float* im) const {
    const std::size_t size = static_cast<std::size_t>(size_);
    tbb::enumerable_thread_specific<std::vector<float>> buffers;
    const auto along = [&](bool columns) {
        tbb::parallel_for(std::size_t{0}, size / kStripLanes, [&](std::size_t strip) {
            std::vector<float>& buffer = buffers.local();
            buffer.resize(2 * size * kStripLanes);
            float* const parts[] = {buffer.data(), buffer.data() + size * kStripLanes};
            float* const planes[] = {re, im};
            const std::size_t first = strip * kStripLanes * (columns ? 1 : size);
            const std::size_t step = columns ? size : 1, across = columns ? 1 : size;
            for (int p = 0; p < 2; ++p) {
                for (std::size_t i = 0; i < size; ++i) {
                    for (std::size_t k = 0; k < kStripLanes; ++k)
                        parts[p][i * kStripLanes + k] = planes[p][first + i * step + k * across];
                }
            }
            fourier_strip(kForward, parts[0], parts[1], size, cos_.data(), sin_.data());
            for (int p = 0; p < 2; ++p) {
                for (std::size_t i = 0; i < size; ++i) {
                    for (std::size_t k = 0; k < kStripLanes; ++k)
                        planes[p][first + i * step + k * across] = parts[p][i * kStripLanes + k];
                }
            }
        });
    };
    along(kForward);
    along(!kForward);
}

void SquareFourier::forward(float* re, float* im) const { along_both<true>(re, im); }
void SquareFourier::inverse(float* re, float* im) const { along_both<false>(re, im); }

}  // namespace latent::image
