#include "tools/merge/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "base/json.h"
#include "base/url.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/origin.h"

namespace latent::merge {

using namespace sampledb;
namespace fs = std::filesystem;

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

// As JSON: [[A,B],...].
std::string samples_of(const std::vector<SelectedRun>& runs, std::span<const std::uint32_t> numbers) {
    std::vector<SampleRange> ranges;
    for (const std::uint32_t i : numbers) {
        const std::span<const SampleRange> more = runs[i].coverage.ranges();
        ranges.insert(ranges.end(), more.begin(), more.end());
    }
    const Coverage samples = Coverage::of(std::move(ranges));
    std::string text = "[";
    for (const SampleRange& range : samples.ranges()) fmt::format_to(std::back_inserter(text), "[{},{}],", range.first, range.end);
    text.back() = ']';
    return text;
}

}  // namespace

Result<std::string> provenance_of(const RunSet& run_set) {
    const std::vector<SelectedRun>& runs = run_set.runs();
    std::vector<std::uint32_t> by_file(runs.size());
    std::iota(by_file.begin(), by_file.end(), std::uint32_t{0});
    std::ranges::sort(by_file, {}, [&](std::uint32_t i) { return std::pair(runs[i].file, i); });

    Parts parts;
    for (std::size_t begin = 0, end = 0; begin < by_file.size(); begin = end) {
        const std::uint32_t file = runs[by_file[begin]].file;
        while (end < by_file.size() && runs[by_file[end]].file == file) ++end;
        const fs::path& path = run_set.files()[file];
        const Result<std::shared_ptr<const ByteSource>> source = open_source(path);
        if (!source) return source.error();
        const Result<FileContents> frames = read_frames(**source);
        if (!frames) return frames.error().at(shown_name(path));
        const FileContents& contents = *frames;
        const QuotedProvenance merged = quote_provenance(contents.footer_provenance, kFooterProvenanceDepth);
        if (merged.objection.empty() && member_of(merged.json, "parts").starts_with('[')) {
            for_each_element(member_of(merged.json, "parts"), [&](std::string_view part) { parts.add(std::string(part)); });
            if (member_of(merged.json, "incomplete") == "true") parts.set_incomplete();
            continue;
        }
        const QuotedProvenance own = own_provenance(contents);
        parts.add(fmt::format(R"({{"provenance":{},"samples":{}}})", own.json,
                              samples_of(runs, std::span(by_file).subspan(begin, end - begin))));
    }
    return parts.text();
}

}  // namespace latent::merge
