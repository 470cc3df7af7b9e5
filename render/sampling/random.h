// render/sampling/random.h: numbers without end for what no dimension can be reserved for, one after another.
#pragma once

#include <bit>
#include <cstdint>

#include "base/mix.h"
#include "render/math/vec.h"
#include "render/sampling/uniform.h"

namespace latent::render {

using latent::mix;

inline std::uint64_t mix(std::uint64_t key, const Vec3f& v) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    return mix(mix(key + (bits(v.x) | bits(v.y) << 32)) + bits(v.z));
}

// [SplitMix64]: the mixed multiples of an odd number, from a point that the seed gives.
class Random {
 public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    Uniform operator()() { return {mix(state_ += 0x9e3779b97f4a7c15u)}; }

 private:
    std::uint64_t state_;
};

}  // namespace latent::render
