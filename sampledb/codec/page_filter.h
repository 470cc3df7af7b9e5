// sampledb/codec/page_filter.h: some of the rows of a page: those of given samples, or any.
#pragma once

#include <cstddef>
#include <span>

#include "sampledb/data/coverage.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Keeps the rows whose sample lies in the coverage, in their order. The page's sample numbers are decoded.
void keep_samples(const Coverage& coverage, Page& page);

// Keeps these rows, in this order; columns that are empty stay so.
void keep_rows(std::span<const std::size_t> rows, Page& page);

}  // namespace latent::sampledb
