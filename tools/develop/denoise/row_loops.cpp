#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/denoise/row_loops.cpp"
#include "tools/develop/denoise/row_loops.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include <algorithm>

// Plain loops, which compilers turn into vectors of each instruction set.
HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {

constexpr float kCertain = 0.25f;  // variance over squared value, at most, when pixels are compared
constexpr float kBeyond = 1.5f;    // squares of differences count down to 0 over so many variances

// From 1 at 0 to 0 at 1.
HWY_INLINE float Falling(float x) {
    const float left = std::max(0.0f, 1 - x);
    return left * left;
}

// The light of one sample, or of few, cannot show how much it varies: such a pixel would be like all others. Their light would go
// over to the dark.
HWY_INLINE float Bounded(float variance, float value) { return std::min(variance, kCertain * value * value); }

void AddRow(std::size_t n, const float* HWY_RESTRICT from, float* HWY_RESTRICT to) {
    for (std::size_t i = 0; i < n; ++i) to[i] += from[i];
}

void MultiplyRow(std::size_t n, const float* HWY_RESTRICT by, float* HWY_RESTRICT to) {
    for (std::size_t i = 0; i < n; ++i) to[i] *= by[i];
}

void AddDifferences(std::size_t n, float share, const float* HWY_RESTRICT a, const float* HWY_RESTRICT b,
                    const float* HWY_RESTRICT v, const float* HWY_RESTRICT w, float* HWY_RESTRICT to) {
    for (std::size_t i = 0; i < n; ++i)
        to[i] += share * ((a[i] - b[i]) * (a[i] - b[i]) / (Bounded(v[i], a[i]) + Bounded(w[i], b[i]) + 1e-30f));
}

void WeighDifferences(std::size_t n, float* HWY_RESTRICT weights) {
    for (std::size_t i = 0; i < n; ++i) weights[i] = Falling(std::max(0.0f, weights[i] - 1) * (1 / kBeyond));
}

void WeighVectors(std::size_t n, float scale, const Vectors& a, const Vectors& b, float* HWY_RESTRICT weights) {
    const float *HWY_RESTRICT a0 = a[0], *HWY_RESTRICT a1 = a[1], *HWY_RESTRICT a2 = a[2];
    const float *HWY_RESTRICT b0 = b[0], *HWY_RESTRICT b1 = b[1], *HWY_RESTRICT b2 = b[2];
    for (std::size_t i = 0; i < n; ++i) {
        const float d0 = a0[i] - b0[i], d1 = a1[i] - b1[i], d2 = a2[i] - b2[i];
        weights[i] *= Falling((d0 * d0 + d1 * d1 + d2 * d2) * scale);
    }
}

void WeighDepths(std::size_t n, float scale, const float* HWY_RESTRICT a, const float* HWY_RESTRICT b,
                 float* HWY_RESTRICT weights) {
    for (std::size_t i = 0; i < n; ++i) {
        const float difference = a[i] - b[i], depth = std::max(a[i], b[i]);
        weights[i] *= Falling(difference * difference * scale / (depth * depth + 1e-30f));
    }
}

void AddProducts(std::size_t n, const float* HWY_RESTRICT weights, const float* HWY_RESTRICT values, float* HWY_RESTRICT sums) {
    for (std::size_t i = 0; i < n; ++i) sums[i] += weights[i] * values[i];
}

void AddSquaredProducts(std::size_t n, const float* HWY_RESTRICT weights, const float* HWY_RESTRICT values,
                        float* HWY_RESTRICT sums) {
    for (std::size_t i = 0; i < n; ++i) sums[i] += weights[i] * weights[i] * values[i];
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(AddRow);
LATENT_SIMD_EXPORT(MultiplyRow);
LATENT_SIMD_EXPORT(AddDifferences);
LATENT_SIMD_EXPORT(WeighDifferences);
LATENT_SIMD_EXPORT(WeighVectors);
LATENT_SIMD_EXPORT(WeighDepths);
LATENT_SIMD_EXPORT(AddProducts);
LATENT_SIMD_EXPORT(AddSquaredProducts);

void add_row(std::size_t n, const float* from, float* to) { LATENT_SIMD_CALL(AddRow)(n, from, to); }
void multiply_row(std::size_t n, const float* by, float* to) { LATENT_SIMD_CALL(MultiplyRow)(n, by, to); }
void add_differences(std::size_t n, float share, const float* a, const float* b, const float* v, const float* w, float* to) {
    LATENT_SIMD_CALL(AddDifferences)(n, share, a, b, v, w, to);
}
void weigh_differences(std::size_t n, float* weights) { LATENT_SIMD_CALL(WeighDifferences)(n, weights); }
void weigh_vectors(std::size_t n, float scale, const Vectors& a, const Vectors& b, float* weights) {
    LATENT_SIMD_CALL(WeighVectors)(n, scale, a, b, weights);
}
void weigh_depths(std::size_t n, float scale, const float* a, const float* b, float* weights) {
    LATENT_SIMD_CALL(WeighDepths)(n, scale, a, b, weights);
}
void add_products(std::size_t n, const float* weights, const float* values, float* sums) {
    LATENT_SIMD_CALL(AddProducts)(n, weights, values, sums);
}
void add_squared_products(std::size_t n, const float* weights, const float* values, float* sums) {
    LATENT_SIMD_CALL(AddSquaredProducts)(n, weights, values, sums);
}

}  // namespace latent::develop
#endif
