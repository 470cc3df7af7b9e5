// sampledb/data/film_position.h: named position samplers, in integers only: what lets a file leave positions out. docs/format.md,
// "Samplers".
#pragma once

#include <cstdint>
#include <span>

namespace latent::sampledb {

struct FilmPosition {
    std::uint32_t u, v;  // floor(x 2^32)
    bool operator==(const FilmPosition&) const = default;
};

enum class PositionSampler : std::uint8_t {
    kNone = 0,      // positions are data
    kHalton23 = 1,  // u = radical inverse of n in base 2, v in base 3, each shifted mod 1
    kPixels = 2,    // one sample in each pixel of a W x H grid, then another, ...: pixel_lattice.h
};

inline constexpr std::uint32_t kMaxLatticeSide = 1u << 20;

struct PositionSamplerSpec {
    PositionSampler sampler = PositionSampler::kNone;
    std::uint32_t shift_u = 0, shift_v = 0;  // halton23: added mod 2^32; pixels: what the shifts of all pixels are made of
    std::uint32_t width = 0, height = 0;     // pixels: W and H, 1..kMaxLatticeSide
    bool operator==(const PositionSamplerSpec&) const = default;
};

// Position of sample n by spec.sampler, which is not kNone.
FilmPosition position_of(std::uint64_t n, const PositionSamplerSpec& spec);
// The same for many; fast when neighbours lie within one run. All spans have the same size.
void positions_of(std::span<const std::uint64_t> n, const PositionSamplerSpec& spec, std::span<std::uint32_t> u,
                  std::span<std::uint32_t> v);

// Position of sample n: (floor(phi_2(n) 2^32) + shift_u, floor(phi_3(n) 2^32) + shift_v) mod 2^32, phi_b the radical inverse.
// phi_2 uses the 32 low bits of n, phi_3 its 40 low ternary digits (all of them below 3^40).
FilmPosition halton23(std::uint64_t n, const PositionSamplerSpec& spec);
void halton23(std::span<const std::uint64_t> n, const PositionSamplerSpec& spec, std::span<std::uint32_t> u,
              std::span<std::uint32_t> v);

// Bit 0 becomes bit 31, and so on: phi_2 in 32-bit fixed point.
inline std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x >> 1 & 0x55555555) | (x & 0x55555555) << 1;
    x = (x >> 2 & 0x33333333) | (x & 0x33333333) << 2;
    x = (x >> 4 & 0x0F0F0F0F) | (x & 0x0F0F0F0F) << 4;
    x = (x >> 8 & 0x00FF00FF) | (x & 0x00FF00FF) << 8;
    return x >> 16 | x << 16;
}

}  // namespace latent::sampledb
