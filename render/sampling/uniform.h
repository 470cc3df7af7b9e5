// render/sampling/uniform.h: a number drawn evenly from [0, 1), with bits enough to choose among millions and have others left.
#pragma once

#include <algorithm>
#include <cstdint>

namespace latent::render {

// `bits` / 2^64. A choice among n equal parts takes the leading bits, index(n); where in its part the number lies is a number of
// its own, within(n).
struct Uniform {
    std::uint64_t bits = 0;

    // Below 1. A small number keeps 24 significant bits, so that it is below a small probability as often as that says.
    operator float() const { return std::min(static_cast<float>(static_cast<std::int64_t>(bits >> 1)) * 0x1p-63f, 0x1.fffffep-1f); }
    std::uint32_t index(std::uint32_t n) const { return static_cast<std::uint32_t>(times(n) >> 64); }
    Uniform within(std::uint32_t n) const { return {static_cast<std::uint64_t>(times(n))}; }
    // The leading 32 bits.
    std::uint32_t fraction32() const { return static_cast<std::uint32_t>(bits >> 32); }

 private:
    unsigned __int128 times(std::uint32_t n) const { return static_cast<unsigned __int128>(bits) * n; }
};

}  // namespace latent::render
