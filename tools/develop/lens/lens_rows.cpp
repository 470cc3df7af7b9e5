#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/lens/lens_rows.cpp"
#include "tools/develop/lens/lens_rows.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Calls step(d, i) for rows i of a vector each, and for each of those that are left.
template <class Step>
HWY_INLINE void for_rows(std::size_t count, const Step& step) {
    const hn::ScalableTag<float> many;
    const hn::CappedTag<float, 1> one;
    std::size_t i = 0;
    for (; i + hn::Lanes(many) <= count; i += hn::Lanes(many)) step(many, i);
    for (; i < count; ++i) step(one, i);
}

template <class D>
using Signed = hn::RebindToSigned<D>;
template <class D>
using Unsigned = hn::RebindToUnsigned<D>;

template <class D>
HWY_INLINE hn::Vec<Signed<D>> lens_cells(D, const std::uint8_t* cells) {
    return hn::PromoteTo(Signed<D>{}, hn::LoadU(hn::Rebind<std::uint8_t, D>{}, cells));
}

// Positions that are below 2^31.
template <class D>
HWY_INLINE hn::Vec<D> as_float(D, hn::Vec<Unsigned<D>> position) {
    return hn::ConvertTo(D{}, hn::BitCast(Signed<D>{}, position));
}

void Transmissions(const float* cells, const LensRows& lens, std::span<float> out) {
    for_rows(out.size(), [&](auto d, std::size_t i) HWY_ATTR {
        static_assert(kLensCells == 1 << 8);
        const auto cell = hn::Add(hn::ShiftLeft<8>(lens_cells(d, lens.y + i)), lens_cells(d, lens.x + i));
        hn::StoreU(hn::GatherIndex(d, cells, cell), d, &out[i]);
    });
}

void PassRearRim(const RearRim& rim, const FilmRows& film, const LensRows& lens, std::span<float> out) {
    constexpr float kCell = 2.0f / kLensCells;
    constexpr int kLeftOut = 8;  // bits of positions: the others are exact as float
    for_rows(out.size(), [&](auto d, std::size_t i) HWY_ATTR {
        const Unsigned<decltype(d)> du;
        const auto from_rim = [&](const std::uint8_t* cells, const std::uint32_t* position, float middle, float per_film) HWY_ATTR {
            const auto on_lens = hn::Mul(hn::ConvertTo(d, lens_cells(d, cells + i)), hn::Set(d, kCell));
            const auto on_film = as_float(d, hn::ShiftRight<kLeftOut>(hn::LoadU(du, position + i)));
            return hn::Sub(hn::Add(on_lens, hn::Set(d, kCell / 2 - 1 - middle)), hn::Mul(on_film, hn::Set(d, per_film * 0x1p-24f)));
        };
        const auto x = from_rim(lens.x, film.u, rim.x, rim.per_u), y = from_rim(lens.y, film.v, rim.y, rim.per_v);
        // The edge counts as straight within a cell.
        const auto distance = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y))), one = hn::Set(d, 1.0f);
        const auto share = hn::Add(hn::Mul(hn::Sub(one, distance), hn::Set(d, 1 / kCell)), hn::Set(d, 0.5f));
        const auto within = hn::Min(hn::Max(share, hn::Zero(d)), one);
        hn::StoreU(hn::Mul(hn::LoadU(d, &out[i]), within), d, &out[i]);
    });
}

void OnPatches(const Patch* patches, const FilmRows& film, float factor, std::span<float> out) {
    constexpr int kBits = 32 - kPatchBits;
    constexpr std::uint32_t kWithin = (std::uint32_t{1} << kBits) - 1;
    for_rows(out.size(), [&](auto d, std::size_t i) HWY_ATTR {
        const Unsigned<decltype(d)> du;
        const auto u = hn::LoadU(du, film.u + i), v = hn::LoadU(du, film.v + i);
        const auto column = hn::ShiftRight<kBits>(u), row = hn::ShiftRight<kBits>(v);
        const auto patch = hn::BitCast(Signed<decltype(d)>{}, hn::Add(hn::ShiftLeft<kPatchBits>(row), column));
        const auto first = hn::ShiftLeft<2>(patch);  // of its four numbers
        const auto number = [&](int k) HWY_ATTR { return hn::GatherIndex(d, &patches->corner + k, first); };
        const auto within = [&](auto position) HWY_ATTR {
            return hn::Mul(as_float(d, hn::And(position, hn::Set(du, kWithin))), hn::Set(d, kPatches * 0x1p-32f));
        };
        const auto right = within(u), down = within(v);
        const auto below = hn::Add(number(2), hn::Mul(right, number(3)));
        const auto value = hn::Add(hn::Add(number(0), hn::Mul(right, number(1))), hn::Mul(down, below));
        hn::StoreU(hn::Mul(value, hn::Set(d, factor)), d, &out[i]);
    });
}

void MoveOnFilm(const std::array<LensMoves, 2>& moves, const LensRows& lens, int level, const PixelRect& wanted,
                std::span<std::uint32_t> u, std::uint32_t* v, std::uint32_t* cells) {
    const auto width = static_cast<std::uint32_t>(wanted.width()), height = static_cast<std::uint32_t>(wanted.height());
    for_rows(u.size(), [&](auto d, std::size_t i) HWY_ATTR {
        const Unsigned<decltype(d)> du;
        const Signed<decltype(d)> di;
        // The new position is high * 2^32 + low; its cell, one of 2^level along the film. Huge if it lies before `from`.
        const auto cell_along = [&](std::uint32_t* position, const LensMoves& moves_along, const std::uint8_t* lens_along,
                                    std::int64_t from) HWY_ATTR {
            const auto old = hn::LoadU(du, position + i);
            const auto move = hn::GatherIndex(di, moves_along.data(), lens_cells(d, lens_along + i));
            const auto low = hn::Add(old, hn::BitCast(du, hn::ShiftLeft<1>(move)));
            const auto carry = hn::VecFromMask(di, hn::RebindMask(di, hn::Lt(low, old)));  // -1 if there is one
            const auto high = hn::BitCast(du, hn::Sub(hn::ShiftRight<31>(move), carry));
            hn::StoreU(low, du, position + i);
            const auto within = hn::ShiftRightSame(hn::ShiftRight<1>(low), 31 - level);
            return hn::Sub(hn::Add(hn::ShiftLeftSame(high, level), within), hn::Set(du, static_cast<std::uint32_t>(from)));
        };
        const auto x = cell_along(u.data(), moves[0], lens.x, wanted.x0), y = cell_along(v, moves[1], lens.y, wanted.y0);
        const auto is_wanted = hn::And(hn::Lt(x, hn::Set(du, width)), hn::Lt(y, hn::Set(du, height)));
        const auto cell = hn::Add(hn::Mul(y, hn::Set(du, width)), x);
        hn::StoreU(hn::IfThenElse(is_wanted, cell, hn::Set(du, width * height)), du, cells + i);
    });
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(Transmissions);
LATENT_SIMD_EXPORT(PassRearRim);
LATENT_SIMD_EXPORT(OnPatches);
LATENT_SIMD_EXPORT(MoveOnFilm);

void transmissions(const float* cells, const LensRows& lens, std::span<float> out) {
    LATENT_SIMD_CALL(Transmissions)(cells, lens, out);
}

void pass_rear_rim(const RearRim& rim, const FilmRows& film, const LensRows& lens, std::span<float> out) {
    LATENT_SIMD_CALL(PassRearRim)(rim, film, lens, out);
}

void on_patches(const Patch* patches, const FilmRows& film, float factor, std::span<float> out) {
    LATENT_SIMD_CALL(OnPatches)(patches, film, factor, out);
}

void move_on_film(const std::array<LensMoves, 2>& moves, const LensRows& lens, int level, const PixelRect& wanted,
                  std::span<std::uint32_t> u, std::uint32_t* v, std::uint32_t* cells) {
    LATENT_SIMD_CALL(MoveOnFilm)(moves, lens, level, wanted, u, v, cells);
}

}  // namespace latent::develop
#endif
