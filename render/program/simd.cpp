#include "render/program/simd.h"

#include "base/simd.h"

namespace latent::render {

Result<std::string> choose_simd(std::string_view asked) {
    const std::vector<std::string_view> levels = simd_levels();
    std::string_view best;
    for (const std::string_view level : levels) best = level == "avx512" ? best : level;
    const Result<std::string_view> level = latent::choose_simd(asked, levels, best);
    if (!level) return level.error();
    return std::string(*level);
}

}  // namespace latent::render
