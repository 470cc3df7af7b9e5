// tools/develop/channels/light_mix.h: lights that are dimmed, filtered or replaced after rendering. docs/developing.md, "Light
// mix".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"
#include "tools/develop/channels/light_groups.h"

namespace latent::develop {

// What the light of a group is multiplied by.
struct GroupFactor {
    double factor = 1;
    std::optional<color::Spectrum> curve{};
};

// For each group, by settings as of light_setting.h. A spectrum instead of its own has the same luminance, and must be zero where
// the own one is. Warns of factors above 20, which multiply noise too. Errors: kUsage (unknown names, spectra that cannot be
// replaced), of files.
Result<std::vector<GroupFactor>> mix_lights(const std::vector<LightGroup>& groups, const std::vector<std::string>& settings,
                                            std::vector<std::string>& warnings);

}  // namespace latent::develop
