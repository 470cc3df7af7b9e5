// tools/develop/engine/spot.h: the records that reach a part of the picture, seen as a run set. Cells may be much larger than that.
#pragma once

#include <vector>

#include "sampledb/read/run_set_view.h"
#include "tools/develop/film/positions.h"

namespace latent::develop {

// Pages that hold no such records are not read, and of others the rest is dropped before its values are looked at.
class Spot final : public sampledb::RunSetView {
 public:
    Spot(const sampledb::RunSet& all, const PositionRect& positions) : RunSetView(all), positions_(positions) {}

    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override;

 private:
    PositionRect positions_;
};

}  // namespace latent::develop
