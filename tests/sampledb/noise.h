// tests/sampledb/noise.h: bytes that follow no pattern.
#pragma once

#include <random>

#include "base/bytes.h"

namespace latent::sampledb {

inline Bytes noise(std::size_t size, unsigned values, unsigned seed) {
    std::mt19937 random(seed);
    Bytes bytes(size);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random() % values);
    return bytes;
}

}  // namespace latent::sampledb
