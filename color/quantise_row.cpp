#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/quantise_row.cpp"  // compiled once per instruction set by foreach_target.h
#include "color/quantise_row.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <limits>

#include "color/blue_noise.h"
#include "color/power_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latent::color::HWY_NAMESPACE {
namespace {

constexpr hn::Rebind<std::uint32_t, D> du;
using U = hn::Vec<hn::Rebind<std::uint32_t, D>>;

// Transfer::encode on [0,1]; NaN and negative values encode to 0.
HWY_INLINE V encode(const Transfer& t, V v) {
    const V x = hn::IfThenElseZero(hn::Gt(v, constant(0)), hn::Min(v, constant(1)));
    if (t.is_linear()) return x;
    const V power =
        exp2(hn::Max(hn::Mul(constant(static_cast<float>(t.exponent)), log2(hn::Max(x, constant(1.2e-38F)))), constant(-126)));
    const V curved = hn::Sub(hn::Mul(constant(static_cast<float>(t.scale)), power), constant(static_cast<float>(t.scale - 1)));
    const V straight = hn::Mul(constant(static_cast<float>(t.slope)), x);
    const V encoded = hn::IfThenElse(hn::Lt(x, constant(static_cast<float>(t.linear_below))), straight, curved);
    return hn::IfThenElse(hn::Eq(x, constant(1)), constant(1), hn::IfThenElseZero(hn::Gt(x, constant(0)), encoded));
}

// mixed_bits of every lane.
HWY_INLINE U mixed(U hash) {
    hash = hn::Mul(hn::Xor(hash, hn::ShiftRight<16>(hash)), hn::Set(du, 0x85EBCA6BU));
    hash = hn::Mul(hn::Xor(hash, hn::ShiftRight<13>(hash)), hn::Set(du, 0xC2B2AE35U));
    return hn::Xor(hash, hn::ShiftRight<16>(hash));
}

// (k + 1/2) / 1024 of the lowest 10 bits.
HWY_INLINE V fraction(U hash) {
    const V field = hn::ConvertTo(d, hn::BitCast(di, hn::And(hash, hn::Set(du, 1023U))));
    return hn::Mul(hn::Add(field, constant(0.5F)), constant(1.0F / 1024));
}

// What is added to values 0..most before they are rounded down.
template <Dither kDither, std::size_t kChannel>
HWY_INLINE V dither_of(const QuantiseRowConstants& c, V level, float most, std::uint32_t x0, U hash, U second) {
    if constexpr (kDither == Dither::kNone) return constant(0.5F);
    if constexpr (kDither == Dither::kBlue) return hn::LoadU(d, c.blue_rows[kChannel] + (x0 + c.blue_x[kChannel]) % kBlueNoiseSize);
    const V h = fraction(hn::ShiftRight<10 * kChannel>(hash));
    if constexpr (kDither == Dither::kRandom) return h;
    // Noise two codes wide, except half a code from the ends, where it would be cut off and change the mean.
    const V both = hn::Sub(hn::Add(h, fraction(hn::ShiftRight<10 * kChannel>(second))), constant(0.5F));
    return hn::IfThenElse(hn::And(hn::Ge(level, constant(0.5F)), hn::Le(level, constant(most - 0.5F))), both, h);
}

template <Dither kDither, std::size_t kChannel, class Code>
HWY_INLINE hn::Vec<hn::Rebind<Code, D>> code_of(const QuantiseRowConstants& c, V v, std::uint32_t x0, U hash, U second) {
    constexpr float kMaxCode = std::numeric_limits<Code>::max();
    const V level = hn::Mul(encode(c.transfer, v), constant(kMaxCode));
    const V sum = hn::Min(hn::Add(level, dither_of<kDither, kChannel>(c, level, kMaxCode, x0, hash, second)), constant(kMaxCode));
    return hn::DemoteTo(hn::Rebind<Code, D>(), hn::ConvertTo(di, hn::Floor(sum)));
}

template <Dither kDither, class Code>
HWY_INLINE void quantise_vector(const QuantiseRowConstants& c, V r, V g, V b, std::uint32_t x0, Code* out) {
    U hash = hn::Zero(du), second = hash;
    if constexpr (kDither == Dither::kRandom || kDither == Dither::kTriangular)
        hash = mixed(hn::Xor(hn::Mul(hn::Iota(du, x0), hn::Set(du, kPixelStep)), hn::Set(du, c.row_key)));
    if constexpr (kDither == Dither::kTriangular) second = mixed(hn::Add(hash, hn::Set(du, kPixelStep)));
    hn::StoreInterleaved3(code_of<kDither, 0, Code>(c, r, x0, hash, second), code_of<kDither, 1, Code>(c, g, x0, hash, second),
                          code_of<kDither, 2, Code>(c, b, x0, hash, second), hn::Rebind<Code, D>(), out);
}

template <Dither kDither, class Code>
void quantise_with(const QuantiseRowConstants& c, const float* r, const float* g, const float* b, std::uint32_t x0,
                   std::size_t count, Code* out) {
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        quantise_vector<kDither>(c, hn::LoadU(d, r + i), hn::LoadU(d, g + i), hn::LoadU(d, b + i),
                                 x0 + static_cast<std::uint32_t>(i), out + 3 * i);
    }
    if (i < count) {
        std::array<std::array<float, HWY_MAX_BYTES / sizeof(float)>, 3> rest{};
        std::array<Code, 3 * HWY_MAX_BYTES / sizeof(float)> rest_out;
        std::copy(r + i, r + count, rest[0].begin());
        std::copy(g + i, g + count, rest[1].begin());
        std::copy(b + i, b + count, rest[2].begin());
        quantise_vector<kDither>(c, hn::LoadU(d, rest[0].data()), hn::LoadU(d, rest[1].data()), hn::LoadU(d, rest[2].data()),
                                 x0 + static_cast<std::uint32_t>(i), rest_out.data());
        std::copy_n(rest_out.begin(), 3 * (count - i), out + 3 * i);
    }
}

template <class Code>
void quantise_all(const QuantiseRowConstants& c, const float* r, const float* g, const float* b, std::uint32_t x0,
                  std::size_t count, Code* out) {
    switch (c.dither) {
        case Dither::kNone:
            return quantise_with<Dither::kNone>(c, r, g, b, x0, count, out);
        case Dither::kRandom:
            return quantise_with<Dither::kRandom>(c, r, g, b, x0, count, out);
        case Dither::kTriangular:
            return quantise_with<Dither::kTriangular>(c, r, g, b, x0, count, out);
        case Dither::kBlue:
            return quantise_with<Dither::kBlue>(c, r, g, b, x0, count, out);
    }
}

void quantise_row_8_of_target(const QuantiseRowConstants& c, const float* r, const float* g, const float* b, std::uint32_t x0,
                              std::size_t count, std::uint8_t* out) {
    quantise_all(c, r, g, b, x0, count, out);
}
void quantise_row_16_of_target(const QuantiseRowConstants& c, const float* r, const float* g, const float* b, std::uint32_t x0,
                               std::size_t count, std::uint16_t* out) {
    quantise_all(c, r, g, b, x0, count, out);
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::color {

LATENT_SIMD_EXPORT(quantise_row_8_of_target);
LATENT_SIMD_EXPORT(quantise_row_16_of_target);

void quantise_row_8(const QuantiseRowConstants& constants, const float* r, const float* g, const float* b, std::uint32_t x0,
                    std::size_t count, std::uint8_t* out) {
    LATENT_SIMD_CALL(quantise_row_8_of_target)(constants, r, g, b, x0, count, out);
}
void quantise_row_16(const QuantiseRowConstants& constants, const float* r, const float* g, const float* b, std::uint32_t x0,
                     std::size_t count, std::uint16_t* out) {
    LATENT_SIMD_CALL(quantise_row_16_of_target)(constants, r, g, b, x0, count, out);
}

}  // namespace latent::color
#endif
