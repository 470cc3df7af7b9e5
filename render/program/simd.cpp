#include "render/program/simd.h"

#include <fmt/format.h>

#include <string_view>

namespace latent::render {

Result<std::string> choose_simd(const std::string& asked) {
    struct Level {
        std::string_view name;
        bool here;
    };
#if defined(__x86_64__)
    const Level levels[] = {
        {"avx2", __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")},
        {"avx", __builtin_cpu_supports("avx") != 0},
        {"sse4.2", true},
        {"avx512", __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")}};
#else
    const Level levels[] = {{"neon", true}};
#endif
    for (const Level& level : levels) {
        if (asked.empty() ? level.here : asked == level.name && level.here) return std::string(level.name);
        if (asked == level.name) return Error{ErrorCode::kUsage, fmt::format("--simd {}: this processor does not have it", asked)};
    }
    return Error{ErrorCode::kUsage, fmt::format("--simd {}: is not one of sse4.2, avx, avx2, avx512", asked)};
}

}  // namespace latent::render
