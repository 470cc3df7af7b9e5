#include "tools/inspect/info.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/hash.h"
#include "base/json.h"
#include "base/printable.h"
#include "base/size.h"
#include "base/url.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/input_files.h"
#include "sampledb/read/origin.h"
#include "sampledb/read/report_json.h"
#include "sampledb/read/selection.h"
#include "tools/inspect/damage.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::uint64_t kPagesLookedAt = 256;  // at most: enough for the cost of each column within a percent or two
constexpr std::uint64_t kManyRuns = 1000;

Damage damage_of(const RunInfo& run, const Error& error) {
    return {run.offset, run.header.size(), fmt::format("run at byte {}: {}", run.offset, error.message)};
}

// Adds the columns of a page to the sums.
Status look_at(const ByteSource& source, const PageInfo& page, FileInfo& info) {
    Bytes stored(page.stored_size);
    if (Status s = source.read(page.offset, stored); !s) return s;
    if (hash64(stored) != page.stored_hash) return Error{ErrorCode::kCorrupt, "checksum mismatch"};
    const Result<std::vector<StoredColumn>> columns = stored_columns(info.contents.header.job, page, stored);
    if (!columns) return columns.error();
    for (const StoredColumn& column : *columns) {
        auto known = std::ranges::find(info.columns, column.name, &ColumnCost::name);
        if (known == info.columns.end()) known = info.columns.insert(known, {column.name});
        known->stored += column.stored;
        known->decoded += column.decoded;
    }
    return {};
}

// What the columns cost: exact if every page is looked at; else one page of every `step`, scaled so that the bytes of all pages
// come out right. What is damaged is left out, and listed.
Status look_at_pages(const ByteSource& source, const std::vector<RunInfo>& runs, FileInfo& info) {
    const std::uint64_t step = info.pages / kPagesLookedAt + 1;
    // The k-th page looked at, anywhere within its step: runs of equal layout must not be met at the same place each time.
    const auto page_number = [step](std::uint64_t k) { return k * step + ((((k * 0x9e3779b9u) & 0xffffffffu) * step) >> 32); };
    std::uint64_t k = 0, first = 0;  // `first`: number of the run's first page
    std::uint64_t pages_seen = 0, bytes_seen = 0, bytes = 0, records_seen = 0;
    std::vector<Damage>& damage = info.contents.damage;
    for (const RunInfo& run : runs) {
        const std::uint64_t end = first + run.header.page_count;
        bytes += run.header.pages_size;
        if (page_number(k) < end) {
            std::vector<PageInfo> pages;
            std::uint64_t number = first;
            const Result<Coverage> index = scan_run_index(source, run, info.contents.header.job, [&](const PageInfo& page) {
                if (number++ == page_number(k)) pages.push_back(page), ++k;
                return Status{};
            });
            if (!index && !is_unreadable(index.error())) return index.error();
            while (page_number(k) < end) ++k;
            if (!index) add_damage(damage, damage_of(run, index.error()));
            if (!index) pages.clear();
            for (const PageInfo& page : pages) {
                if (Status s = look_at(source, page, info); !s) {
                    if (!is_unreadable(s.error())) return s;
                    add_damage(damage,
                               {page.offset, page.stored_size, fmt::format("page at byte {}: {}", page.offset, s.error().message)});
                    continue;
                }
                ++pages_seen;
                bytes_seen += page.stored_size;
                records_seen += page.record_count;
            }
        }
        first = end;
    }
    info.columns_estimated = pages_seen < info.pages;
    if (!info.columns_estimated) return {};
    const auto scaled = [](std::uint64_t part, std::uint64_t whole, std::uint64_t of) {
        return static_cast<std::uint64_t>(static_cast<double>(part) * static_cast<double>(whole) / static_cast<double>(of));
    };
    for (ColumnCost& column : info.columns) {
        column.stored = scaled(column.stored, bytes, bytes_seen);
        column.decoded = scaled(column.decoded, info.camera_records + info.light_records, records_seen);
    }
    return {};
}

// A text of unknown origin as the rest of a line.
std::string start_of(std::string_view text) {
    constexpr std::size_t kMax = 2000;
    if (text.size() <= kMax) return printable_line(text);
    return fmt::format("{}... ({}; --json prints more)", printable_line(text.substr(0, kMax)), format_size(text.size()));
}

// What a file says of its making, a line for each member, without tables of spectra and names and what has a line elsewhere. A
// text that is no object of JSON is cut off after its start.
std::vector<std::string> lines_of(const std::string& provenance) {
    constexpr std::size_t kMax = 64;
    const bool is_json = quote_provenance(provenance, kHeaderProvenanceDepth).objection.empty();
    const auto members = is_json ? nlohmann::ordered_json::parse(provenance, nullptr, false) : nlohmann::ordered_json();
    if (!members.is_object()) return {start_of(provenance)};
    std::vector<std::string> lines;
    for (const auto& [name, value] : members.items()) {
        if (name == "light_groups" || name == "materials" || name == "cpu_seconds") continue;
        if (lines.size() == kMax) {
            lines.push_back("... (--json prints more)");
            break;
        }
        lines.push_back(start_of(name + ": " + (value.is_string() ? value.get<std::string>() : json_text(value, -1))));
    }
    return lines;
}

// The lights that the records keep apart, by number; the parts of a merged file say the same.
std::vector<NamedLights> light_groups_of(const FileContents& file) {
    std::vector<NamedLights> groups;
    for_each_origin(file, [&](std::string_view origin) {
        if (groups.empty()) groups = lights_in(origin);
    });
    return groups;
}

std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
    return text;
}

}  // namespace

Result<FileInfo> read_info(const std::filesystem::path& path, std::uint64_t memory) {
    Result<FoundFile> file = open_file(path);
    if (!file) return file.error();
    const ByteSource& source = *file->source;
    FileInfo info;
    info.path = path;
    info.size = source.size();
    info.contents = std::move(file->contents);
    const Job& job = info.contents.header.job;
    std::vector<RunInfo> runs = std::exchange(info.contents.runs, {});
    std::uint64_t intervals = 0;
    for (const RunInfo& run : runs) intervals += run.header.interval_count - 1;
    if (Status s = check_list_memory(runs.size(), intervals, memory); !s) return s.error().at(shown_name(path));
    std::vector<SelectedRun> candidates;
    candidates.reserve(runs.size());
    for (const RunInfo& run : runs) {
        Result<Coverage> coverage = run_coverage(source, run, job);
        if (coverage) {
            candidates.push_back({0, false, run.offset, run.header, std::move(*coverage)});
        } else if (is_unreadable(coverage.error())) {
            add_damage(info.contents.damage, damage_of(run, coverage.error()));
        } else {
            return coverage.error().at(shown_name(path));
        }
    }
    Selection selection = select_runs(candidates);
    info.coverage = std::move(selection.coverage);
    info.runs = selection.chosen.size();
    info.superseded_runs = candidates.size() - selection.chosen.size();
    runs.clear();
    info.run_list.reserve(selection.chosen.size());
    for (const std::size_t i : selection.chosen) {
        const RunHeader& header = candidates[i].header;
        runs.push_back({candidates[i].offset, header});
        info.run_list.push_back({std::move(candidates[i].coverage), header.content_hash});
        if (header.samples.end % job.run_samples != 0) ++info.open_runs;
        info.pages += header.page_count;
        info.camera_records += header.camera_records;
        info.light_records += header.light_records;
        info.stored_bytes += header.size();
    }
    candidates = {};
    if (Status s = look_at_pages(source, runs, info); !s) return s.error().at(shown_name(path));
    return info;
}

std::uint64_t FileInfo::frame_bytes() const {
    std::uint64_t bytes = stored_bytes;
    for (const ColumnCost& column : columns) bytes -= std::min(bytes, column.stored);
    return bytes;
}

std::vector<std::string> FileInfo::left_out() const {
    std::vector<std::string> reasons;
    for (const Damage& damage : contents.damage) {
        if (damage.loss) reasons.push_back(damage.reason);
    }
    if (const auto end = damage_at_end(path, contents)) reasons.push_back(end->reason);
    return reasons;
}

std::vector<std::string> FileInfo::remarks() const {
    std::vector<std::string> remarks;
    for (const Damage& damage : contents.damage) {
        if (!damage.loss) remarks.push_back(damage.reason);
    }
    const bool end = damage_at_end(path, contents).has_value();
    if (!end && !contents.finished) remarks.push_back("not finished: still being rendered, or interrupted");
    if (!end && contents.unfinished_tail > 0) {
        remarks.push_back(fmt::format("the last {} are from an interrupted write", format_size(contents.unfinished_tail)));
    }
    if (runs > kManyRuns) {
        remarks.push_back(fmt::format("{} runs: join them with latent-merge --compact to develop faster", runs));
    }
    const auto object = [&](const char* place, const std::string& provenance, std::size_t depth) {
        const std::string objection = quote_provenance(provenance, depth).objection;
        if (!objection.empty()) remarks.push_back(fmt::format("the provenance in its {} {}; shown as text", place, objection));
    };
    object("header", contents.header.provenance_json, kHeaderProvenanceDepth);
    object("footer", contents.footer_provenance, kFooterProvenanceDepth);
    return remarks;
}

std::string positions_in_words(const PositionSamplerSpec& positions) {
    switch (positions.sampler) {
        case PositionSampler::kNone:
            return "stored with each record";
        case PositionSampler::kHalton23:
            return "Halton (2, 3), derived where they agree";
        case PositionSampler::kPixels:
            break;
    }
    return fmt::format("by pixels of {} x {}, derived where they agree", positions.width, positions.height);
}

std::string to_text(const FileInfo& info) {
    const Job& job = info.contents.header.job;
    const std::uint64_t records = info.camera_records + info.light_records;
    std::string text = printable_line(shown_name(info.path)) + "\n";
    const auto line = [&](const char* name, const std::string& value) { text += fmt::format("  {:<12}{}\n", name, value); };
    line("job", to_hex(job.id));
    line("film", fmt::format("aspect {}:{}, Y = 1 is {} cd/m^2", job.aspect_width, job.aspect_height, job.light_unit_cd_m2));
    if (job.kind == RecordKind::kXyz) {
        line("records", "XYZ");
    } else {
        line("records", fmt::format("spectral, {} wavelengths, {}", job.batch,
                                    job.density.empty() ? "stored with each record" : "from the job's density"));
    }
    line("precision",
         job.precision == kFullPrecision ? "values not rounded" : fmt::format("values rounded to {} mantissa bits", job.precision));
    line("positions", positions_in_words(job.positions));
    for (const ExtraColumnSpec& column : job.extra) line("column", printable_line(column.name));
    if (const std::vector<NamedLights> groups = light_groups_of(info.contents); !groups.empty()) {
        std::string all, replaceable;
        const auto add = [](std::string& list, const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
        for (const NamedLights& group : groups) {
            add(all, printable_line(group.name));
            if (!group.spectrum.empty()) add(replaceable, printable_line(group.name));
        }
        line("lights", all);
        const auto lit = std::ranges::find_if(groups, [](const NamedLights& group) { return !group.spectrum.empty(); });
        const NamedLights& example = lit == groups.end() ? groups.front() : *lit;
        line("", fmt::format("to change them: latent-develop --light {}=0.5", printable_line(example.name)));
        line("", "can get a new spectrum (NAME=6500K): " + (replaceable.empty() ? "none" : replaceable));
    }
    line("samples",
         info.coverage.empty() ? "none" : fmt::format("{} ({} in total)", to_string(info.coverage), grouped(info.coverage.size())));
    if (job.light_paths_per_sample > 0) {
        line("N", fmt::format("{} light paths ({} per sample)", grouped(info.light_paths()), job.light_paths_per_sample));
    }
    line("camera", grouped(info.camera_records) + (info.camera_records == 1 ? " record" : " records"));
    line("light", grouped(info.light_records) + (info.light_records == 1 ? " record" : " records"));
    line("runs", fmt::format("{} of up to {} samples; {} superseded, {} ending before a boundary; {} pages", info.runs,
                             job.run_samples, info.superseded_runs, info.open_runs, grouped(info.pages)));
    std::string size = format_size(info.size);
    if (info.superseded_runs > 0) size += fmt::format(", {} without superseded runs", format_size(info.stored_bytes));
    if (records > 0)
        size += fmt::format(", {:.2f} bytes per record", static_cast<double>(info.stored_bytes) / static_cast<double>(records));
    line("size", size);
    const auto per_record = [&](std::uint64_t bytes) { return static_cast<double>(bytes) / static_cast<double>(records); };
    for (const ColumnCost& column : info.columns) {
        line("", fmt::format("{:<10}{:7.3f} bytes per record, {:.0f} decoded{}", printable_line(column.name),
                             per_record(column.stored), per_record(column.decoded), info.columns_estimated ? " (estimated)" : ""));
    }
    if (!info.columns.empty()) {
        line("",
             fmt::format("{:<10}{:7.3f} bytes per record: headers, indexes, padding", "frames", per_record(info.frame_bytes())));
    }
    const Origin origin = origin_of(info.contents);
    if (origin.common != "{}") {
        const char* title = "origin";
        for (const std::string& member : lines_of(origin.common)) line(std::exchange(title, ""), member);
    }
    if (origin.part_count > 0) {
        line("merged", fmt::format("from {}{} (--json lists how they differ)", origin.incomplete ? "at least " : "",
                                   counted(origin.part_count, "part")));
    }
    if (origin.cpu_seconds > 0)
        line("CPU time", format_duration(origin.cpu_seconds) + (origin.committed_before > 0 ? " since rendering was resumed" : ""));
    for (const std::string& reason : info.left_out()) line("damaged", reason);
    for (const std::string& remark : info.remarks()) line("note", remark);
    return text;
}

std::string to_json_text(const FileInfo& info) {
    using nlohmann::json;
    const Job& job = info.contents.header.job;
    json columns = json::object(), extra = json::array();
    const double records = static_cast<double>(info.camera_records + info.light_records);
    for (const ColumnCost& column : info.columns) {
        columns[column.name] = {{"stored_bytes_per_record", static_cast<double>(column.stored) / records},
                                {"decoded_bytes_per_record", static_cast<double>(column.decoded) / records}};
    }
    for (const ExtraColumnSpec& column : job.extra) extra.push_back(column.name);
    json lights = json::array();
    for (const NamedLights& group : light_groups_of(info.contents))
        lights.push_back({{"name", group.name}, {"spectrum", !group.spectrum.empty()}});
    const json report = {{"file", shown_name(info.path)},
                         {"size", info.size},
                         {"finished", info.contents.finished},
                         {"job", to_hex(job.id)},
                         {"aspect", {job.aspect_width, job.aspect_height}},
                         {"kind", job.kind == RecordKind::kXyz ? "xyz" : "spectral"},
                         {"wavelengths", job.batch},
                         {"explicit_wavelengths", job.kind == RecordKind::kSpectral && job.density.empty()},
                         {"precision", job.precision},
                         {"light_unit_cd_m2", job.light_unit_cd_m2},
                         {"light_paths_per_sample", job.light_paths_per_sample},
                         {"run_samples", job.run_samples},
                         {"run_bytes", job.run_bytes},
                         {"extra_columns", extra},
                         {"light_groups", lights},
                         {"sample_count", info.coverage.size()},
                         {"light_paths", info.light_paths()},
                         {"camera_records", info.camera_records},
                         {"light_records", info.light_records},
                         {"runs", info.runs},
                         {"superseded_runs", info.superseded_runs},
                         {"open_runs", info.open_runs},
                         {"pages", info.pages},
                         {"stored_bytes", info.stored_bytes},
                         {"columns", columns},
                         {"columns_estimated", info.columns_estimated},
                         {"frame_bytes", info.frame_bytes()},
                         {"unfinished_tail", info.contents.unfinished_tail},
                         {"damage", info.left_out()},
                         {"notes", info.remarks()}};
    std::string text = with_member(json_text(report), "samples", info.coverage);
    text = with_member(std::move(text), "run_list", [&](std::string& list) {
        list += '[';
        for (const ListedRun& run : info.run_list) {
            list += list.back() == '[' ? "{\"content_hash\":\"" : ",{\"content_hash\":\"";
            list += to_hex(run.content_hash) + "\",\"samples\":";
            append_json(list, run.coverage);
            list += '}';
        }
        list += ']';
    });
    // What others wrote is copied, however long it is.
    const Origin origin = origin_of(info.contents);
    text = with_member(std::move(text), "origin", [&](std::string& to) { append_escaped(to, origin.common); });
    text = with_member(std::move(text), "parts", [&](std::string& to) { append_escaped(to, origin.parts); });
    text = with_member(std::move(text), "parts_complete", [&](std::string& to) { to += origin.incomplete ? "false" : "true"; });
    return with_member(std::move(text), "cpu_seconds", [&](std::string& to) { to += fmt::format("{}", origin.cpu_seconds); });
}

}  // namespace latent::inspect
