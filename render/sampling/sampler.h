// render/sampling/sampler.h: the numbers that a sample is made of: a function of (seed, sample number, dimension).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/sampling/random.h"
#include "render/sampling/uniform.h"

namespace latent::render {

// What each random decision of a sample is called. Scattering vertices of camera and light subpaths have blocks of their own.
struct Dimension {
    enum : std::uint32_t {
        kXi,
        kKeptWavelength,
        kLensU,
        kLensV,
        // For the ray that a light subpath starts with.
        kStartLight,
        kStartU,
        kStartV,
        kStartDirectionU,
        kStartDirectionV,
        // The seed of Random.
        kRandom,
        // Within the shutter's, if anything moves.
        kTime,
        kCameraVertices = 16,
        kLightVertices = 1u << 20
    };
    // Within the block of a vertex.
    enum : std::uint32_t {
        kDistanceChannel,
        kDistance,
        kLight,
        kLightU,
        kLightV,
        kLobe,
        kDirectionU,
        kDirectionV,
        kSurvival,
        kConnection,
        kEquiangularLight,
        kEquiangular,
        kBlock
    };

    static std::uint32_t of_camera_vertex(std::uint32_t vertex, std::uint32_t what) {
        return kCameraVertices + vertex * kBlock + what;
    }
    static std::uint32_t of_light_vertex(std::uint32_t vertex, std::uint32_t what) {
        return kLightVertices + vertex * kBlock + what;
    }
    // The same decision behind that many interfaces, on the line from the vertex before.
    static std::uint64_t behind(std::uint32_t interfaces, std::uint32_t dimension) {
        return (std::uint64_t{interfaces} << 24) + dimension;
    }
};

// The film position of sample n is Halton(2, 3)(n), so samples of one pixel, at whatever size the film is developed, are those
// whose n agree modulo 2^a 3^b. The dimensions that matter most are therefore scrambled radical inverses in the *other* primes:
// along every such subsequence they are as well spread as along n itself [Halton60], [Owen95]; a sequence in base 2 would not be.
// Large primes are spread out only over many samples, so two dimensions that no path has both of may have the same small one.
// All further dimensions are hashes of (seed, n, dimension).
class Sampler {
 public:
    static constexpr std::size_t kPrimes = 16;  // 5 .. 61

    // A dimension that takes the prime of another, scrambled on its own; hashed if that one is.
    struct Sharing {
        std::uint32_t dimension, with;
    };
    // `important`: dimensions, most important first; the i-th takes the i-th prime from 5 on; those beyond kPrimes are hashed.
    Sampler(std::uint64_t seed, const std::vector<std::uint32_t>& important, const std::vector<Sharing>& sharing = {});

    // 60 bits of it differ from sample to sample, or all 64.
    Uniform at(std::uint64_t n, std::uint64_t dimension) const { return at(n, key_of(n), dimension); }
    // `key`: key_of(n), for whoever asks for many numbers of a sample.
    Uniform at(std::uint64_t n, std::uint64_t key, std::uint64_t dimension) const;
    std::uint64_t key_of(std::uint64_t n) const { return mix(n + seed_); }

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
    static constexpr std::uint32_t kTabulated = 64;  // dimensions below this may have a prime

    // `key`: how it is scrambled.
    void add_radical(std::uint32_t dimension, std::uint32_t base, std::uint64_t key);

    std::uint64_t seed_;
    std::array<std::uint8_t, kTabulated> radical_of_{};  // 0: hashed, else 1 + index
    std::vector<Radical> radicals_;
};

// The numbers of one sample.
class SampleNumbers {
 public:
    SampleNumbers(const Sampler& sampler, std::uint64_t n) : sampler_(&sampler), n_(n), key_(sampler.key_of(n)) {}
    std::uint64_t sample() const { return n_; }
    Uniform operator()(std::uint64_t dimension) const { return sampler_->at(n_, key_, dimension); }

 private:
    const Sampler* sampler_;
    std::uint64_t n_, key_;
};

}  // namespace latent::render
