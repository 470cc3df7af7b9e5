#include "tools/merge/merge.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "sampledb/data/limits.h"
#include "tools/merge/output.h"
#include "tools/merge/plan.h"
#include "tools/merge/provenance.h"

namespace latent::merge {

using namespace sampledb;

namespace {

Status check_required(const MergeOptions& options, const RunSet& run_set) {
    if (!options.require || run_set.coverage().contains(*options.require)) return {};
    Coverage missing(*options.require);
    missing.remove(run_set.coverage());
    std::string text = fmt::format("samples {} are required, but no part holds them", to_string(missing));
    const std::vector<LeftOut>& left_out = run_set.report().left_out;
    if (!left_out.empty()) text += fmt::format("; left out: {}: {}", left_out[0].place, left_out[0].reason);
    if (left_out.size() > 1) text += fmt::format(", and {} more", left_out.size() - 1);
    return Error{ErrorCode::kMismatch, std::move(text)};
}

Status check_number(std::size_t runs) {
    if (runs <= kMaxRunsPerFile) return {};
    return Error{ErrorCode::kOutOfRange,
                 fmt::format("{} runs; a file holds at most {}; join them with --compact", runs, kMaxRunsPerFile)};
}

// A part of an empty shard holds no run, and may be all there is; but not what is left of parts that were damaged.
Status check_anything_left(const RunSet& run_set) {
    const std::vector<LeftOut>& left_out = run_set.report().left_out;
    if (!run_set.runs().empty() || left_out.empty()) return {};
    return Error{ErrorCode::kCorrupt,
                 fmt::format("{}: {}; no runs left to merge", left_out.front().place, left_out.front().reason)};
}

}  // namespace

Result<MergeReport> merge(const MergeOptions& options, const Progress& progress) {
    Result<OutputFile> out = OutputFile::create(options.output, options.replace);
    if (!out) return out.error();
    RunSetOptions wanted;
    wanted.inputs = options.inputs;
    wanted.skip_duplicates = options.skip_duplicates;
    wanted.keep_going = options.keep_going;
    wanted.job = options.job;
    wanted.verify = VerifyLevel::kQuick;  // before runs are chosen; the rest while they are copied
    wanted.memory = options.memory;
    wanted.announced_reads = options.compact;
    std::unique_ptr<RunSet> chosen;
    std::vector<Step> plan;
    const Threads threads(options.threads);
    Output output(*out, options.verify, options.piece, options.memory, threads, progress);
    // What copying finds damaged is left out, and runs are chosen anew: others may hold the same samples.
    for (;;) {
        Result<std::unique_ptr<RunSet>> opened = RunSet::open(wanted);
        if (!opened) return opened.error();
        if (Status s = check_anything_left(**opened); !s) return s.error();
        if (Status s = check_required(options, **opened); !s) return s.error();
        std::vector<Step> next =
            make_plan(**opened, options.compact, options.memory - std::min(options.memory, (*opened)->list_memory()));
        if (Status s = check_number(next.size()); !s) return s.error();
        if (!chosen) {
            if (Status s = output.begin((*opened)->job()); !s) return s.error();
        } else {
            output.keep(same_steps(*chosen, plan, **opened, next));
        }
        chosen = std::move(*opened);
        plan = std::move(next);
        const Result<std::vector<DamagedRun>> damaged = output.append(*chosen, plan);
        if (!damaged) return damaged.error();
        if (damaged->empty()) break;
        wanted.damaged.insert(wanted.damaged.end(), damaged->begin(), damaged->end());
    }
    const RunSet& run_set = *chosen;
    const Result<std::string> provenance = provenance_of(run_set);
    if (!provenance) return provenance.error();
    if (Status s = output.end(*provenance); !s) return s.error();

    MergeReport report;
    report.output = options.output.string();
    report.compacted = options.compact;
    report.job = run_set.job();
    report.coverage = run_set.coverage();
    report.runs_in = run_set.runs().size();
    report.runs_out = output.runs().size();
    report.bytes = output.size();
    report.run_set = run_set.report();
    std::vector<bool> used(run_set.files().size());
    for (const SelectedRun& run : run_set.runs()) {
        used[run.file] = true;
        report.camera_records += run.header.camera_records;
        report.light_records += run.header.light_records;
    }
    report.files = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
    return report;
}

}  // namespace latent::merge
