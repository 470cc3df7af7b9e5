// color/quantise_row.h: the quantiser's inner loop, one source for every vector width. Only color/quantise.cpp calls it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "color/quantise.h"

namespace latent::color {

struct QuantiseRowConstants {
    Transfer transfer;
    Dither dither;
    std::uint32_t row_key;                    // hash of row and seed
    std::array<const float*, 3> blue_rows{};  // BlueNoiseRow of each channel
    std::array<std::uint32_t, 3> blue_x{};    // added to x
};

// The hash behind the dither: the finaliser of MurmurHash3, which mixes every bit of its input into every bit of its output.
inline std::uint32_t mixed_bits(std::uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85EBCA6BU;
    h = (h ^ (h >> 13)) * 0xC2B2AE35U;
    return h ^ (h >> 16);
}
inline constexpr std::uint32_t kPixelStep = 0x9E3779B1U;  // spreads neighbouring x before they are mixed

void quantise_row_8(const QuantiseRowConstants& constants, const float* r, const float* g, const float* b, std::uint32_t x0,
                    std::size_t count, std::uint8_t* out);
void quantise_row_16(const QuantiseRowConstants& constants, const float* r, const float* g, const float* b, std::uint32_t x0,
                     std::size_t count, std::uint16_t* out);

}  // namespace latent::color
