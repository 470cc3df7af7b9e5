// tools/merge/provenance.h: which parts a merged file was made from. docs/format.md, "Footer".
#pragma once

#include <string>

#include "base/result.h"
#include "sampledb/read/run_set.h"

namespace latent::merge {

// {"parts": [{"samples": [[A, B], ...], "provenance": {...}}, ...]}: for each input that runs were taken from, those samples and
// what its header says of its origin; inputs that are merged files themselves stand for their own parts. In an order that does not
// depend on that of the inputs.
Result<std::string> provenance_of(const sampledb::RunSet& run_set);

}  // namespace latent::merge
