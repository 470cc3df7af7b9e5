#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/denoise/row_loops.cpp"
#include "tools/develop/denoise/row_loops.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kBeyond = 1.5f;  // squares of differences count down to 0 over so many variances

// make(d, i): numbers i .. of `to`, a vector of tag d. The last ones may be made twice.
template <class Make>
HWY_INLINE void make_row(std::size_t n, float* HWY_RESTRICT to, const Make& make) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    if (n < lanes) {
        const hn::CappedTag<float, 1> one;
        for (std::size_t i = 0; i < n; ++i) hn::StoreU(make(one, i), one, to + i);
        return;
    }
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) hn::StoreU(make(d, i), d, to + i);
    if (i < n) hn::StoreU(make(d, n - lanes), d, to + n - lanes);
}

// 0 where x is not a number.
template <class D>
HWY_INLINE hn::Vec<D> at_least_0(D d, hn::Vec<D> x) {
    return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), x);
}

// From 1 at 0 to 0 at 1.
template <class D>
HWY_INLINE hn::Vec<D> falling(D d, hn::Vec<D> x) {
    const auto left = at_least_0(d, hn::Sub(hn::Set(d, 1), x));
    return hn::Mul(left, left);
}

template <class D>
HWY_INLINE hn::Vec<D> difference(D d, const Pair& pair, std::size_t i) {
    return hn::Sub(hn::LoadU(d, pair.a + i), hn::LoadU(d, pair.b + i));
}

void AddUp(std::size_t n, std::size_t count, const float* rows, std::size_t step, float* to) {
    make_row(n, to, [=](auto d, std::size_t i) HWY_ATTR {
        auto sum = hn::LoadU(d, rows + i);
        for (std::size_t k = 1; k < count; ++k) sum = hn::Add(sum, hn::LoadU(d, rows + k * step + i));
        return sum;
    });
}

void CompareLight(std::size_t n, std::span<const ComparedLight> channels, float* to) {
    const float share = 1 / static_cast<float>(channels.size());
    make_row(n, to, [=](auto d, std::size_t i) HWY_ATTR {
        auto sum = hn::Zero(d);
        for (const ComparedLight& channel : channels) {
            const auto by = difference(d, channel.value, i);
            const auto variance = hn::Add(hn::LoadU(d, channel.variance.a + i), hn::LoadU(d, channel.variance.b + i));
            const auto ratio = hn::Div(hn::Mul(by, by), hn::Add(variance, hn::Set(d, 1e-30f)));
            sum = hn::Add(sum, hn::Mul(hn::Set(d, share), ratio));
        }
        return sum;
    });
}

void Weigh(std::size_t n, const ComparedPixels& compared, float* weights) {
    make_row(n, weights, [&compared](auto d, std::size_t i) HWY_ATTR {
        const auto pixels = hn::Mul(hn::LoadU(d, compared.columns + i), hn::Set(d, compared.rows));
        const auto light = hn::Div(hn::LoadU(d, compared.light + i), pixels);
        auto weight = falling(d, hn::Mul(at_least_0(d, hn::Sub(light, hn::Set(d, 1))), hn::Set(d, 1 / kBeyond)));
        for (const ComparedVectors& vectors : compared.vectors) {
            auto distance = hn::Zero(d);
            for (const Pair& pair : vectors.of) {
                const auto by = difference(d, pair, i);
                distance = hn::Add(distance, hn::Mul(by, by));
            }
            weight = hn::Mul(weight, falling(d, hn::Mul(distance, hn::Set(d, vectors.scale))));
        }
        if (compared.depth.a) {
            const auto by = difference(d, compared.depth, i);
            const auto depth = hn::Max(hn::LoadU(d, compared.depth.a + i), hn::LoadU(d, compared.depth.b + i));
            const auto square = hn::Mul(hn::Mul(by, by), hn::Set(d, compared.depth_scale));
            weight = hn::Mul(weight, falling(d, hn::Div(square, hn::Add(hn::Mul(depth, depth), hn::Set(d, 1e-30f)))));
        }
        if (compared.known.a) {
            weight = hn::Mul(weight, hn::LoadU(d, compared.known.a + i));
            weight = hn::Mul(weight, hn::LoadU(d, compared.known.b + i));
        }
        return weight;
    });
}

// Plain loops, which compilers turn into vectors of each instruction set.
void AddRow(std::size_t n, const float* HWY_RESTRICT row, float* HWY_RESTRICT sums) {
    for (std::size_t i = 0; i < n; ++i) sums[i] += row[i];
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

LATENT_SIMD_EXPORT(AddUp);
LATENT_SIMD_EXPORT(CompareLight);
LATENT_SIMD_EXPORT(Weigh);
LATENT_SIMD_EXPORT(AddRow);
LATENT_SIMD_EXPORT(AddProducts);
LATENT_SIMD_EXPORT(AddSquaredProducts);

void add_up(std::size_t n, std::size_t count, const float* rows, std::size_t step, float* to) {
    LATENT_SIMD_CALL(AddUp)(n, count, rows, step, to);
}
void compare_light(std::size_t n, std::span<const ComparedLight> channels, float* to) {
    LATENT_SIMD_CALL(CompareLight)(n, channels, to);
}
void weigh(std::size_t n, const ComparedPixels& compared, float* weights) { LATENT_SIMD_CALL(Weigh)(n, compared, weights); }
void add_row(std::size_t n, const float* row, float* sums) { LATENT_SIMD_CALL(AddRow)(n, row, sums); }
void add_products(std::size_t n, const float* weights, const float* values, float* sums) {
    LATENT_SIMD_CALL(AddProducts)(n, weights, values, sums);
}
void add_squared_products(std::size_t n, const float* weights, const float* values, float* sums) {
    LATENT_SIMD_CALL(AddSquaredProducts)(n, weights, values, sums);
}

}  // namespace latent::develop
#endif
