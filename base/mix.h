// base/mix.h: numbers that look random, as a function of others.
#pragma once

#include <cstdint>

namespace latent {

// A bijection of 64 bits whose every output bit depends on every input bit [Stafford11, variant 13].
constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

}  // namespace latent
