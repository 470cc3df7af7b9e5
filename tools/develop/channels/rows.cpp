#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/channels/rows.cpp"
#include "tools/develop/channels/rows.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void PlaceRows(const FilmGrid::Place& place, std::span<const std::uint32_t> positions, std::uint32_t* places) {
    const hn::ScalableTag<std::uint32_t> d;
    const hn::RepartitionToWide<decltype(d)> dw;
    const auto pixels = hn::Set(d, place.pixels), origin = hn::Set(d, place.origin);
    const auto half = hn::Set(dw, 0x80000000u);
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= positions.size(); i += hn::Lanes(d)) {  // every second one at a time: products have 64 bits
        const auto position = hn::LoadU(d, &positions[i]);
        const auto odd_position = hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(dw, position)));
        const auto even = hn::ShiftRight<8>(hn::Add(hn::MulEven(position, pixels), half));
        const auto odd = hn::ShiftLeft<24>(hn::Add(hn::MulEven(odd_position, pixels), half));
        hn::StoreU(hn::Sub(hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, even)), origin), d, places + i);
    }
    for (; i < positions.size(); ++i) places[i] = place(positions[i]);
}

bool InterleaveRows(std::span<const float> x, const float* y, const float* z, float share, const RowFactors& factors, float* rows) {
    const hn::ScalableTag<float> d;
    const auto zero = hn::Zero(d), all_shares = hn::Set(d, share);
    auto check = zero;  // times zero: 0 if finite, else NaN
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= x.size(); i += hn::Lanes(d)) {
        auto a = hn::LoadU(d, &x[i]), b = hn::LoadU(d, y + i), c = hn::LoadU(d, z + i);
        auto shares = all_shares;
        if (factors.value != nullptr) {
            const auto factor = hn::LoadU(d, factors.value + i);
            a = hn::Mul(a, factor), b = hn::Mul(b, factor), c = hn::Mul(c, factor);
            shares = hn::Mul(shares, hn::LoadU(d, factors.share + i));
        }
        check = hn::Add(check, hn::Add(hn::Mul(a, zero), hn::Add(hn::Mul(b, zero), hn::Mul(c, zero))));
        hn::StoreInterleaved4(a, b, c, shares, d, rows + 4 * i);
    }
    float rest = 0;
    for (; i < x.size(); ++i) {
        const float factor = factors.value != nullptr ? factors.value[i] : 1;
        float* const row = rows + 4 * i;
        row[0] = x[i] * factor, row[1] = y[i] * factor, row[2] = z[i] * factor;
        rest += row[0] * 0.0f + row[1] * 0.0f + row[2] * 0.0f;
        row[3] = share * (factors.share != nullptr ? factors.share[i] : 1);
    }
    return hn::AllTrue(d, hn::Eq(check, zero)) && rest == 0;
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(PlaceRows);
LATENT_SIMD_EXPORT(InterleaveRows);

void place_rows(const FilmGrid::Place& place, std::span<const std::uint32_t> positions, std::uint32_t* places) {
    LATENT_SIMD_CALL(PlaceRows)(place, positions, places);
}

bool interleave_rows(std::span<const float> x, const float* y, const float* z, float share, const RowFactors& factors,
                     float* rows) {
    return LATENT_SIMD_CALL(InterleaveRows)(x, y, z, share, factors, rows);
}

}  // namespace latent::develop
#endif
