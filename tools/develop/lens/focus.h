// tools/develop/lens/focus.h: the distance at which a refocused picture is sharp. docs/developing.md, "Focus".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.h"
#include "sampledb/read/run_set.h"
#include "tools/develop/lens/recorded_lens.h"

namespace latent::develop {

struct Focus {
    double distance = 0;                              // along the camera's z, in the units of the scene
    std::optional<std::array<double, 2>> pixel = {};  // or that of the surface which is seen there
};
// "4.5", "infinity", or "120,80". Errors: kUsage.
Result<Focus> parse_focus(std::string_view text);

// The median distance of what camera records around a pixel of a picture of that size see; infinite for the sky. Errors: kUsage (no
// column `depth`, a pixel outside of the picture, no record there), of reading.
Result<double> distance_at(const sampledb::RunSet& run_set, const RecordedLens& lens, const std::array<double, 2>& pixel,
                           std::uint32_t width, std::uint32_t height);

}  // namespace latent::develop
