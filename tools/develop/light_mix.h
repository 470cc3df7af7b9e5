// tools/develop/light_mix.h: lights that are dimmed, filtered or replaced after rendering. docs/developing.md, "Light mix".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"
#include "sampledb/read/gathering.h"

namespace latent::develop {

// A group of lights as the file names it.
struct LightGroup {
    std::string name;
    std::optional<color::Spectrum> spectrum{};  // that all its lights have, up to their scale
};

// What the light of a group is multiplied by.
struct GroupFactor {
    double factor = 1;
    std::optional<color::Spectrum> curve{};
};

// "lamp=2.5", "sky=6500K,0.3", "lamp=wratten-80a": a name, and what happens to the light of that group, in this order: a spectrum
// instead of its own (a temperature, D65, A, E, F1 to F12), curves (a filter, a CSV file of nm and factor), factors.
struct LightSetting {
    std::string name;
    std::string spectrum{};             // "": its own
    std::vector<std::string> curves{};  // names of filters and files
    double factor = 1;
};
Result<LightSetting> parse_light(std::string_view text);

// The names are in the provenance of the files, where latent-render puts them. Without any, groups are called by their numbers.
// Errors: of reading; kUsage if the job has no groups.
Result<std::vector<LightGroup>> light_groups_of(const sampledb::Gathering& gathering);
std::vector<LightGroup> light_groups_in(std::string_view provenance_json);

// For each group. A spectrum instead of its own has the same luminance, and must be zero where the own one is. Warns of curves
// above 20, which make noise. Errors: kUsage (unknown names, spectra that cannot be replaced), of files.
Result<std::vector<GroupFactor>> mix_lights(const std::vector<LightGroup>& groups, const std::vector<std::string>& settings,
                                            std::vector<std::string>& warnings);

inline constexpr const char* kLightGroupColumn = "light_group";  // docs/format.md, "Registry"

}  // namespace latent::develop
