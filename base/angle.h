// base/angle.h: sines that have the same bits everywhere; those of the C library depend on its version.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace latent {

// Cosine and sine, by their series, to 1e-15.
inline std::array<double, 2> cos_sin_of_degrees(double degrees) {
    const double turns = degrees / 360, x = (turns - std::round(turns)) * 6.283185307179586;
    std::array<double, 2> sums{};
    double term = 1;  // x^i / i!
    for (int i = 0; i < 30; ++i) {
        sums[static_cast<std::size_t>(i % 2)] += i % 4 < 2 ? term : -term;
        term *= x / (i + 1);
    }
    return sums;
}

}  // namespace latent
