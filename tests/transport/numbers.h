// tests/transport/numbers.h: plain random numbers with a fixed seed.
#pragma once

#include <random>

#include "render/sampling/uniform.h"

namespace latent::render::testing {

class Numbers {
 public:
    explicit Numbers(std::uint32_t seed = 1) : engine_(seed) {}
    Uniform operator()() { return {engine_()}; }

 private:
    std::mt19937_64 engine_;
};

}  // namespace latent::render::testing
