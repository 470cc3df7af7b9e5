#include "sampledb/data/film_region.h"

#include <cmath>

namespace latent::sampledb {

Result<FilmRegion> FilmRegion::from(const std::array<double, 4>& coordinates) {
    for (const double c : coordinates) {
        if (!(c >= 0 && c <= 1)) return Error{ErrorCode::kOutOfRange, "region: a coordinate is not between 0 and 1"};
    }
    const auto fixed = [](double c) {
        return static_cast<std::uint64_t>(std::ceil(c * 0x1p32));
    };  // the first position at or behind c
    const FilmRegion region{fixed(coordinates[0]), fixed(coordinates[1]), fixed(coordinates[2]), fixed(coordinates[3])};
    if (coordinates[0] >= coordinates[2] || coordinates[1] >= coordinates[3]) {
        return Error{ErrorCode::kOutOfRange, "region: its end is not behind its beginning"};
    }
    return region;
}

bool FilmRegion::touches(const FilmNode& node, NodePart part) const {
    const int shift = 32 - node.level;
    const std::uint64_t side = std::uint64_t{1} << shift, left = std::uint64_t{node.x} << shift;
    std::uint64_t top = std::uint64_t{node.y} << shift, bottom = top + side;
    if (part == NodePart::kUpper) bottom -= side / 2;
    if (part == NodePart::kLower) top += side / 2;
    return left < u1 && left + side > u0 && top < v1 && bottom > v0;
}

bool FilmRegion::contains(const FilmNode& node) const {
    const int shift = 32 - node.level;
    const std::uint64_t left = std::uint64_t{node.x} << shift, top = std::uint64_t{node.y} << shift;
    const std::uint64_t side = std::uint64_t{1} << shift;
    return left >= u0 && left + side <= u1 && top >= v0 && top + side <= v1;
}

}  // namespace latent::sampledb
