#include "color/quantise.h"

#include <cassert>

#include "color/blue_noise.h"
#include "color/quantise_row.h"

namespace latent::color {
namespace {

std::uint32_t row_key(std::uint32_t row, std::uint32_t seed) { return mixed_bits(mixed_bits(seed) + row); }

QuantiseRowConstants constants_of(const Quantiser& q, std::uint32_t row) {
    QuantiseRowConstants constants{q.transfer, q.dither, row_key(row, q.seed), {}, {}};
    for (std::uint32_t channel = 0; q.dither == Dither::kBlue && channel < 3; ++channel) {
        // Each channel and seed has the pattern in another place; these steps spread over the torus.
        const std::uint32_t step = 3 * q.seed + channel;
        constants.blue_rows[channel] = blue_noise()[(row + 19 * step) % kBlueNoiseSize].data();
        constants.blue_x[channel] = 29 * step;
    }
    return constants;
}

}  // namespace

float dither_value(std::uint32_t x, std::uint32_t row, std::uint32_t channel, std::uint32_t seed) {
    const std::uint32_t hash = mixed_bits((x * kPixelStep) ^ row_key(row, seed));
    return (static_cast<float>((hash >> (10 * channel)) & 1023U) + 0.5F) / 1024.0F;
}

void Quantiser::to_8_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                          std::uint32_t row, std::span<std::uint8_t> out) const {
    assert(g.size() == r.size() && b.size() == r.size() && out.size() == 3 * r.size());
    quantise_row_8(constants_of(*this, row), r.data(), g.data(), b.data(), x0, r.size(), out.data());
}

void Quantiser::to_16_bits(std::span<const float> r, std::span<const float> g, std::span<const float> b, std::uint32_t x0,
                           std::uint32_t row, std::span<std::uint16_t> out) const {
    assert(g.size() == r.size() && b.size() == r.size() && out.size() == 3 * r.size());
    quantise_row_16(constants_of(*this, row), r.data(), g.data(), b.data(), x0, r.size(), out.data());
}

}  // namespace latent::color
