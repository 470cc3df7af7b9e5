#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/kernel/scatter.cpp"
#include "tools/develop/kernel/scatter.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>

#ifndef LATENT_DEVELOP_SCATTER
#define LATENT_DEVELOP_SCATTER
namespace latent::develop {
namespace {

// Rows are left out without a branch, which would be mispredicted where every second one is. kStride: if it is known; else 0.

template <std::size_t kStride>
bool is_zero(const float* row, std::size_t stride) {
    if constexpr (kStride == 4) {
        std::array<std::uint64_t, 2> bits;
        std::memcpy(bits.data(), row, sizeof bits);
        return ((bits[0] | bits[1]) & 0x7FFFFFFF7FFFFFFF) == 0;  // whatever the signs
    }
    return std::all_of(row, row + stride, [](float value) { return value == 0; });
}

template <std::size_t kStride, bool kDropsZeros>
void scatter_rows(const ScatteredRows& rows, std::span<CellSpace> cells) {
    const std::size_t stride = kStride > 0 ? kStride : rows.stride;
    CellSpace* const spaces = cells.data();
    const std::size_t left_out = cells.size() - 1;
    const float* row = rows.values;
    for (std::size_t i = 0; i < rows.cells.size(); ++i, row += stride) {
        assert(rows.cells[i] <= left_out);
        CellSpace& to = spaces[kDropsZeros && is_zero<kStride>(row, stride) ? left_out : rows.cells[i]];
        const std::uint32_t place = to.kept++;
        const auto [x, y, values] = to.columns;
        x[place] = rows.u[i], y[place] = rows.v[i];
        std::copy_n(row, stride, values + place * stride);
    }
    spaces[left_out].kept = 0;
}

}  // namespace
}  // namespace latent::develop
#endif

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET <= HWY_AVX3

// The rows from i on, as many as there are lanes, of four values each.
template <class D>
HWY_INLINE void ScatterSome(D d, const ScatteredRows& rows, std::size_t i, bool drops_zeros, std::span<CellSpace> spaces) {
    const hn::Repartition<float, D> df;
    const auto bits_of = [&](auto mask) HWY_ATTR {
        std::uint64_t bits = 0;
        hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
        return bits;
    };
    const auto cells = hn::LoadU(d, &rows.cells[i]), u = hn::LoadU(d, rows.u + i), v = hn::LoadU(d, rows.v + i);
    auto v0 = hn::Zero(df), v1 = v0, v2 = v0, v3 = v0;
    hn::LoadInterleaved4(df, rows.values + 4 * i, v0, v1, v2, v3);
    auto stays = hn::Lt(cells, hn::Set(d, static_cast<std::uint32_t>(spaces.size() - 1)));
    if (drops_zeros) {
        const auto any = hn::BitCast(d, hn::Or(hn::Or(v0, v1), hn::Or(v2, v3)));
        stays = hn::And(stays, hn::Ne(hn::Add(any, any), hn::Zero(d)));  // whatever the signs
    }
    for (std::uint64_t left = bits_of(stays); left != 0;) {  // all rows of the next cell at once
        const std::uint32_t cell = rows.cells[i + static_cast<std::size_t>(std::countr_zero(left))];
        const auto here = hn::And(stays, hn::Eq(cells, hn::Set(d, cell)));
        std::uint64_t bits = bits_of(here);
        left ^= bits;
        CellSpace& to = spaces[cell];
        std::size_t place = to.kept;
        to.kept += static_cast<std::uint32_t>(std::popcount(bits));
        if (place + hn::Lanes(d) <= to.room) {  // what is stored behind these rows is overwritten by later ones
            const auto values_here = hn::MaskFromVec(hn::BitCast(df, hn::VecFromMask(d, here)));
            const auto of = [&](auto values) HWY_ATTR { return hn::Compress(values, values_here); };
            hn::StoreU(hn::Compress(u, here), d, to.columns.x + place);
            hn::StoreU(hn::Compress(v, here), d, to.columns.y + place);
            hn::StoreInterleaved4(of(v0), of(v1), of(v2), of(v3), df, to.columns.values + 4 * place);
            continue;
        }
        for (; bits != 0; bits &= bits - 1, ++place) {
            const std::size_t row = i + static_cast<std::size_t>(std::countr_zero(bits));
            to.columns.x[place] = rows.u[row], to.columns.y[place] = rows.v[row];
            std::copy_n(rows.values + 4 * row, 4, to.columns.values + 4 * place);
        }
    }
}

// Vectors are worth it where one instruction compresses them.
void Scatter(const ScatteredRows& rows, bool drops_zeros, std::span<CellSpace> cells) {
    const hn::ScalableTag<std::uint32_t> d;
    const hn::CappedTag<std::uint32_t, 1> one;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= rows.cells.size(); i += hn::Lanes(d)) ScatterSome(d, rows, i, drops_zeros, cells);
    for (; i < rows.cells.size(); ++i) ScatterSome(one, rows, i, drops_zeros, cells);
}

#else

void Scatter(const ScatteredRows& rows, bool drops_zeros, std::span<CellSpace> cells) {
    drops_zeros ? scatter_rows<4, true>(rows, cells) : scatter_rows<4, false>(rows, cells);
}

#endif

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(Scatter);

namespace {

template <std::size_t kStride>
std::uint32_t drop_zeros_of(const SegmentColumns& columns, std::uint32_t count, std::size_t run_stride) {
    const std::size_t stride = kStride > 0 ? kStride : run_stride;
    const auto [x, y, values] = columns;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float* const row = values + i * stride;
        const bool stays = !is_zero<kStride>(row, stride);
        x[kept] = x[i], y[kept] = y[i];
        std::copy_n(row, stride, values + kept * stride);
        kept += stays ? 1 : 0;
    }
    return kept;
}

}  // namespace

void scatter(const ScatteredRows& rows, bool drops_zeros, std::span<CellSpace> cells) {
    if (rows.stride == 4) return LATENT_SIMD_CALL(Scatter)(rows, drops_zeros, cells);
    drops_zeros ? scatter_rows<0, true>(rows, cells) : scatter_rows<0, false>(rows, cells);
}

std::uint32_t drop_zeros(const SegmentColumns& columns, std::uint32_t count, std::size_t stride) {
    return stride == 4 ? drop_zeros_of<4>(columns, count, stride) : drop_zeros_of<0>(columns, count, stride);
}

}  // namespace latent::develop
#endif
