#include "tools/merge/provenance.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "sampledb/byte_source.h"
#include "sampledb/file_reader.h"

namespace latent::merge {

using namespace sampledb;
using nlohmann::json;

namespace {

// What a file says in JSON; anything else (foreign writers) is kept as text.
json parsed(const std::string& text) {
    if (text.empty()) return json::object();
    json value = json::parse(text, nullptr, false);
    return value.is_discarded() ? json(text) : value;
}

}  // namespace

Result<std::string> provenance_of(const Gathering& gathering) {
    std::vector<Coverage> taken(gathering.files().size());
    for (const SelectedRun& run : gathering.runs()) taken[run.file].add(run.coverage);

    std::set<std::string> parts;  // as text, so that equal entries are one
    for (std::size_t i = 0; i < taken.size(); ++i) {
        if (taken[i].empty()) continue;
        const Result<FileSource> source = FileSource::open(gathering.files()[i]);
        if (!source) return source.error();
        const Result<FileContents> contents = read_file(*source);
        if (!contents) return contents.error();
        const json merged = parsed(contents->footer_provenance);
        if (merged.contains("parts") && merged["parts"].is_array()) {
            for (const json& part : merged["parts"]) parts.insert(part.dump(-1, ' ', false, json::error_handler_t::replace));
            continue;
        }
        json samples = json::array();
        for (const SampleRange& range : taken[i].ranges()) samples.push_back({range.first, range.end});
        const json part = {{"provenance", parsed(contents->header.provenance_json)}, {"samples", samples}};
        parts.insert(part.dump(-1, ' ', false, json::error_handler_t::replace));
    }
    std::string text = R"({"parts":[)";
    for (const std::string& part : parts) text += (text.back() == '[' ? "" : ",") + part;
    return text + "]}";
}

}  // namespace latent::merge
