// tools/develop/channels/aov_columns.h: what samples see beside light: columns of records become entries of rows.
// docs/developing.md, "AOVs".
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/result.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "tools/develop/channels/layers.h"

namespace latent::develop {

class AovColumns {
 public:
    // The columns that these layers need. Errors: kUsage: the job has none of that name.
    static Result<AovColumns> find(const sampledb::Job& job, const Layers& layers);

    const sampledb::ExtraSet& columns() const { return columns_; }

    // Fills the entries of rows begin .. end-1, which have their shares: means of layers are over these. Values that are not finite
    // are nothing, as are those of rows without a share.
    void fill(const sampledb::Page& page, std::size_t begin, std::size_t end, const RowLayout& layout, float* rows) const;

 private:
    using Place = std::size_t;  // among the extra columns
    std::array<Place, 3> albedo_{}, normal_{}, position_{};
    Place depth_ = 0, object_ = 0, material_ = 0;
    std::vector<Place> others_;
    sampledb::ExtraSet columns_;  // all of these
};

}  // namespace latent::develop
