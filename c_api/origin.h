// c_api/origin.h: what the files of a reader say of how they were made.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/read/run_set.h"

namespace latent::c {

struct Origin {
    std::string json;                                  // tools/merge/provenance.h
    std::vector<std::string> light_groups, materials;  // names, of the first part that has them: all parts of a job say the same
};

// Errors: of reading the files again.
Result<Origin> origin_of(const sampledb::RunSet& run_set);

}  // namespace latent::c
