#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/lens/lens_rows.cpp"
#include "tools/develop/lens/lens_rows.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "tools/develop/lens/aperture.h"

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Calls step(tag, i) for as many i at once as fit, then for one at a time.
template <class T, class Step>
void ForRows(std::size_t count, const Step& step) {
    const hn::ScalableTag<T> d;
    const hn::CappedTag<T, 1> one;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) step(d, i);
    for (; i < count; ++i) step(one, i);
}

template <class D>
auto LoadBytes(D d, const std::uint8_t* bytes) {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, D>(), bytes));
}

void WeighByRim(const RearRim& rim, const std::uint8_t* x, const std::uint8_t* y, const std::uint32_t* u, const std::uint32_t* v,
                std::span<float> weights) {
    constexpr float kPerCell = kLensCells / 2.0f;
    ForRows<float>(weights.size(), [&](auto d, std::size_t i) HWY_ATTR {
        const hn::RebindToSigned<decltype(d)> di;
        const hn::RebindToUnsigned<decltype(d)> du;
        // The leading 24 bits of a position are exact as float.
        const auto from_rim = [&](const std::uint8_t* cells, const std::uint32_t* film, float first, float along) HWY_ATTR {
            const auto position = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<8>(hn::LoadU(du, film + i))));
            const auto middle = hn::Mul(hn::ConvertTo(d, LoadBytes(di, cells + i)), hn::Set(d, 1 / kPerCell));
            return hn::Sub(hn::Add(middle, hn::Set(d, first)), hn::Mul(position, hn::Set(d, along * 0x1p-24f)));
        };
        const auto dx = from_rim(x, u, rim.first_x, rim.along_u), dy = from_rim(y, v, rim.first_y, rim.along_v);
        // The rim counts as straight within a cell.
        const auto distance = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const auto inside = hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1), distance), hn::Set(d, kPerCell)), hn::Set(d, 0.5f));
        const auto share = hn::Min(hn::Max(inside, hn::Zero(d)), hn::Set(d, 1));
        hn::StoreU(hn::Mul(hn::LoadU(d, &weights[i]), share), d, &weights[i]);
    });
}

void MovePositions(const AxisMove& along_u, const AxisMove& along_v, int level, const std::uint8_t* x, const std::uint8_t* y,
                   std::uint32_t* u, std::uint32_t* v, std::span<std::uint32_t> cells) {
    constexpr float kMost = 0x1p31f - 0x1p7f;  // the largest float below 2^31
    ForRows<std::uint32_t>(cells.size(), [&](auto d, std::size_t i) HWY_ATTR {
        const hn::RebindToSigned<decltype(d)> di;
        const hn::RebindToFloat<decltype(d)> df;
        // The number of the new cell among those wanted; `count` or more if it is not one of them.
        const auto move = [&](const AxisMove& axis, const std::uint8_t* lens, std::uint32_t* film) HWY_ATTR {
            const auto from_middle = hn::Sub(hn::ConvertTo(df, LoadBytes(di, lens + i)), hn::Set(df, (kLensCells - 1) / 2.0f));
            const auto by = hn::Mul(from_middle, hn::Set(df, axis.shift * (0x1p31f / (kLensCells / 2))));
            const auto clamped = hn::Min(hn::Max(by, hn::Set(df, -kMost)), hn::Set(df, kMost));
            // In units of 2^-31, where all that lies off the film has the leading bit.
            const auto from = hn::ShiftRight<1>(hn::LoadU(d, film + i));
            const auto to = hn::Add(from, hn::BitCast(d, hn::ConvertTo(di, clamped)));
            hn::StoreU(hn::ShiftLeft<1>(to), d, film + i);
            return hn::Sub(hn::ShiftRightSame(to, 31 - level), hn::Set(d, axis.first_cell));
        };
        const auto column = move(along_u, x, u), row = move(along_v, y, v);
        const auto width = hn::Set(d, along_u.count), height = hn::Set(d, along_v.count);
        const auto wanted = hn::And(hn::Lt(column, width), hn::Lt(row, height));
        hn::StoreU(hn::IfThenElse(wanted, hn::Add(hn::Mul(row, width), column), hn::Mul(width, height)), d, &cells[i]);
    });
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(WeighByRim);
LATENT_SIMD_EXPORT(MovePositions);

void weigh_by_rim(const RearRim& rim, const std::uint8_t* x, const std::uint8_t* y, const std::uint32_t* u, const std::uint32_t* v,
                  std::span<float> weights) {
    LATENT_SIMD_CALL(WeighByRim)(rim, x, y, u, v, weights);
}

void move_positions(const AxisMove& along_u, const AxisMove& along_v, int level, const std::uint8_t* x, const std::uint8_t* y,
                    std::uint32_t* u, std::uint32_t* v, std::span<std::uint32_t> cells) {
    LATENT_SIMD_CALL(MovePositions)(along_u, along_v, level, x, y, u, v, cells);
}

}  // namespace latent::develop
#endif
