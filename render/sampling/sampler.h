// render/sampling/sampler.h: the numbers that a sample is made of: a function of (seed, sample number, dimension).
#pragma once

#include <array>
#include <cstdint>

#include "render/sampling/dimension.h"
#include "render/sampling/random.h"
#include "render/sampling/uniform.h"
#include "sampledb/data/film_position.h"
#include "sampledb/data/pixel_lattice.h"

namespace latent::render {

// Some dimensions are well spread over the samples, in a way that goes with the film positions; all others are hashes of (seed, n,
// dimension). Does not change once built: any thread.
class Sampler {
 public:
    // What all numbers of a sample are made of.
    struct Key {
        std::uint64_t n, random;
        sampledb::PixelLattice::Place place{};  // if the sampler goes by pixels
    };
    virtual ~Sampler() = default;
    virtual Key key_of(std::uint64_t n) const { return {n, mix(n + seed_)}; }
    virtual sampledb::FilmPosition position(const Key& key) const = 0;

    // At least 60 bits of it differ from sample to sample.
    Uniform at(const Key& key, std::uint64_t dimension) const {
        const std::uint64_t random = mix(key.random + (dimension + 1) * 0x9e3779b97f4a7c15u);
        const std::uint32_t as = spread_as_[slot_of(dimension)];
        return as == 0 ? Uniform{random} : spread(as - 1, key, random);
    }
    Uniform at(std::uint64_t n, std::uint64_t dimension) const { return at(key_of(n), dimension); }

 protected:
    explicit Sampler(std::uint64_t seed) : seed_(mix(seed + 0x6a09e667f3bcc909u)) {}
    // From now on, `spread` makes this dimension, as its number `as`.
    void set_spread(std::uint32_t dimension, std::size_t as) { spread_as_[slot_of(dimension)] = static_cast<std::uint8_t>(as + 1); }
    // `random`: bits for what is below its digits.
    virtual Uniform spread(std::uint32_t as, const Key& key, std::uint64_t random) const = 0;

    const std::uint64_t seed_;

 private:
    // The first dimensions of a sample, and those of the first vertices of light subpaths, may be well spread.
    static constexpr std::uint64_t kTabulated = 64;
    static std::uint64_t slot_of(std::uint64_t dimension) {
        const std::uint64_t of_light = dimension - Dimension::kLightVertices;
        return dimension < kTabulated ? dimension : of_light < kTabulated ? kTabulated + of_light : 2 * kTabulated;
    }
    std::array<std::uint8_t, 2 * kTabulated + 1> spread_as_{};  // 0: hashed, as all others: the last slot
};

// The numbers of one sample.
class SampleNumbers {
 public:
    SampleNumbers(const Sampler& sampler, std::uint64_t n) : sampler_(&sampler), key_(sampler.key_of(n)) {}
    std::uint64_t sample() const { return key_.n; }
    sampledb::FilmPosition position() const { return sampler_->position(key_); }
    Uniform operator()(std::uint64_t dimension) const { return sampler_->at(key_, dimension); }

 private:
    const Sampler* sampler_;
    Sampler::Key key_;
};

}  // namespace latent::render
