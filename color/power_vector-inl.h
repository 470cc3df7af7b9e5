// color/power_vector-inl.h: logarithms and powers of vectors, without libm: they decide pixels. Included once per instruction set
// by the sources of row functions (color/quantise_row.cpp, color/film/process_row.cpp), inside no namespace.
#if defined(LATENT_COLOR_POWER_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)  // as Highway's own headers of this kind
#ifdef LATENT_COLOR_POWER_VECTOR_INL
#undef LATENT_COLOR_POWER_VECTOR_INL
#else
#define LATENT_COLOR_POWER_VECTOR_INL
#endif

#include <hwy/highway.h>

#include <cstdint>

// Mul and Add only, no fused or approximate operation: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::color::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
constexpr D d;
constexpr hn::Rebind<std::int32_t, D> di;

HWY_INLINE V constant(float value) { return hn::Set(d, value); }

// log2(v) for normal positive v: exponent plus 2/ln2 (s + s^3/3 + s^5/5 + s^7/7 + s^9/9), s = (m-1)/(m+1), sqrt(1/2) <= m <
// sqrt(2). The next term is below 4e-10.
HWY_INLINE V log2(V v) {
    constexpr float kTwoOverLn2 = 2.88539008F;
    const auto bits = hn::BitCast(di, v);
    const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, 0x3F3504F3)));  // exponent of v / sqrt(1/2), rounded down
    const V m = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
    const V s = hn::Div(hn::Sub(m, constant(1)), hn::Add(m, constant(1))), s2 = hn::Mul(s, s);
    const auto next = [&](V series, float divisor) { return hn::Add(hn::Mul(series, s2), constant(kTwoOverLn2 / divisor)); };
    const V series = next(next(next(next(constant(kTwoOverLn2 / 9), 7), 5), 3), 1);
    return hn::Add(hn::ConvertTo(d, exponent), hn::Mul(s, series));
}

// 2^u for -126 <= u <= 126: 2^n times Taylor's series of 2^f, |f| <= 1/2; the next term is below 6e-9.
HWY_INLINE V exp2(V u) {
    constexpr float kTaylor[] = {1,
                                 0.69314718056F,
                                 0.240226506959F,
                                 0.0555041086648F,
                                 0.00961812910763F,
                                 0.00133335581464F,
                                 0.000154035303934F,
                                 0.0000152527338041F};
    const V n = hn::Round(u), f = hn::Sub(u, n);
    V p = constant(kTaylor[7]);
    for (int i = 6; i >= 0; --i) p = hn::Add(hn::Mul(p, f), constant(kTaylor[i]));
    return hn::Mul(p, hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, n), hn::Set(di, 127)))));
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
