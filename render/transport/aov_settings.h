// render/transport/aov_settings.h: which further values records hold of the ray and of the surface that it hits, and their
// columns. docs/rendering.md, "AOVs".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sampledb/data/job.h"

namespace latent::render {

struct AovSettings {
    bool albedo = false, normal = false, depth = false, position = false, id = false;
    bool lens = false, time = false;

    bool any() const { return mask() != 0; }
    bool sees_surfaces() const { return (mask() & 31) != 0; }
    std::uint32_t mask() const {
        return (albedo ? 1 : 0) + (normal ? 2 : 0) + (depth ? 4 : 0) + (position ? 8 : 0) + (id ? 16 : 0) + (lens ? 32 : 0) +
               (time ? 64 : 0);
    }
};

// "albedo,normal,depth,position,id,lens,time", in any order. Errors: kUsage.
Result<AovSettings> parse_aovs(std::string_view text);
// The same list, in that order.
std::string to_text(const AovSettings& aovs);

// Extra columns of records, in their order. docs/format.md, "Registry".
std::vector<sampledb::ExtraColumnSpec> aov_columns(const AovSettings& aovs);

}  // namespace latent::render
