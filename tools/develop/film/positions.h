// tools/develop/film/positions.h: rectangles of the film, in the positions that records have.
#pragma once

#include <cstdint>

#include "sampledb/data/page.h"

namespace latent::develop {

// Positions along an axis, both ends inclusive.
struct PositionRange {
    std::uint32_t from, to;
    bool meets(const PositionRange& other) const { return other.from <= to && from <= other.to; }
    bool holds(const PositionRange& other) const { return from <= other.from && other.to <= to; }
    bool holds(std::uint32_t position) const { return from <= position && position <= to; }
};
struct PositionRect {
    PositionRange u, v;
    bool meets(const PositionRect& other) const { return u.meets(other.u) && v.meets(other.v); }
    bool holds(const PositionRect& other) const { return u.holds(other.u) && v.holds(other.v); }
    bool holds(std::uint32_t at_u, std::uint32_t at_v) const { return u.holds(at_u) && v.holds(at_v); }
};

// Where the records of a page may lie.
PositionRect positions_of(const sampledb::PageInfo& page);

// Where records reach pixels from .. to-1 of so many along an axis, with a filter of this reach.
PositionRange positions_reaching(std::int64_t from, std::int64_t to, std::uint32_t pixels, int reach);

}  // namespace latent::develop
