#include "tools/merge/provenance.h"

#include <algorithm>
#include <set>
#include <vector>

#include "base/json.h"
#include "sampledb/file_reader.h"
#include "sampledb/report_json.h"

namespace latent::merge {

using namespace sampledb;
using nlohmann::json;

Result<std::string> provenance_of(const Gathering& gathering) {
    std::vector<Coverage> taken(gathering.files().size());
    for (const SelectedRun& run : gathering.runs()) taken[run.file].add(run.coverage);

    std::set<std::string> parts;  // as text, so that equal entries are one
    for (std::size_t i = 0; i < taken.size(); ++i) {
        if (taken[i].empty()) continue;
        const Result<FoundFile> file = open_file(gathering.files()[i]);
        if (!file) return file.error();
        const FileContents& contents = file->contents;
        const json merged = json_or_text(contents.footer_provenance);
        if (merged.contains("parts") && merged["parts"].is_array()) {
            for (const json& part : merged["parts"]) parts.insert(json_text(part, -1));
            continue;
        }
        const json part = {{"provenance", json_or_text(contents.header.provenance_json)}, {"samples", taken[i]}};
        parts.insert(json_text(part, -1));
    }
    std::string text = R"({"parts":[)";
    for (const std::string& part : parts) text += (text.back() == '[' ? "" : ",") + part;
    return text + "]}";
}

}  // namespace latent::merge
