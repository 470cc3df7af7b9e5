// sampledb/data/film_region.h: a rectangle of the film, and what lies in it.
#pragma once

#include <array>
#include <cstdint>

#include "base/result.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// u0 <= u < u1, v0 <= v < v1, in units of 2^-32. The whole film by default.
struct FilmRegion {
    std::uint64_t u0 = 0, v0 = 0, u1 = std::uint64_t{1} << 32, v1 = std::uint64_t{1} << 32;

    // From coordinates u0, v0, u1, v1 in [0, 1]. Errors: kOutOfRange, also if nothing lies between them.
    static Result<FilmRegion> from(const std::array<double, 4>& coordinates);

    bool contains(std::uint32_t u, std::uint32_t v) const { return u >= u0 && u < u1 && v >= v0 && v < v1; }
    // Whether it has a position in common with a node or a part of it, and whether it has all of a node.
    bool touches(const FilmNode& node, NodePart part = NodePart::kAnywhere) const;
    bool contains(const FilmNode& node) const;
};

}  // namespace latent::sampledb
