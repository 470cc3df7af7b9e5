#include "tools/merge/provenance.h"

#include <fmt/format.h>

#include <set>
#include <utility>
#include <vector>

#include "base/json.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"
#include "sampledb/read/report_json.h"

namespace latent::merge {

using namespace sampledb;

namespace {

// Entries of "parts" as text, so that equal ones are one. If there are too many, the first in order are kept, whatever the order in
// which they came.
class Parts {
 public:
    void add(std::string part) {
        if (incomplete_ && part >= first_dropped_) return;
        const auto [at, is_new] = parts_.insert(std::move(part));
        if (!is_new) return;
        for (held_ += cost(*at); held_ > kMaxFooterProvenance; incomplete_ = true) {
            first_dropped_ = std::move(parts_.extract(std::prev(parts_.end())).value());
            held_ -= cost(first_dropped_);
        }
    }
    void set_incomplete() { incomplete_ = true; }

    std::string text() const {
        std::string text = R"({"parts":[)";
        text.reserve(held_);
        for (const std::string& part : parts_) text += (text.back() == '[' ? "" : ",") + part;
        return text + (incomplete_ ? R"(],"incomplete":true})" : "]}");
    }

 private:
    static std::size_t cost(const std::string& part) { return part.size() + 96; }  // in memory

    std::set<std::string> parts_;
    std::size_t held_ = 0;
    bool incomplete_ = false;
    std::string first_dropped_;
};

}  // namespace

Result<std::string> provenance_of(const Gathering& gathering) {
    std::vector<Coverage> taken(gathering.files().size());
    for (const SelectedRun& run : gathering.runs()) taken[run.file].add(run.coverage);

    Parts parts;
    for (std::size_t i = 0; i < taken.size(); ++i) {
        if (taken[i].empty()) continue;
        const Result<FoundFile> file = open_file(gathering.files()[i]);
        if (!file) return file.error();
        const FileContents& contents = file->contents;
        const QuotedProvenance merged = quote_provenance(contents.footer_provenance, kFooterProvenanceDepth);
        if (merged.objection.empty() && member_of(merged.json, "parts").starts_with('[')) {
            for_each_element(member_of(merged.json, "parts"), [&](std::string_view part) { parts.add(std::string(part)); });
            if (member_of(merged.json, "incomplete") == "true") parts.set_incomplete();
            continue;
        }
        const QuotedProvenance own = quote_provenance(contents.header.provenance_json, kHeaderProvenanceDepth);
        parts.add(fmt::format(R"({{"provenance":{},"samples":{}}})", own.json, json_text(taken[i], -1)));
    }
    return parts.text();
}

}  // namespace latent::merge
