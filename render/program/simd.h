// render/program/simd.h: which instructions to trace with.
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace latent::render {

// An Embree isa: the level of base/simd.h that was asked for; "best" is the fastest but avx512, which was measured to be no faster
// than avx2. Records are equal bit for bit only at one level. Errors: kUsage if the processor lacks it.
Result<std::string> choose_simd(std::string_view asked);

}  // namespace latent::render
