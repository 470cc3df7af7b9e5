// render/sampling/pixel_sampler.h: film positions by the pixels of a picture, and numbers that are well spread in each.
#pragma once

#include <cstdint>

#include "render/sampling/sampler.h"

namespace latent::render {

// The numbers of a sample are digital sequences at its pass, the number of samples that its pixel had before. Each is
// Owen-scrambled by a key of the seed, the pixel and the number [Owen95], with the hash of [Burley20] and [Vegdahl21].
//
// The ray that a light subpath starts with, and the first step from there, have nothing to do with the pixel: their numbers are the
// first dimensions of Sobol's sequence, scrambled alike, at a shuffled sample number.
class PixelSampler final : public Sampler {
 public:
    PixelSampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed);

    Key key_of(std::uint64_t n) const override;
    sampledb::FilmPosition position(const Key& key) const override { return lattice_.position(key.place); }

 protected:
    Uniform spread(std::uint32_t as, const Key& key, std::uint64_t random) const override;

 private:
    std::uint32_t at_pass(std::uint32_t matrix, const Key& key) const;
    std::uint32_t at_start(std::uint32_t number, const Key& key) const;

    sampledb::PixelLattice lattice_;
    std::uint64_t pixel_seed_;  // seed of what belongs to a pixel, not to a sample
};

}  // namespace latent::render
