// render/sampling/halton_sampler.h: film positions by Halton's sequence, and numbers that go with it [R06 3.4.3].
#pragma once

#include <cstdint>
#include <vector>

#include "render/sampling/sampler.h"

namespace latent::render {

// The film position of sample n is Halton(2, 3)(n), so samples of one pixel, at whatever size the film is developed, are those
// whose n agree modulo 2^a 3^b. The dimensions that matter most are therefore scrambled radical inverses in the *other* primes:
// along every such subsequence they are as well spread as along n itself [Halton60], [Owen95]; a sequence in base 2 would not be.
// Large primes are spread out only over many samples, so two dimensions that no path has both of may have the same small one.
class HaltonSampler final : public Sampler {
 public:
    static constexpr std::size_t kPrimes = 16;  // 5 .. 61

    // A dimension that takes the prime of another, scrambled on its own; hashed if that one is.
    struct Sharing {
        std::uint32_t dimension, with;
    };
    // `important`: dimensions, most important first; the i-th takes the i-th prime from 5 on; those beyond kPrimes are hashed.
    HaltonSampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed, const std::vector<std::uint32_t>& important,
                  const std::vector<Sharing>& sharing = {});

    sampledb::FilmPosition position(const Key& key) const override { return sampledb::halton23(key.n, positions_); }

 protected:
    Uniform spread(std::uint32_t as, const Key& key, std::uint64_t random) const override;

 private:
    // Digits are looked up several at a time: `table[j]` maps a block of base-b digits to its scrambled mirror image, in units of
    // 2^-60.
    struct Radical {
        std::uint32_t base = 0;
        std::uint32_t block = 0;            // b^digits, at most 4096
        std::uint64_t reciprocal = 0;       // ceil(2^64 / block): exact quotients below 2^52
        std::uint64_t tail = 0;             // b^-(all digits) in units of 2^-60: the room for a random number below the digits
        std::uint64_t tail_reciprocal = 0;  // floor(2^64 / tail)
        std::vector<std::vector<std::uint64_t>> table;
    };
    // `key`: how it is scrambled.
    void add_radical(std::uint32_t dimension, std::uint32_t base, std::uint64_t key);

    sampledb::PositionSamplerSpec positions_;
    std::vector<Radical> radicals_;
};

}  // namespace latent::render
