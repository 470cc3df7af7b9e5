// tools/develop/lens/refocused.h: the pages of a run set where a lens that is focused elsewhere would have put their records.
// docs/developing.md, "Focus".
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "sampledb/read/run_set_view.h"

namespace latent::develop {

// Pages lie in larger nodes than those of the files: in the smallest that hold what their records may be moved to, by
// LensWeights::move.
class Refocused final : public sampledb::RunSetView {
 public:
    Refocused(const sampledb::RunSet& all, const std::array<double, 2>& shift) : RunSetView(all), shift_(shift) {}

    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override;

 private:
    sampledb::FilmNode reached_from(const sampledb::FilmNode& node) const;

    std::array<double, 2> shift_;
};

}  // namespace latent::develop
