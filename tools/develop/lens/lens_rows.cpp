#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/lens/lens_rows.cpp"
#include "tools/develop/lens/lens_rows.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include <algorithm>

#include "tools/develop/lens/aperture.h"

#ifndef LATENT_DEVELOP_LENS_ROWS
#define LATENT_DEVELOP_LENS_ROWS
namespace latent::develop {

// Some records: where in the tables they find what they need, and what that is.
struct Places {
    static constexpr std::size_t kAtOnce = 128;
    std::uint32_t cell[kAtOnce], step[kAtOnce], patch[kAtOnce];
    float after_step[kAtOnce];  // in steps
};
struct Found {
    Places places;
    float cell[Places::kAtOnce], open[Places::kAtOnce][2];
    Patch patch[Places::kAtOnce];
};

}  // namespace latent::develop
#endif

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

// The leading 24 bits of positions, which are exact as float.
template <class D>
auto LoadFractions(D d, const std::uint32_t* positions) {
    const hn::RebindToSigned<D> di;
    const hn::RebindToUnsigned<D> du;
    return hn::Mul(hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<8>(hn::LoadU(du, positions)))), hn::Set(d, 0x1p-24f));
}

// The share of a record's cell of the lens that lies within the rim, which counts as straight there.
template <class D>
auto ShareInRim(D d, const RearRim& rim, const LensRows& rows, std::size_t i) {
    constexpr float kPerCell = kLensCells / 2.0f;
    const auto from_rim = [&](const std::uint8_t* cells, const std::uint32_t* film, float first, float along) HWY_ATTR {
        const auto middle = hn::Mul(hn::ConvertTo(d, LoadBytes(hn::RebindToSigned<D>(), cells + i)), hn::Set(d, 1 / kPerCell));
        return hn::Sub(hn::Add(middle, hn::Set(d, first)), hn::Mul(LoadFractions(d, film + i), hn::Set(d, along)));
    };
    const auto dx = from_rim(rows.x, rows.u, rim.first_x, rim.along_u), dy = from_rim(rows.y, rows.v, rim.first_y, rim.along_v);
    const auto distance = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    const auto inside = hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1), distance), hn::Set(d, kPerCell)), hn::Set(d, 0.5f));
    return hn::Min(hn::Max(inside, hn::Zero(d)), hn::Set(d, 1));
}

void FindPlaces(const LensTables& tables, const LensRows& rows, std::size_t count, Places& places) {
    ForRows<float>(count, [&](auto d, std::size_t i) HWY_ATTR {
        const hn::RebindToSigned<decltype(d)> di;
        const hn::RebindToUnsigned<decltype(d)> du;
        if (tables.cells != nullptr)
            hn::StoreU(hn::Or(hn::ShiftLeft<8>(LoadBytes(du, rows.y + i)), LoadBytes(du, rows.x + i)), du, places.cell + i);
        if (const ShutterSteps& shutter = tables.shutter; shutter.open != nullptr) {
            const auto time = hn::Mul(hn::ConvertTo(d, LoadBytes(di, rows.time + i)), hn::Set(d, shutter.rows.per_cell));
            const auto later = hn::Mul(LoadFractions(d, rows.v + i), hn::Set(d, shutter.rows.later_in_last));
            const auto after = hn::Sub(hn::Sub(time, hn::Set(d, shutter.rows.begins)), later);
            const auto step = hn::Min(hn::Max(after, hn::Zero(d)), hn::Set(d, shutter.last));
            const auto whole = hn::ConvertTo(di, step);
            hn::StoreU(hn::BitCast(du, whole), du, places.step + i);
            hn::StoreU(hn::Sub(step, hn::ConvertTo(d, whole)), d, places.after_step + i);
        }
        if (tables.patches != nullptr) {
            const auto column = hn::ShiftRight<32 - Patch::kBits>(hn::LoadU(du, rows.u + i)),
                       row = hn::ShiftRight<32 - Patch::kBits>(hn::LoadU(du, rows.v + i));
            hn::StoreU(hn::Or(hn::ShiftLeft<Patch::kBits>(row), column), du, places.patch + i);
        }
    });
}

void Combine(const LensTables& tables, const LensRows& rows, const Found& found, LightFactor light, std::size_t count,
             float* weights, float* light_factors) {
    ForRows<float>(count, [&](auto d, std::size_t i) HWY_ATTR {
        const hn::RebindToSigned<decltype(d)> di;
        const hn::RebindToUnsigned<decltype(d)> du;
        auto weight = tables.cells != nullptr ? hn::LoadU(d, found.cell + i) : hn::Set(d, 1);
        if (tables.rim) weight = hn::Mul(weight, ShareInRim(d, *tables.rim, rows, i));
        if (tables.shutter.open != nullptr) {
            auto here = hn::Zero(d), next = here;
            hn::LoadInterleaved2(d, found.open[i], here, next);
            const auto open = hn::Add(here, hn::Mul(hn::LoadU(d, found.places.after_step + i), hn::Sub(next, here)));
            weight = hn::Mul(weight, open);
        }
        hn::StoreU(weight, d, weights + i);
        if (light == LightFactor::kWeight) return hn::StoreU(weight, d, light_factors + i);
        auto mean = hn::Set(d, 1);
        if (tables.patches != nullptr) {
            const auto within = [&](const std::uint32_t* film) HWY_ATTR {
                const auto position = hn::And(hn::LoadU(du, film + i), hn::Set(du, (1u << (32 - Patch::kBits)) - 1));
                return hn::Mul(hn::ConvertTo(d, hn::BitCast(di, position)), hn::Set(d, Patch::kAcross * 0x1p-32f));
            };
            auto corner = hn::Zero(d), to_right = corner, downwards = corner, both = corner;
            hn::LoadInterleaved4(d, &found.patch[i].corner, corner, to_right, downwards, both);
            const auto right = within(rows.u), down = within(rows.v);
            mean = hn::Add(hn::Add(corner, hn::Mul(right, to_right)), hn::Mul(down, hn::Add(downwards, hn::Mul(right, both))));
        }
        mean = hn::Mul(mean, hn::Set(d, tables.even_mean));
        if (light == LightFactor::kTimesMean) return hn::StoreU(hn::Mul(weight, mean), d, light_factors + i);
        const auto over_mean = hn::IfThenElseZero(hn::Gt(weight, hn::Zero(d)), hn::Div(weight, mean));
        hn::StoreU(over_mean, d, light_factors + i);
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

LATENT_SIMD_EXPORT(FindPlaces);
LATENT_SIMD_EXPORT(Combine);
LATENT_SIMD_EXPORT(MovePositions);

// Tables are read one by one: instructions that gather are slower.
void weigh_rows(const LensTables& tables, const LensRows& rows, LightFactor light, std::span<float> weights,
                std::span<float> light_factors) {
    Found found;
    const Places& places = found.places;
    for (std::size_t begin = 0; begin < weights.size(); begin += Places::kAtOnce) {
        const std::size_t count = std::min(Places::kAtOnce, weights.size() - begin);
        const LensRows some = rows.from(begin);
        LATENT_SIMD_CALL(FindPlaces)(tables, some, count, found.places);
        if (tables.cells != nullptr) {
            for (std::size_t i = 0; i < count; ++i) found.cell[i] = tables.cells[places.cell[i]];
        }
        if (tables.shutter.open != nullptr) {
            for (std::size_t i = 0; i < count; ++i) std::copy_n(tables.shutter.open + places.step[i], 2, found.open[i]);
        }
        if (tables.patches != nullptr && light != LightFactor::kWeight) {
            for (std::size_t i = 0; i < count; ++i) found.patch[i] = tables.patches[places.patch[i]];
        }
        LATENT_SIMD_CALL(Combine)(tables, some, found, light, count, &weights[begin], &light_factors[begin]);
    }
}

void move_positions(const AxisMove& along_u, const AxisMove& along_v, int level, const std::uint8_t* x, const std::uint8_t* y,
                    std::uint32_t* u, std::uint32_t* v, std::span<std::uint32_t> cells) {
    LATENT_SIMD_CALL(MovePositions)(along_u, along_v, level, x, y, u, v, cells);
}

}  // namespace latent::develop
#endif
