#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "image/fourier_strip.cpp"  // compiled once per instruction set by foreach_target.h
#include "image/fourier_strip.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Mul, Add and Sub only, lane by lane: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::image::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kStripLanes>;
using V = hn::Vec<D>;
constexpr D d;

struct Complex {
    V re, im;
};
HWY_INLINE Complex operator+(const Complex& a, const Complex& b) { return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)}; }
HWY_INLINE Complex operator-(const Complex& a, const Complex& b) { return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)}; }
// b * i
HWY_INLINE Complex turned(const Complex& b) { return {hn::Neg(b.im), b.re}; }
HWY_INLINE Complex times(const Complex& a, float c, float s) {
    const V cos = hn::Set(d, c), sin = hn::Set(d, s);
    return {hn::Sub(hn::Mul(a.re, cos), hn::Mul(a.im, sin)), hn::Add(hn::Mul(a.re, sin), hn::Mul(a.im, cos))};
}
HWY_INLINE Complex load(const float* re, const float* im, std::size_t at) { return {hn::LoadU(d, re + at), hn::LoadU(d, im + at)}; }
HWY_INLINE void store(const Complex& v, float* re, float* im, std::size_t at) {
    hn::StoreU(v.re, d, re + at);
    hn::StoreU(v.im, d, im + at);
}

// Two halvings in one pass: decimation in frequency forward, in time backward, so that bits stay reversed in between.
template <bool kForward>
HWY_INLINE void quarters(float* re, float* im, std::size_t size, std::size_t length, const float* cosine, const float* sine) {
    const std::size_t quarter = length / 4, step = size / length;
    for (std::size_t first = 0; first < size; first += length) {
        for (std::size_t j = 0; j < quarter; ++j) {
            const float c1 = cosine[j * step], c2 = cosine[2 * j * step], c3 = cosine[3 * j * step];
            const float s1 = sine[j * step], s2 = sine[2 * j * step], s3 = sine[3 * j * step];
            for (std::size_t k = 0; k < kStripLanes; k += hn::Lanes(d)) {
                const std::size_t at = (first + j) * kStripLanes + k, next = quarter * kStripLanes;
                const Complex a = load(re, im, at), b = load(re, im, at + next), c = load(re, im, at + 2 * next),
                              e = load(re, im, at + 3 * next);
                if constexpr (kForward) {
                    const Complex sum = a + c, other = b + e, left = a - c, right = turned(b - e);
                    store(sum + other, re, im, at);
                    store(times(sum - other, c2, -s2), re, im, at + next);
                    store(times(left - right, c1, -s1), re, im, at + 2 * next);
                    store(times(left + right, c3, -s3), re, im, at + 3 * next);
                } else {
                    const Complex b2 = times(b, c2, s2), c2_ = times(c, c1, s1), e2 = times(e, c3, s3);
                    const Complex sum = a + b2, other = a - b2, left = c2_ + e2, right = turned(c2_ - e2);
                    store(sum + left, re, im, at);
                    store(other + right, re, im, at + next);
                    store(sum - left, re, im, at + 2 * next);
                    store(other - right, re, im, at + 3 * next);
                }
            }
        }
    }
}

HWY_INLINE void pairs(float* re, float* im, std::size_t size) {
    for (std::size_t i = 0; i < size; i += 2) {
        for (std::size_t k = 0; k < kStripLanes; k += hn::Lanes(d)) {
            const std::size_t at = i * kStripLanes + k;
            const Complex a = load(re, im, at), b = load(re, im, at + kStripLanes);
            store(a + b, re, im, at);
            store(a - b, re, im, at + kStripLanes);
        }
    }
}

void fourier_strip_of_target(bool forward, float* re, float* im, std::size_t size, const float* cosine, const float* sine) {
    std::size_t length = size;
    if (forward) {
        for (; length >= 4; length /= 4) quarters<true>(re, im, size, length, cosine, sine);
        if (length == 2) pairs(re, im, size);
        return;
    }
    while (length >= 4) length /= 4;
    if (length == 2) pairs(re, im, size);
    for (length *= 4; length <= size; length *= 4) quarters<false>(re, im, size, length, cosine, sine);
}

}  // namespace
}  // namespace latent::image::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::image {

LATENT_SIMD_EXPORT(fourier_strip_of_target);

void fourier_strip(bool forward, float* re, float* im, std::size_t size, const float* cosine, const float* sine) {
    LATENT_SIMD_CALL(fourier_strip_of_target)(forward, re, im, size, cosine, sine);
}

}  // namespace latent::image
#endif
