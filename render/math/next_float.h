// render/math/next_float.h: the floats beside a float, without a call.
#pragma once

#include <bit>
#include <cstdint>

namespace latent::render {

// The next float above a number that is below infinity; anything else as it is. std::nextafter(x, infinity).
inline float next_up(float x) {
    if (!(x <= 0x1.fffffep127f)) return x;
    const auto bits = std::bit_cast<std::uint32_t>(x + 0.0f);  // -0 as +0
    return std::bit_cast<float>(x < 0 ? bits - 1 : bits + 1);
}
inline float next_down(float x) { return -next_up(-x); }

}  // namespace latent::render
