// tests/transport/numbers.h: plain random numbers with a fixed seed.
#pragma once

#include <random>

namespace latent::render::testing {

class Numbers {
 public:
    explicit Numbers(std::uint32_t seed = 1) : engine_(seed) {}
    float operator()() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }

 private:
    std::mt19937 engine_;
};

}  // namespace latent::render::testing
