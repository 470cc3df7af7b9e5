// render/math/elementary.h: exp, log, sine, cosine and arctangent to about one unit in the last place of a float. Plain arithmetic
// without branches: loops over wavelengths vectorise, and a processor's choice of libm cannot change a record.
#pragma once

#include <bit>
#include <cstdint>

namespace latent::render {

// e^x for x <= 0; below -87 it is the smallest normal float or so.
inline float exp_nonpositive(float x) {
    const float clamped = x < -87.0f ? -87.0f : x;
    const std::int32_t n =
        static_cast<std::int32_t>(clamped * 1.44269504f - 0.5f);  // rounds to nearest, as the product is not positive
    const float nf = static_cast<float>(n);
    const float r = (clamped - nf * 0.693359375f) + nf * 2.12194440e-4f;  // ln 2 in two pieces
    const float tail = 1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r * (1.0f / 5040))));
    const float p = 1.0f + (r + r * r * (0.5f + r * tail));
    return p * std::bit_cast<float>((n + 127) << 23);
}

// ln x for normal positive x: x = 2^e m with m in [sqrt(1/2), sqrt(2)), ln m = 2 artanh((m - 1) / (m + 1)).
inline float log_positive(float x) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
    const std::int32_t e = static_cast<std::int32_t>(bits - 0x3f3504f3u) >> 23;
    const float m = std::bit_cast<float>(bits - (static_cast<std::uint32_t>(e) << 23));
    const float s = (m - 1) / (m + 1), s2 = s * s;
    const float p = 2 * s * (1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9)))));
    return static_cast<float>(e) * 0.693147181f + p;
}

// ln (1 - u), 0 <= u < 1: near 0 as exact as u is.
inline float log_one_minus(float u) {
    if (u > 0.25f) return log_positive(1 - u);
    const float s = u / (2 - u), s2 = s * s;
    return -2 * s * (1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9)))));
}

struct SinCos {
    float sin, cos;
};

// Sine and cosine of 2 pi u, |u| < 2^20.
inline SinCos sincos_turns(float u) {
    const float quarters = u * 4;
    const std::int32_t q = static_cast<std::int32_t>(quarters + (quarters < 0 ? -0.5f : 0.5f));
    const float r = (quarters - static_cast<float>(q)) * 1.57079632679f, r2 = r * r;
    const float s = r * (1 + r2 * (-1.0f / 6 + r2 * (1.0f / 120 + r2 * (-1.0f / 5040 + r2 * (1.0f / 362880)))));
    const float c = 1 + r2 * (-0.5f + r2 * (1.0f / 24 + r2 * (-1.0f / 720 + r2 * (1.0f / 40320))));
    const float sine = (q & 1) ? c : s, cosine = (q & 1) ? s : c;
    return {(q & 2) ? -sine : sine, ((q + 1) & 2) ? -cosine : cosine};
}

// The angle of (x, y), y >= 0, from the x axis: 0 to 1/2 turns. The series of arctan r, |r| < tan(pi / 8).
inline float angle_in_turns(float x, float y) {
    const float a = x < 0 ? -x : x;
    const float s = a < y ? a / y : y / a;
    const bool upper = s > 0.414213562f;
    const float r = upper ? (s - 1) / (s + 1) : s, r2 = r * r;
    const float tail = 1.0f / 9 - r2 * (1.0f / 11 - r2 * (1.0f / 13 - r2 * (1.0f / 15)));
    const float angle = r * (1 - r2 * (1.0f / 3 - r2 * (1.0f / 5 - r2 * (1.0f / 7 - r2 * tail))));
    const float of_octant = angle * 0.159154943f + (upper ? 0.125f : 0);
    const float of_quarter = a < y ? 0.25f - of_octant : of_octant;
    return x < 0 ? 0.5f - of_quarter : of_quarter;
}

}  // namespace latent::render
