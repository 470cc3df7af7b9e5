// render/scene/light_groups.h: lights by name, so that records say whose light they are. docs/rendering.md, "Light groups".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

inline constexpr const char* kLightGroupColumn = "light_group";  // docs/format.md, "Registry"
inline constexpr std::size_t kMaxLightGroups = 256;              // their numbers are bytes

// Numbers the lights of a scene by their names: each light's `group`. Returns the names of the groups, the number of a group being
// its place. Group 0 is "unnamed": lights without a name, and media that emit light. Errors: kUsage (too many names, or none).
Result<std::vector<std::string>> group_lights(SceneDescription& scene);

// The spectrum that all lights of a group have, but for their scale; null if they differ, or colours of a picture decide.
const color::Spectrum* common_spectrum(const SceneDescription& scene, std::uint32_t group);

// Groups by Light::id.
struct LightGroups {
    std::vector<std::uint8_t> of_light{};  // empty: all are in group 0
    std::uint32_t count = 1;

    std::uint32_t of(std::uint32_t light) const { return light < of_light.size() ? of_light[light] : 0; }
    bool any() const { return !of_light.empty(); }
};
LightGroups groups_of(const SceneDescription& scene, std::size_t count);

}  // namespace latent::render
