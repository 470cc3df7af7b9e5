// base/simd.h: instruction sets by the names that --simd takes in every tool.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent {

// Those of "sse4.2", "avx", "avx2" and "avx512", or of "neon", that this processor has, slowest first.
std::vector<std::string_view> simd_levels();

// `asked` where it is one of `offered`, `best` where it is "best". Errors: kUsage, listing what is offered.
Result<std::string_view> choose_simd(std::string_view asked, const std::vector<std::string_view>& offered, std::string_view best);

}  // namespace latent
