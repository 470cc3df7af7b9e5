// image/png_filter.h: PNG's row filters: bytes predicted from their neighbours, so that deflate finds small numbers.
#pragma once

#include "base/bytes.h"

namespace latent::image {

// Filters one row of pixels of `pixel_bytes` into out: the filter's number, then row.size() bytes [PNG, 9 "Filtering"]. Of the five
// filters, the one with the least sum of |byte as a signed number|. `above` is the row before, or empty for the first row.
void filter_row(ByteSpan row, ByteSpan above, std::size_t pixel_bytes, std::byte* out);

}  // namespace latent::image
