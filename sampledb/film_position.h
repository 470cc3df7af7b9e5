// sampledb/film_position.h: named position samplers, in integers only: what lets a file leave positions out. docs/format.md,
// "Samplers".
#pragma once

#include <cstdint>

namespace latent::sampledb {

struct FilmPosition {
    std::uint32_t u, v;  // floor(x 2^32)
    bool operator==(const FilmPosition&) const = default;
};

enum class PositionSampler : std::uint8_t {
    kNone = 0,      // positions are data
    kHalton23 = 1,  // u = radical inverse of n in base 2, v in base 3, each shifted mod 1
};

struct PositionSamplerSpec {
    PositionSampler sampler = PositionSampler::kNone;
    std::uint32_t shift_u = 0, shift_v = 0;  // added mod 2^32
    bool operator==(const PositionSamplerSpec&) const = default;
};

// Position of sample n: (floor(phi_2(n) 2^32) + shift_u, floor(phi_3(n) 2^32) + shift_v) mod 2^32, phi_b the radical inverse.
// phi_2 uses the 32 low bits of n, phi_3 its 40 low ternary digits (all of them below 3^40).
FilmPosition halton23(std::uint64_t n, const PositionSamplerSpec& spec);

}  // namespace latent::sampledb
