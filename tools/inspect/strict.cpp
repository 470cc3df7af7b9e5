#include "tools/inspect/strict.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <string_view>

#include "base/json.h"
#include "base/printable.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/rounding.h"
#include "sampledb/data/grain.h"
#include "sampledb/read/provenance.h"
#include "tools/inspect/strict_order.h"
#include "tools/inspect/strict_page.h"
#include "tools/inspect/strict_shares.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

bool is_utf8(const std::string& text) {
    const nlohmann::json back = nlohmann::json::parse(json_text(nlohmann::json(text), -1));
    return back.get<std::string>() == text;  // where it is not, U+FFFD stands
}

// The size of a run's columns in memory: those of a page, and the class of each record. docs/format.md, "Canonical runs".
std::uint64_t raw_bytes(const Job& job, const RunHeader& run) {
    const std::uint64_t records = run.camera_records + run.light_records;
    return records * sizeof(RecordClass) + decoded_page_size(job, RecordClass::kCamera, records, run.pair_count);
}

// Every value is one that rounding to the job's precision leaves as it is, whatever the random number.
void check_precision(const Job& job, const Page& page, std::size_t run, std::size_t number, Violations& violations) {
    const unsigned dropped = kFullPrecision - job.precision;
    const auto check = [&](const char* name, const std::vector<float>& values, std::size_t count) {
        for (std::size_t i = 0; i < std::min(count, values.size()); ++i) {
            const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[i]);
            if (rounded(bits, dropped, ~std::uint32_t{0}) == bits) continue;
            violations.add({.run = run,
                            .page = number,
                            .what = fmt::format("column {}: value {} has the bits {:08x}", name, i, bits),
                            .wanted = fmt::format("{} bits of mantissa", job.precision)});
            return;
        }
    };
    check("x", page.x, page.count), check("y", page.y, page.count), check("z", page.z, page.count);
    check("power", page.power, page.pairs.empty() ? 0 : page.first_pair[page.count]);
}

bool is_zero(ByteSpan bytes) {
    return std::ranges::all_of(bytes, [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace

Result<Violations> check_header_strictly(const ByteSource& source, const FileContents& file) {
    constexpr std::size_t kReserved = 40, kReservedEnd = 56;
    Violations violations;
    Bytes front(kReservedEnd);
    if (Status s = source.read(0, front); !s) return s.error();
    if (!is_zero(ByteSpan(front).subspan(kReserved))) {
        violations.add({.what = "reserved bytes of the header are not zero", .wanted = "zero in bytes 40..55"});
    }
    for (const ExtraColumnSpec& column : file.header.job.extra) {
        if (is_utf8(column.name)) continue;
        violations.add({.what = fmt::format("the column '{}' has a name that is not UTF-8", printable_line(column.name)),
                        .wanted = "a name in UTF-8"});
    }
    const auto check_provenance = [&](const char* place, std::string_view text, std::size_t depth) {
        const std::string objection = quote_provenance(text, depth).objection;
        if (objection.empty()) return;
        violations.add({.what = fmt::format("the provenance in the {} {}", place, objection),
                        .wanted = fmt::format("nothing, or a JSON object nested at most {} deep", depth)});
    };
    check_provenance("header", file.header.provenance_json, kHeaderProvenanceDepth);
    check_provenance("footer", file.footer_provenance, kFooterProvenanceDepth);
    return violations;
}

Result<Violations> check_run_strictly(const ByteSource& source, std::size_t number, const RunInfo& run, const Job& job) {
    const Result<RunIndex> index = read_run_index(source, run, job);
    if (!index) return index.error();
    Violations violations;
    OrderCheck order(job, number, violations);
    ShareCheck shares(index->coverage, number, violations);
    PageDecoder decoder;
    Page page;
    Bytes stored;
    for (std::size_t i = 0; i < index->pages.size(); ++i) {
        const PageInfo& info = index->pages[i];
        stored.resize(info.stored_size);
        if (Status s = source.read(info.offset, stored); !s) return s.error();
        if (Status s = decoder.decode(job, info, stored, ColumnSet{}, page); !s) return s.error().at(fmt::format("page {}", i));
        if (Status s = check_page_strictly(job, info, stored, number, i, violations); !s) return s.error();
        check_precision(job, page, number, i, violations);
        order.add(info, i, page);
        shares.add(page);
    }
    order.finish();
    const auto read_shares = [&](std::size_t i, Page& into) {
        return index->pages[i].record_class == RecordClass::kCamera
                   ? read_page(source, index->pages[i], job, ColumnSet{.positions = false, .values = false, .extra = {}}, decoder,
                               into)
                   : Status{};
    };
    if (Status s = shares.finish(index->pages.size(), read_shares); !s) return s.error();
    return violations;
}

std::string boundary_note(const RunHeader& run, const Job& job) {
    const SampleRange& samples = run.samples;
    if (samples.first % kGrainSamples != 0) return fmt::format("does not begin at a multiple of {} samples", kGrainSamples);
    if (run.interval_count > 1) return "";  // a checkpoint, or compacted
    const std::uint64_t size = job.run_samples;
    const bool of_whole_intervals = samples.first % size == 0 && samples.end % size == 0;
    if (samples.first / size != (samples.end - 1) / size && !of_whole_intervals)
        return fmt::format("crosses a multiple of S = {} and is not made of whole intervals of S", size);
    if (samples.size() > size || samples.size() <= kGrainSamples) return "";
    const std::uint64_t raw = raw_bytes(job, run);
    return raw <= job.run_bytes ? "" : fmt::format("holds {} raw bytes, more than R = {}", raw, job.run_bytes);
}

Violations check_runs_against_each_other(const std::vector<RunInfo>& runs) {
    std::vector<std::size_t> order(runs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return runs[i].header.samples; });
    Violations violations;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const RunHeader &a = runs[order[i - 1]].header, &b = runs[order[i]].header;
        if (a.samples != b.samples || a.interval_count > 1 || b.interval_count > 1 || a.content_hash == b.content_hash) continue;
        violations.add({.run = order[i],
                        .what = fmt::format("its records of samples {}:{} differ from those in run {}", b.samples.first,
                                            b.samples.end, order[i - 1]),
                        .wanted = "the same records for the same sample numbers"});
    }
    return violations;
}

}  // namespace latent::inspect
