#include "base/simd.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace latent {

std::vector<std::string_view> simd_levels() {
#if defined(__x86_64__)
    std::vector<std::string_view> levels;
    if (__builtin_cpu_supports("sse4.2")) levels.push_back("sse4.2");
    if (__builtin_cpu_supports("avx")) levels.push_back("avx");
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) levels.push_back("avx2");
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        levels.push_back("avx512");
    return levels;
#else
    return {"neon"};
#endif
}

Result<std::string_view> choose_simd(std::string_view asked, const std::vector<std::string_view>& offered, std::string_view best) {
    if (asked == "best") return best;
    const auto found = std::ranges::find(offered, asked);
    if (found != offered.end()) return *found;
    return usage_error(fmt::format("--simd {}: not available; this processor supports {}", asked, fmt::join(offered, ", ")));
}

}  // namespace latent
