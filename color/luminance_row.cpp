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

V luminances(const std::array<double, 3>& y_row, const PrintableRange& range, V x, V y, V z, LuminanceCounts& counts) {
    const Mask adaptable = hn::And(finite(x), hn::And(finite(y), finite(z)));
    const V out = hn::IfThenElse(adaptable, adapted_luminance(y_row, x, y, z), y);
    counts.dark += hn::CountTrue(d, hn::Le(out, constant(0)));
    counts.black += hn::CountTrue(d, hn::Lt(out, constant(range.black)));
    counts.burnt += hn::CountTrue(d, hn::Ge(out, constant(range.burnt)));
    return out;
}

LuminanceCounts luminance_row_of_target(const std::array<double, 3>& y_row, const PrintableRange& range, std::span<const float> x,
                                        std::span<const float> y, std::span<const float> z, std::span<float> out) {
    LuminanceCounts counts;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= out.size(); i += lanes)
        hn::StoreU(luminances(y_row, range, hn::LoadU(d, &x[i]), hn::LoadU(d, &y[i]), hn::LoadU(d, &z[i]), counts), d, &out[i]);
    for (; i < out.size(); ++i) {
        // Lane 0 among copies of itself: each pixel of the rest alone.
        LuminanceCounts copies;
        out[i] = hn::GetLane(luminances(y_row, range, constant(x[i]), constant(y[i]), constant(z[i]), copies));
        counts += {copies.dark / lanes, copies.black / lanes, copies.burnt / lanes};
    }
    return counts;
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace latent::color {

HWY_EXPORT(luminance_row_of_target);

LuminanceCounts& LuminanceCounts::operator+=(const LuminanceCounts& other) {
    dark += other.dark;
    black += other.black;
    burnt += other.burnt;
    return *this;
}

LuminanceCounts luminance_row(const std::array<double, 3>& y_row, const PrintableRange& range, std::span<const float> x,
                              std::span<const float> y, std::span<const float> z, std::span<float> out) {
    return HWY_DYNAMIC_DISPATCH(luminance_row_of_target)(y_row, range, x, y, z, out);
}

}  // namespace latent::color
#endif
