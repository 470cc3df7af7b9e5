// render/scene/source_location.h: where in a scene's files something stands, and the index that stands for nothing.
#pragma once

#include <cstdint>

namespace latent::render {

inline constexpr std::uint32_t kNone = 0xFFFFFFFF;  // no material, medium, light ...

struct SourceLocation {
    std::uint32_t file = 0;  // index into SceneDescription::files
    std::uint32_t line = 1, column = 1;
};

}  // namespace latent::render
