// sampledb/read/report_json.h: how reports spell samples and losses in JSON. Losses by nlohmann::json's own conversions; samples,
// of which there may be a million intervals, as text.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "base/json.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/run_set.h"

namespace latent::sampledb {

// Appends [[0,4096],[8192,12288]].
inline void append_json(std::string& text, const Coverage& coverage) {
    text.reserve(text.size() + coverage.ranges().size() * 44 + 16);
    text += '[';
    for (const SampleRange& range : coverage.ranges()) fmt::format_to(std::back_inserter(text), "[{},{}],", range.first, range.end);
    if (text.back() == ',') text.pop_back();
    text += ']';
}
inline std::string with_member(std::string object, std::string_view name, const Coverage& coverage) {
    return latent::with_member(std::move(object), name, [&](std::string& text) { append_json(text, coverage); });
}
inline void to_json(nlohmann::json& out, const LeftOut& item) { out = {{"place", item.place}, {"reason", item.reason}}; }
inline void to_json(nlohmann::json& out, const Damage& damage) {
    out = {{"offset", damage.offset}, {"size", damage.size}, {"reason", damage.reason}};
}

}  // namespace latent::sampledb
