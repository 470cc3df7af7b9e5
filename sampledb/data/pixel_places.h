// sampledb/data/pixel_places.h: the places of a page's samples on the lattice of pixels, all at once.
#pragma once

#include <cstdint>
#include <span>

#include "sampledb/data/pixel_lattice.h"

namespace latent::sampledb {

// Finds samples by the numbers that the block of their page gives them.
class PixelPlaces {
 public:
    PixelPlaces(const PositionSamplerSpec& spec, const FilmNode& node, std::uint64_t first_pass);
    // All spans have the same size.
    void samples(std::span<const std::uint64_t> numbers, std::span<std::uint64_t> n) const;
    void positions(std::span<const std::uint64_t> numbers, std::span<std::uint32_t> u, std::span<std::uint32_t> v) const;

 private:
    PositionSamplerSpec spec_;
    PixelLattice lattice_;
    PixelLattice::Block block_;
    std::uint64_t first_;
};

}  // namespace latent::sampledb
