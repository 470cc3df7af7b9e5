#include "tools/inspect/verify.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "base/size.h"
#include "base/url.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/input_files.h"
#include "sampledb/read/part_name.h"
#include "tools/inspect/damage.h"
#include "tools/inspect/strict.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::uint64_t kRunsAtOnce = 4096, kRunsAtOnceStrictly = 64;  // what is found of them is held

const char* what_was_looked_at(VerifyLevel level) {
    switch (level) {
        case VerifyLevel::kHeaders:
            return "headers";
        case VerifyLevel::kQuick:
            return "indexes and one page of each run";
        case VerifyLevel::kStored:
            return "every stored byte";
        case VerifyLevel::kFull:
        case VerifyLevel::kOrdered:
            return "every record";
    }
    return "";
}

std::uint64_t count_not_finite(const std::vector<float>& values, std::size_t count) {
    return static_cast<std::uint64_t>(std::count_if(values.begin(),
                                                    values.begin() + static_cast<std::ptrdiff_t>(std::min(count, values.size())),
                                                    [](float value) { return !std::isfinite(value); }));
}

// Values that are NaN or infinite in a run whose pages are known to decode.
Result<std::uint64_t> not_finite_in(const ByteSource& source, const RunInfo& run, const Job& job) {
    PageDecoder decoder;
    Page page;
    std::uint64_t found = 0;
    const Result<Coverage> scanned = scan_run_index(source, run, job, [&](const PageInfo& info) {
        if (Status s = read_page(source, info, job, ColumnSet{}, decoder, page); !s) return s;
        for (const auto* column : {&page.x, &page.y, &page.z, &page.share}) found += count_not_finite(*column, page.count);
        found += count_not_finite(page.power, info.pair_count);
        return Status{};
    });
    if (!scanned) return scanned.error();
    return found;
}

// What there is to say of a run that is sound.
struct RunReport {
    std::uint64_t not_finite = 0;
    Violations violations;
};

// A run as it was read, or what is wrong with it.
Result<RunReport> check_run(const ByteSource& source, std::size_t number, const RunInfo& run, const Job& job, VerifyLevel level,
                            bool strict) {
    if (Status s = verify_run(source, run, job, level); !s) return s.error();
    RunReport report;
    if (level < VerifyLevel::kFull) return report;
    const Result<std::uint64_t> not_finite = not_finite_in(source, run, job);
    if (!not_finite) return not_finite.error();
    report.not_finite = *not_finite;
    if (!strict) return report;
    Result<Violations> violations = check_run_strictly(source, number, run, job);
    if (!violations) return violations.error();
    report.violations = std::move(*violations);
    return report;
}

}  // namespace

Result<VerifyReport> verify(const std::filesystem::path& path, VerifyLevel level, bool strict, int threads,
                            const Progress& progress) {
    const Result<std::shared_ptr<const ByteSource>> opened = open_source(path);
    if (!opened) return opened.error();
    const ByteSource& source = **opened;
    VerifyReport report;
    report.path = path;
    report.level = level;
    report.strict = strict;
    report.size = source.size();
    // The runs are the truth, so they are found by walking; the footer must say the same.
    Result<FileContents> file = read_file(source, VerifyLevel::kHeaders, false);
    if (!file) {
        if (!is_damage(file.error())) return file.error().at(shown_name(path));
        report.damage.push_back(file.error().message);
        return report;
    }
    const Job& job = file->header.job;
    report.finished = file->finished;
    report.unfinished_tail = file->unfinished_tail;
    report.runs = file->runs.size();
    if (strict) {
        Result<Violations> violations = check_header_strictly(source, *file);
        if (!violations) return violations.error().at(shown_name(path));
        report.violations = std::move(*violations);
    }
    std::vector<Result<RunReport>> checked(std::min(report.runs, strict ? kRunsAtOnceStrictly : kRunsAtOnce));
    std::mutex mutex;
    std::uint64_t bytes_checked = 0;
    const Threads workers(threads);
    for (std::size_t first = 0; first < report.runs; first += checked.size()) {
        const std::size_t end = std::min(first + checked.size(), file->runs.size());
        const auto check = [&](std::size_t i) {
            checked[i - first] = check_run(source, i, file->runs[i], job, level, strict);
            const std::lock_guard lock(mutex);
            bytes_checked += file->runs[i].header.size();
            if (progress)
                progress(static_cast<double>(bytes_checked) / static_cast<double>(report.size), format_size(bytes_checked));
        };
        workers.run([&] { tbb::parallel_for(first, end, check); });
        for (std::size_t i = first; i < end; ++i) {
            const RunInfo& run = file->runs[i];
            Result<RunReport>& found = checked[i - first];
            if (!found && found.error().code == ErrorCode::kIo) return found.error().at(shown_name(path));
            if (!found) {
                add_damage(file->damage, lost_run(i, run, found.error()));
                continue;
            }
            report.pages += run.header.page_count;
            report.records += run.header.camera_records + run.header.light_records;
            report.not_finite += found->not_finite;
            report.violations.append(std::move(found->violations));
            const std::string note = strict ? boundary_note(run.header, job) : "";
            if (!note.empty() && report.notes.size() < Violations::kMaxListed) {
                report.notes.push_back(
                    fmt::format("run {}, samples {}:{}, {}: other runs of these samples cannot be recognised as the same", i,
                                run.header.samples.first, run.header.samples.end, note));
            }
        }
    }
    for (const Damage& damage : file->damage) report.damage.push_back(damage.reason);
    if (strict) report.violations.append(check_runs_against_each_other(file->runs));
    if (const auto end = damage_at_end(path, *file)) report.damage.push_back(end->reason);
    return report;
}

namespace {

// "run 3, page 5, record 17: ", as far as it goes.
std::string place_of(const Violation& violation) {
    std::string place;
    for (const auto& [name, number] :
         {std::pair("run", violation.run), std::pair("page", violation.page), std::pair("record", violation.record)}) {
        if (number) place += fmt::format("{}{} {}", place.empty() ? "" : ", ", name, *number);
    }
    return place.empty() ? place : place + ": ";
}

}  // namespace

std::string to_text(const VerifyReport& report) {
    std::string text;
    for (const std::string& damage : report.damage) text += fmt::format("{}: {}\n", shown_name(report.path), damage);
    text += fmt::format("{}: {}: {}, {}, {}, {} ({} checked)\n", shown_name(report.path),
                        !report.damage.empty()          ? "DAMAGED"
                        : report.violations.count() > 0 ? "readable, but VIOLATES THE FORMAT"
                        : report.strict                 ? "sound, and follows the format"
                                                        : "sound",
                        counted(report.runs, "run"), counted(report.pages, "page"), counted(report.records, "record"),
                        format_size(report.size), what_was_looked_at(report.level));
    if (!report.finished && is_attempt(report.path)) {
        text += fmt::format("{}: not finished", shown_name(report.path));
        text += report.unfinished_tail > 0
                    ? fmt::format("; the last {} are from an interrupted write\n", format_size(report.unfinished_tail))
                    : "\n";
    }
    for (const std::string& note : report.notes) text += fmt::format("{}: note: {}\n", shown_name(report.path), note);
    const std::vector<Violation>& violations = report.violations.listed();
    for (const Violation& violation : violations) {
        text +=
            fmt::format("{}: {}{}; expected: {}\n", shown_name(report.path), place_of(violation), violation.what, violation.wanted);
    }
    if (report.violations.count() > violations.size()) {
        text += fmt::format("{}: {}\n", shown_name(report.path),
                            counted(report.violations.count() - violations.size(), "more violation"));
    }
    if (report.not_finite > 0)
        text += fmt::format("{}: {} not finite\n", shown_name(report.path),
                            counted(report.not_finite, "value") + (report.not_finite == 1 ? " is" : " are"));
    return text;
}

nlohmann::json to_json(const VerifyReport& report) {
    nlohmann::json json = {{"file", shown_name(report.path)},
                           {"sound", report.damage.empty()},
                           {"size", report.size},
                           {"runs", report.runs},
                           {"pages", report.pages},
                           {"records", report.records},
                           {"finished", report.finished},
                           {"unfinished_tail", report.unfinished_tail},
                           {"not_finite", report.not_finite},
                           {"damage", report.damage}};
    if (!report.strict) return json;
    json["notes"] = report.notes;
    json["violation_count"] = report.violations.count();
    nlohmann::json& listed = json["violations"] = nlohmann::json::array();
    for (const Violation& violation : report.violations.listed()) {
        nlohmann::json item = {{"what", violation.what}, {"wanted", violation.wanted}};
        if (violation.run) item["run"] = *violation.run;
        if (violation.page) item["page"] = *violation.page;
        if (violation.record) item["record"] = *violation.record;
        listed.push_back(std::move(item));
    }
    return json;
}

}  // namespace latent::inspect
