// sampledb/codec/page_filter.h: the rows of a page that belong to given samples.
#pragma once

#include "sampledb/data/coverage.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

// Keeps the rows whose sample lies in the coverage, in their order. The page's sample numbers are decoded.
void keep_samples(const Coverage& coverage, Page& page);

}  // namespace latent::sampledb
