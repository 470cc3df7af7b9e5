#include "tools/inspect/recover.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "base/size.h"
#include "base/url.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/input_files.h"
#include "sampledb/read/report_json.h"
#include "tools/inspect/damage.h"

namespace latent::inspect {

using namespace sampledb;

Result<RecoverReport> recover(const std::filesystem::path& input, const std::filesystem::path& output, bool replace,
                              const Progress& progress) {
    // Walking finds every run that begins with a sound header; then each is read in full.
    Result<FoundFile> found = open_file(input, VerifyLevel::kHeaders, false);
    if (!found) return found.error();
    const ByteSource& source = *found->source;
    FileContents& file = found->contents;
    std::error_code ignored;  // an output that is not there yet is no other name of the input
    if (std::filesystem::equivalent(input, output, ignored)) {
        return Error{ErrorCode::kExists, output.string() + ": is the input file; choose another output"};
    }
    Result<OutputFile> out = OutputFile::create(output, replace);
    if (!out) return out.error();
    const Job& job = file.header.job;
    RecoverReport report;
    report.input = input;
    report.output = output;
    report.damage = file.damage;
    report.unfinished_tail = file.unfinished_tail;
    Coverage promised = file.lost_by_list;  // by the footer, if that survived, and by the headers that were found
    if (const auto cut = damage_at_end(input, file)) {
        report.damage.push_back(*cut);
        report.unfinished_tail = 0;
    }

    const Result<Bytes> header = encode_file_header(file.header);
    if (!header) return header.error();
    if (Status s = out->file().write_all(0, *header); !s) return s.error();
    std::uint64_t end = header->size();
    std::vector<RunInfo>& runs = file.runs;
    std::size_t kept = 0;  // at the front of these, now where the new file has them
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const RunInfo run = runs[i];
        if (progress) progress(static_cast<double>(run.offset) / static_cast<double>(source.size()), fmt::format("run {}", i));
        const Result<Coverage> covered = run_coverage(source, run, job);
        if (!covered && covered.error().code == ErrorCode::kIo) return covered.error().at(shown_name(input));
        const Coverage held = covered.value_or(Coverage(run.header.samples));  // what its header says if its index is damaged
        promised.add(held);
        if (Status s = verify_run(source, run, job, VerifyLevel::kFull); !s) {
            if (s.error().code == ErrorCode::kIo) return s.error().at(shown_name(input));
            add_damage(report.damage, lost_run(i, run, s.error()));
            continue;
        }
        if (Status s = copy_bytes(source, run.offset, out->file(), end, run.header.size()); !s) return s.error();
        runs[kept++] = {end, run.header};
        end += run.header.size();
        report.kept.add(held);
    }
    runs.resize(kept);
    if (runs.empty() && (report.lost_anything() || report.unfinished_tail > 0)) {
        const auto loss = std::ranges::find(report.damage, true, &Damage::loss);
        const std::string why = loss != report.damage.end() ? loss->reason : "its only write was interrupted";
        return Error{ErrorCode::kCorrupt, fmt::format("{}: {}; nothing could be recovered", shown_name(input), why)};
    }
    const Result<std::uint64_t> footer = put_footer(runs, file.footer_provenance, end, [&](ByteSpan piece) {
        const Status put = out->file().write_all(end, piece);
        end += piece.size();
        return put;
    });
    if (!footer) return footer.error().at(output.string());
    const FileView written(out->file(), output.string(), end);
    for (const RunInfo& run : runs) {
        if (Status s = verify_run(written, run, job, VerifyLevel::kStored); !s) return s.error().at(output.string());
    }
    if (Status s = out->publish(); !s) return s.error();
    report.runs = runs.size();
    report.bytes = end;
    report.lost = promised;
    report.lost.remove(report.kept);
    return report;
}

std::string to_text(const RecoverReport& report) {
    std::string text;
    for (const Damage& damage : report.damage) text += fmt::format("{}: {}\n", shown_name(report.input), damage.reason);
    if (report.unfinished_tail > 0) {
        text += fmt::format("{}: the last {} are from an interrupted write\n", shown_name(report.input),
                            format_size(report.unfinished_tail));
    }
    text += fmt::format("{}: {}, samples {}, {}\n", report.output.string(), counted(report.runs, "run"),
                        report.kept.empty() ? "none" : to_string(report.kept), format_size(report.bytes));
    if (!report.lost.empty()) text += fmt::format("lost: samples {}\n", to_string(report.lost));
    if (report.lost_anything() && report.lost.empty()) text += "lost: unknown samples, or none\n";
    return text;
}

std::string to_json_text(const RecoverReport& report) {
    const nlohmann::json facts = {{"input", shown_name(report.input)},
                                  {"output", report.output.string()},
                                  {"runs", report.runs},
                                  {"bytes", report.bytes},
                                  {"damage", report.damage},
                                  {"unfinished_tail", report.unfinished_tail}};
    return with_member(with_member(json_text(facts), "kept_samples", report.kept), "lost_samples", report.lost);
}

}  // namespace latent::inspect
