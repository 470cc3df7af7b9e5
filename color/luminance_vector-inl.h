// color/luminance_vector-inl.h: vectors of pixels, and y after adaptation. Included once per instruction set by the sources of
// row functions (color/print_row.cpp, color/luminance_row.cpp), inside no namespace.
#if defined(LATENT_COLOR_LUMINANCE_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)  // as Highway's own headers of this kind
#ifdef LATENT_COLOR_LUMINANCE_VECTOR_INL
#undef LATENT_COLOR_LUMINANCE_VECTOR_INL
#else
#define LATENT_COLOR_LUMINANCE_VECTOR_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace latent::color::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using Mask = hn::Mask<D>;
constexpr D d;

HWY_INLINE V constant(float value) { return hn::Set(d, value); }
HWY_INLINE Mask finite(V v) { return hn::Le(hn::Abs(v), constant(std::numeric_limits<float>::max())); }

// y after adaptation, in double lanes: y may be a small difference of large terms.
HWY_INLINE V adapted_luminance(const std::array<double, 3>& row, V x, V y, V z) {
    const hn::Half<D> half;
    const hn::Rebind<double, hn::Half<D>> wide;
    const auto sum = [&](auto part) {
        const auto a = hn::Mul(hn::Set(wide, row[0]), hn::PromoteTo(wide, part(x)));
        const auto b = hn::Mul(hn::Set(wide, row[1]), hn::PromoteTo(wide, part(y)));
        const auto c = hn::Mul(hn::Set(wide, row[2]), hn::PromoteTo(wide, part(z)));
        return hn::DemoteTo(half, hn::Add(hn::Add(a, b), c));
    };
    return hn::Combine(d, sum([&](V v) { return hn::UpperHalf(half, v); }), sum([&](V v) { return hn::LowerHalf(half, v); }));
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
