#include "render/scene/light_groups.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::render {

namespace {

bool equal(const color::Spectrum& a, const color::Spectrum& b) {
    return a.outside() == b.outside() && std::ranges::equal(a.lambda_nm(), b.lambda_nm()) &&
           std::ranges::equal(a.values(), b.values());
}

}  // namespace

Result<std::vector<std::string>> group_lights(SceneDescription& scene) {
    std::vector<std::string> names = {"unnamed"};
    const auto number = [&](auto& lights) {
        for (auto& light : lights) {
            if (light.name.empty()) continue;
            const auto found = std::ranges::find(names, light.name);
            light.group = static_cast<std::uint32_t>(found - names.begin());
            if (found == names.end()) names.push_back(light.name);
        }
    };
    number(scene.area_lights);
    number(scene.lights);
    if (names.size() == 1)
        return usage_error("--light-groups: no light of the scene has a name; give some a parameter \"string name\"");
    if (names.size() > kMaxLightGroups)
        return usage_error(fmt::format("--light-groups: the lights have {} different names; {} are possible", names.size() - 1,
                                       kMaxLightGroups - 1));
    return names;
}

const color::Spectrum* common_spectrum(const SceneDescription& scene, std::uint32_t group) {
    const color::Spectrum* common = nullptr;
    bool differ = false;
    const auto take = [&](const color::Spectrum& spectrum) {
        differ = differ || (common != nullptr && !equal(*common, spectrum));
        common = &spectrum;
    };
    for (const AreaLightDescription& light : scene.area_lights) {
        if (light.group != group) continue;
        take(light.spectrum);
        differ = differ || light.picture != kNone;
    }
    for (const LightDescription& light : scene.lights) {
        if (light.group != group) continue;
        take(light.spectrum);
        differ = differ || light.image != nullptr;
    }
    for (const MediumDescription& medium : scene.media) differ = differ || (group == 0 && medium.Le.max_value() > 0);
    return differ ? nullptr : common;
}

LightGroups groups_of(const SceneDescription& scene, std::size_t count) {
    LightGroups groups;
    groups.count = static_cast<std::uint32_t>(count);
    for (const AreaLightDescription& light : scene.area_lights) groups.of_light.push_back(static_cast<std::uint8_t>(light.group));
    for (const LightDescription& light : scene.lights) groups.of_light.push_back(static_cast<std::uint8_t>(light.group));
    return groups;
}

}  // namespace latent::render
