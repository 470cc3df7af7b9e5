// tools/develop/origins.h: what the files of a run set say of how their samples were made. docs/format.md, "Registry".
#pragma once

#include <functional>
#include <string_view>

#include "base/result.h"
#include "sampledb/read/run_set.h"

namespace latent::develop {

// Gives `take` the JSON objects in which the first of the files tells its origin: all parts of a job say the same of their scene.
// Errors: of reading.
Status for_each_origin(const sampledb::RunSet& run_set, const std::function<void(std::string_view)>& take);

}  // namespace latent::develop
