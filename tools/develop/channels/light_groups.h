// tools/develop/channels/light_groups.h: the groups of lights that a job keeps apart, as its files name them. docs/format.md,
// "Registry".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"
#include "sampledb/read/run_set.h"

namespace latent::develop {

inline constexpr const char* kLightGroupColumn = "light_group";  // holds the number of a record's group

struct LightGroup {
    std::string name;
    std::optional<color::Spectrum> spectrum{};  // that all its lights have, up to their scale
};

// In the order of their numbers. The names are in the provenance of the files, where latent-render puts them; without any, groups
// are called by their numbers. Errors: of reading; kUsage if the job has no groups.
Result<std::vector<LightGroup>> light_groups_of(const sampledb::RunSet& run_set);
// Errors: as above; kUsage if the files do not name them.
Result<std::vector<std::string>> names_of_lights(const sampledb::RunSet& run_set);

}  // namespace latent::develop
