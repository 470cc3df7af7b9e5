#include "color/quantise.h"

#include <cassert>

#include "color/quantise_row.h"

namespace latent::color {
namespace {

std::uint32_t row_key(std::uint32_t row, std::uint32_t seed) { return mixed_bits(mixed_bits(seed) + row); }

}  // namespace

float dither_value(std::uint32_t x, std::uint32_t row, std::uint32_t channel, std::uint32_t seed) {
    const std::uint32_t hash = mixed_bits((x * kPixelStep) ^ row_key(row, seed));
    return (static_cast<float>((hash >> (10 * channel)) & 1023U) + 0.5F) / 1024.0F;
}

void Quantiser::to_8_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                          std::uint32_t row, std::span<std::uint8_t> out) const {
    assert(g.size() == r.size() && b.size() == r.size() && out.size() == 3 * r.size());
    quantise_row_8({transfer, dither, row_key(row, seed)}, r.data(), g.data(), b.data(), x0, r.size(), out.data());
}

void Quantiser::to_16_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                           std::uint32_t row, std::span<std::uint16_t> out) const {
    assert(g.size() == r.size() && b.size() == r.size() && out.size() == 3 * r.size());
    quantise_row_16({transfer, dither, row_key(row, seed)}, r.data(), g.data(), b.data(), x0, r.size(), out.data());
}

}  // namespace latent::color
