// sampledb/codec/xyz_rows.h: XYZ records from columns to rows and back, four at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sampledb/codec/sorter_row.h"
#include "sampledb/data/columns.h"

namespace latent::sampledb {

// Records `first` and following of XYZ columns.
void load_xyz_rows(const Columns& columns, std::size_t first, std::span<SorterRow> rows);

// Copies rows[places[i]] to record i of XYZ columns, which have places.size() records each. Returns whether all shares are 1.
bool gather_xyz_rows(const SorterRow* rows, std::span<const std::uint32_t> places, Columns& columns);

}  // namespace latent::sampledb
