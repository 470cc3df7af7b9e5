// tools/develop/engine/spot.h: the records that reach a part of the picture, seen as a run set. Cells may be much larger than that.
#pragma once

#include <cstdint>
#include <vector>

#include "sampledb/read/run_set_view.h"

namespace latent::develop {

// Positions on the film along an axis, both ends inclusive.
struct PositionRange {
    std::uint32_t from, to;
    bool meets(const PositionRange& other) const { return other.from <= to && from <= other.to; }
    bool holds(const PositionRange& other) const { return from <= other.from && other.to <= to; }
    bool holds(std::uint32_t position) const { return from <= position && position <= to; }
};
// Where records reach pixels from .. to-1 of so many, with a filter of this reach.
PositionRange positions_reaching(std::int64_t from, std::int64_t to, std::uint32_t pixels, int reach);

// Pages that hold no such records are not read, and of others the rest is dropped before its values are looked at.
class Spot final : public sampledb::RunSetView {
 public:
    Spot(const sampledb::RunSet& all, const PositionRange& u, const PositionRange& v) : RunSetView(all), u_(u), v_(v) {}

    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override;

 private:
    PositionRange u_, v_;
};

}  // namespace latent::develop
