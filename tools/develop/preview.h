// tools/develop/preview.h: how many runs of a gathering a quick picture is made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/result.h"

namespace latent::develop {

// Seconds that developing takes from some of the runs; measured.
using Trial = std::function<Result<double>(std::size_t runs)>;

// How many of `runs` can be developed in about `seconds`, trials included. A picture costs something by itself, and each run its
// share: found out by developing one run, then more, in a sixth of the time that is left each time. At least one. Errors: those of
// `trial`.
Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial);

}  // namespace latent::develop
