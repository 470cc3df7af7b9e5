// color/quantise.h: from linear RGB planes to interleaved code values of 8 or 16 bits. Equations: docs/color.md, "Code values".
#pragma once

#include <cstdint>
#include <span>

#include "color/transfer.h"

namespace latent::color {

// What rounds code values: advised for 8 bits, needless for 16.
enum class Dither : std::uint8_t {
    kNone,
    kRandom,      // noise of one code, least where a value is a code
    kTriangular,  // noise of two codes, the same everywhere
    kBlue,        // a pattern of one code without low frequencies (color/blue_noise.h)
};

// code = floor(encode(v) (2^bits - 1) + h), v clamped to [0,1] (NaN: 0). Without dither h = 1/2; with dither h depends on (x, row,
// channel, seed), so crops, strips and threads give the same bytes, the mean over h is exact, and 0 and 1 stay pure.
struct Quantiser {
    Transfer transfer;
    Dither dither = Dither::kRandom;
    std::uint32_t seed = 0;

    // `out` holds 3 code values per pixel, r g b; the first pixel is (x0, row) of the whole picture. Same bits on every processor.
    void to_8_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                   std::uint32_t row, std::span<std::uint8_t> out) const;
    void to_16_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                    std::uint32_t row, std::span<std::uint16_t> out) const;
};

// h of one code value with Dither::kRandom: (k + 1/2) / 1024, k = 0..1023; channel 0..2.
float dither_value(std::uint32_t x, std::uint32_t row, std::uint32_t channel, std::uint32_t seed);

}  // namespace latent::color
