#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/luminance_row.cpp"  // compiled once per instruction set by foreach_target.h
#include "color/luminance_row.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "color/luminance_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latent::color::HWY_NAMESPACE {
namespace {

HWY_INLINE V luminances(const std::array<double, 3>& y_row, V x, V y, V z) {
    const Mask adaptable = hn::And(finite(x), hn::And(finite(y), finite(z)));
    return hn::IfThenElse(adaptable, adapted_luminance(y_row, x, y, z), y);
}

void luminance_row_of_target(const std::array<double, 3>& y_row, std::span<const float> x, std::span<const float> y,
                             std::span<const float> z, std::span<float> out) {
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= out.size(); i += lanes)
        hn::StoreU(luminances(y_row, hn::LoadU(d, &x[i]), hn::LoadU(d, &y[i]), hn::LoadU(d, &z[i])), d, &out[i]);
    for (; i < out.size(); ++i) out[i] = hn::GetLane(luminances(y_row, constant(x[i]), constant(y[i]), constant(z[i])));
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::color {

LATENT_SIMD_EXPORT(luminance_row_of_target);

void luminance_row(const std::array<double, 3>& y_row, std::span<const float> x, std::span<const float> y, std::span<const float> z,
                   std::span<float> out) {
    LATENT_SIMD_CALL(luminance_row_of_target)(y_row, x, y, z, out);
}

}  // namespace latent::color
#endif
