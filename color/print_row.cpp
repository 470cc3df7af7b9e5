#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/print_row.cpp"  // compiled once per instruction set by foreach_target.h
#include "color/print_row.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "color/luminance_vector-inl.h"

// Mul and Add only, no fused or approximate operation: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::color::HWY_NAMESPACE {
namespace {

HWY_INLINE V clamp01(V v) { return hn::Min(hn::Max(v, constant(0)), constant(1)); }
HWY_INLINE V dot(const float* row, V a, V b, V c) {
    return hn::Add(hn::Add(hn::Mul(constant(row[0]), a), hn::Mul(constant(row[1]), b)), hn::Mul(constant(row[2]), c));
}

// y' = 1 - 2^(-sigma y) and y' / y, for y > 0.
//   sigma y = n + f, |f| <= 1/2:  y' = (1 - 2^-n) + 2^-n f P(f),  P(f) = (1 - 2^-f) / f = ln2 - ln2^2 f / 2! + ln2^3 f^2 / 3! - ...
// so for small y both keep their relative precision: y' / y = sigma P.
struct Film {
    V printed, over_y;
};
HWY_INLINE Film film(V sigma, V y) {
    constexpr float kTaylor[] = {0.69314718056F,    -0.240226506959F,    0.0555041086648F,   -0.00961812910763F,
                                 0.00133335581464F, -0.000154035303934F, 0.0000152527338041F};  // the next term is below 1.1e-8
    const V t = hn::Min(hn::Mul(sigma, y), constant(126));
    const V n = hn::Round(t), f = hn::Sub(t, n);
    V p = constant(kTaylor[6]);
    for (int i = 5; i >= 0; --i) p = hn::Add(hn::Mul(p, f), constant(kTaylor[i]));
    const hn::Rebind<std::int32_t, D> integer;
    const V power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Sub(hn::Set(integer, 127), hn::ConvertTo(integer, n))));  // 2^-n
    const V printed = hn::Add(hn::Sub(constant(1), power), hn::Mul(power, hn::Mul(f, p)));
    return {printed, hn::IfThenElse(hn::Eq(n, constant(0)), hn::Mul(sigma, p), hn::Div(printed, y))};
}

// y' of exposure t by ToneCurve::table.
HWY_INLINE V tabulated(const float* table, V t) {
    constexpr int kMantissaBits = 23 - ToneCurve::kStepBits;  // between two entries
    const hn::Rebind<std::int32_t, D> integer;
    const V first = constant(std::ldexp(1.0F, ToneCurve::kFirstOctave));
    const V last = constant(std::ldexp(1.0F, ToneCurve::kFirstOctave + ToneCurve::kOctaves));
    const V inside = hn::IfThenElse(hn::Gt(t, first), hn::Min(t, last), first);  // NaN too
    const auto bits = hn::Sub(hn::BitCast(integer, inside), hn::BitCast(integer, first));
    const auto index = hn::ShiftRight<kMantissaBits>(bits);
    const V part =
        hn::Mul(hn::ConvertTo(d, hn::And(bits, hn::Set(integer, (1 << kMantissaBits) - 1))), constant(1.0F / (1 << kMantissaBits)));
    const V from = hn::GatherIndex(d, table, index), to = hn::GatherIndex(d, table + 1, index);
    return clamp01(hn::Mul(hn::Add(from, hn::Mul(part, hn::Sub(to, from))), hn::Min(hn::Div(t, first), constant(1))));
}

// Largest t <= 1 that keeps y' + t (v - y') inside [0,1].
HWY_INLINE V steps_to_border(V v, V printed) {
    const V grey_distance = hn::Sub(v, printed);
    const V above = hn::Div(hn::Sub(constant(1), printed), grey_distance);
    const V below = hn::Neg(hn::Div(printed, grey_distance));
    const V t = hn::IfThenElse(hn::Gt(v, constant(1)), above, constant(1));
    return hn::IfThenElse(hn::Lt(v, constant(0)), below, t);
}

struct Counts {
    std::size_t nan = 0, negative = 0, infinite = 0, colourless = 0, out_of_gamut = 0, black = 0, burnt = 0;
};

struct RgbV {
    V r, g, b;
};
struct Printed {
    RgbV rgb;
    V luminance;
};

template <Tone kTone, Gamut kGamut>
HWY_INLINE Printed print_vector(const PrintRowConstants& c, V x, V y_given, V z, Counts& counts) {
    const V zero = constant(0), one = constant(1), huge = constant(1e30F), sigma = constant(c.sigma);
    const Mask coloured = hn::And(finite(x), finite(z));
    const Mask adaptable = hn::And(coloured, finite(y_given));
    V y = y_given;
    if (c.adapted) y = hn::IfThenElse(adaptable, adapted_luminance(c.y_row, x, y_given, z), y_given);

    counts.black += hn::CountTrue(d, hn::Lt(y, constant(c.range.black)));
    counts.burnt += hn::CountTrue(d, hn::Gt(y, constant(c.range.burnt)));

    // The rare ones. A lane is lit if it has a printed value at all; the others are black.
    const Mask white = hn::Eq(y, constant(std::numeric_limits<float>::infinity()));
    const Mask positive = hn::Gt(y, zero);
    const Mask lit = kTone != Tone::kNone ? positive : hn::Or(positive, adaptable);
    const Mask grey = hn::And(hn::AndNot(white, lit), hn::Not(coloured));
    if (HWY_UNLIKELY(!hn::AllTrue(d, hn::And(positive, adaptable)))) {
        counts.nan += hn::CountTrue(d, hn::Not(hn::Eq(y, y)));  // Ne is false for NaN with AVX-512
        counts.negative += hn::CountTrue(d, hn::AndNot(lit, hn::Lt(y, zero)));
        counts.infinite += hn::CountTrue(d, hn::AndNot(adaptable, white));  // not what adaptation only brought beyond the floats
        counts.colourless += hn::CountTrue(d, grey);
    }

    V printed, scale;
    if constexpr (kTone == Tone::kFilm) {
        const Film f = film(sigma, y);
        printed = f.printed;
        scale = f.over_y;
    } else if constexpr (kTone == Tone::kCurve) {
        printed = tabulated(c.curve, hn::Mul(sigma, y));
        scale = hn::Div(printed, y);
    } else {
        printed = hn::Mul(sigma, y);
        scale = sigma;
    }
    const auto scaled = [&](V v) { return hn::Min(hn::Max(hn::Mul(v, scale), hn::Neg(huge)), huge); };
    const V xs = scaled(x), ys = scaled(c.adapted ? y_given : y), zs = scaled(z);
    RgbV rgb{dot(&c.rgb_from_xyz[0], xs, ys, zs), dot(&c.rgb_from_xyz[3], xs, ys, zs), dot(&c.rgb_from_xyz[6], xs, ys, zs)};

    const Mask coloured_and_lit = hn::AndNot(white, hn::And(lit, coloured));
    const V margin = constant(static_cast<float>(kGamutMargin));
    const Mask outside = hn::Or(hn::Lt(hn::Min(hn::Min(rgb.r, rgb.g), rgb.b), hn::Neg(margin)),
                                hn::Gt(hn::Max(hn::Max(rgb.r, rgb.g), rgb.b), hn::Add(one, margin)));
    counts.out_of_gamut += hn::CountTrue(d, hn::And(outside, coloured_and_lit));

    if constexpr (kTone != Tone::kNone) {
        if constexpr (kGamut == Gamut::kGrey) {
            const V t =
                hn::Min(hn::Min(steps_to_border(rgb.r, printed), steps_to_border(rgb.g, printed)), steps_to_border(rgb.b, printed));
            const auto moved = [&](V v) { return hn::Add(printed, hn::Mul(t, hn::Sub(v, printed))); };
            rgb = {moved(rgb.r), moved(rgb.g), moved(rgb.b)};
        }
        rgb = {clamp01(rgb.r), clamp01(rgb.g), clamp01(rgb.b)};
        if constexpr (kGamut != Gamut::kClip) {
            const V present = dot(c.luminance_row.data(), rgb.r, rgb.g, rgb.b), difference = hn::Sub(printed, present);
            const Mask too_dark = hn::Gt(difference, zero);
            // Down: v y' / present. Up: v + (1 - v) d / (1 - present). One division serves both; 0/0 is only met where nothing is
            // to do.
            const V ratio =
                hn::Div(hn::IfThenElse(too_dark, difference, printed), hn::IfThenElse(too_dark, hn::Sub(one, present), present));
            const Mask exact = hn::Eq(difference, zero);
            const auto restored = [&](V v) {
                const V up = hn::Add(v, hn::Mul(hn::Sub(one, v), ratio)), down = hn::Mul(v, ratio);
                return hn::IfThenElse(exact, v, clamp01(hn::IfThenElse(too_dark, up, down)));
            };
            rgb = {restored(rgb.r), restored(rgb.g), restored(rgb.b)};
        }
    }
    const auto final = [&](V v) {
        const V without_colour = hn::IfThenElse(white, one, hn::IfThenElseZero(grey, printed));
        return hn::IfThenElse(coloured_and_lit, v, without_colour);
    };
    return {{final(rgb.r), final(rgb.g), final(rgb.b)}, y};
}

template <Tone kTone, Gamut kGamut>
void print_all(const PrintRowConstants& c, const float* x, const float* y, const float* z, float* r, float* g, float* b,
               std::size_t count, PrintReport& report) {
    Counts counts;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        const auto [rgb, luminance] =
            print_vector<kTone, kGamut>(c, hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i), counts);
        hn::StoreU(rgb.r, d, r + i);
        hn::StoreU(rgb.g, d, g + i);
        hn::StoreU(rgb.b, d, b + i);
        if (c.luminances != nullptr) hn::StoreU(luminance, d, c.luminances + i);
    }
    if (i < count) {  // the rest, beside black pixels
        std::array<std::array<float, HWY_MAX_BYTES / sizeof(float)>, 3> rest{};
        std::copy(x + i, x + count, rest[0].begin());
        std::copy(y + i, y + count, rest[1].begin());
        std::copy(z + i, z + count, rest[2].begin());
        const auto [rgb, luminance] = print_vector<kTone, kGamut>(c, hn::LoadU(d, rest[0].data()), hn::LoadU(d, rest[1].data()),
                                                                  hn::LoadU(d, rest[2].data()), counts);
        hn::StoreU(rgb.r, d, rest[0].data());
        hn::StoreU(rgb.g, d, rest[1].data());
        hn::StoreU(rgb.b, d, rest[2].data());
        std::copy_n(rest[0].begin(), count - i, r + i);
        std::copy_n(rest[1].begin(), count - i, g + i);
        std::copy_n(rest[2].begin(), count - i, b + i);
        if (c.luminances != nullptr) {
            hn::StoreU(luminance, d, rest[0].data());
            std::copy_n(rest[0].begin(), count - i, c.luminances + i);
        }
        if (c.range.black > 0) counts.black -= i + lanes - count;
    }
    report += {.pixels = count,
               .nan = counts.nan,
               .negative = counts.negative,
               .infinite = counts.infinite,
               .colourless = counts.colourless,
               .out_of_gamut = counts.out_of_gamut,
               .clipped = kTone != Tone::kNone && kGamut == Gamut::kClip ? counts.out_of_gamut : 0,
               .black = counts.black,
               .burnt = counts.burnt};
}

template <Tone kTone>
void print_by_gamut(const PrintRowConstants& c, const float* x, const float* y, const float* z, float* r, float* g, float* b,
                    std::size_t count, PrintReport& report) {
    switch (c.gamut) {
        case Gamut::kLuminance:
            return print_all<kTone, Gamut::kLuminance>(c, x, y, z, r, g, b, count, report);
        case Gamut::kGrey:
            return print_all<kTone, Gamut::kGrey>(c, x, y, z, r, g, b, count, report);
        case Gamut::kClip:
            return print_all<kTone, Gamut::kClip>(c, x, y, z, r, g, b, count, report);
    }
}

void print_row_of_target(const PrintRowConstants& c, const float* x, const float* y, const float* z, float* r, float* g, float* b,
                         std::size_t count, PrintReport& report) {
    switch (c.tone) {
        case Tone::kFilm:
            return print_by_gamut<Tone::kFilm>(c, x, y, z, r, g, b, count, report);
        case Tone::kCurve:
            return print_by_gamut<Tone::kCurve>(c, x, y, z, r, g, b, count, report);
        case Tone::kNone:
            return print_all<Tone::kNone, Gamut::kClip>(c, x, y, z, r, g, b, count, report);
    }
}

}  // namespace
}  // namespace latent::color::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::color {

LATENT_SIMD_EXPORT(print_row_of_target);

void print_row(const PrintRowConstants& constants, const float* x, const float* y, const float* z, float* r, float* g, float* b,
               std::size_t count, PrintReport& report) {
    LATENT_SIMD_CALL(print_row_of_target)(constants, x, y, z, r, g, b, count, report);
}

}  // namespace latent::color
#endif
