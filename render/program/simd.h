// render/program/simd.h: which instructions to trace with.
#pragma once

#include <string>

#include "base/result.h"

namespace latent::render {

// "sse4.2", "avx", "avx2" or "avx512": the level asked for, or (empty) the best of the first three; not avx512, which was measured
// to be no faster. Records are equal bit for bit only at one level. Errors: kUsage if the processor lacks it.
Result<std::string> choose_simd(const std::string& asked);

}  // namespace latent::render
