// sampledb/codec/zigzag.h: small differences of either sign <-> small numbers. docs/format.md, "Transforms".
#pragma once

#include <cstdint>

namespace latent::sampledb {

inline std::uint32_t zigzag(std::uint32_t difference) { return difference << 1 ^ (0u - (difference >> 31)); }
inline std::uint32_t unzigzag(std::uint32_t coded) { return coded >> 1 ^ (0u - (coded & 1)); }

// A difference that is a multiple of 2^step, counted in these: what rounding has made zero takes no room.
inline std::uint32_t in_steps(std::uint32_t difference, unsigned step) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(difference) >> step);
}
inline std::uint32_t zigzag(std::uint32_t difference, unsigned step) { return zigzag(in_steps(difference, step)); }
inline std::uint32_t unzigzag(std::uint32_t coded, unsigned step) { return unzigzag(coded) << step; }

}  // namespace latent::sampledb
