// sampledb/read/report_json.h: how reports spell samples and losses in JSON; found by nlohmann::json's own conversions.
#pragma once

#include <nlohmann/json.hpp>

#include "sampledb/data/coverage.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/gathering.h"

namespace latent::sampledb {

inline void to_json(nlohmann::json& out, const SampleRange& range) { out = {range.first, range.end}; }
inline void to_json(nlohmann::json& out, const Coverage& coverage) {
    out = nlohmann::json::array();
    for (const SampleRange& range : coverage.ranges()) out.push_back(range);
}
inline void to_json(nlohmann::json& out, const LeftOut& item) { out = {{"place", item.place}, {"reason", item.reason}}; }
inline void to_json(nlohmann::json& out, const Damage& damage) {
    out = {{"offset", damage.offset}, {"size", damage.size}, {"reason", damage.reason}};
}

}  // namespace latent::sampledb
