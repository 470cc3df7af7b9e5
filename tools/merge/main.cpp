// latent-merge: the parts of one job become one file.
#include "base/cli.h"
#include "base/temporary_path.h"
#include "sampledb/data/parse.h"
#include "tools/merge/merge.h"
#include "tools/merge/report.h"

namespace {

using namespace latent;

constexpr const char* kExamples = R"(
Runs are copied as they are, so merging is as fast as copying; where files can share blocks (XFS, btrfs), nothing is copied at all.
Every byte of a run is checked before the run counts: a damaged one is left out and named. So parts may be deleted once
latent-merge is done with status 0. --verify quick looks at headers, indexes and one page of each run; full decodes every record.
Merging waits for the disk, not for the processor: --threads matter to --verify full alone.
The parts may come in any order: the output is the same to the last byte. No sample can be counted twice: a part that is named
twice, or parts that overlap, are refused. Parts found in a folder are simply kept once; what else it holds is listed and left out.

Examples:
  latent-merge night-0.latent night-1.latent -o night.latent       two parts
  latent-merge parts/ -o all.latent                                all parts in a folder, unfinished ones too
  latent-merge parts/ -o complete.latent --require 0:16777216      fail if any of these samples is missing
  latent-merge night.latent -o night-large.latent --compact        many small runs become few large ones: develops faster

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but something damaged or foreign was left out and listed,
or the report could not be written.)";

}  // namespace

int main(int argc, char** argv) try {
    merge::MergeOptions options;
    cli::CommonOptions common;
    CLI::App app{"Join the parts of one job into one file.", "latent-merge"};
    app.footer(kExamples);
    app.add_option("PART", options.inputs, "parts of one job, or folders that hold them, in any order")->required();
    app.add_option("-o,--output", options.output, "the joined file")->required()->check(cli::ends_in(".latent"));
    cli::add_parsed(app, "--require", options.require, sampledb::parse_sample_range, "fail unless samples A .. B-1 are all there")
        ->type_name("A:B");
    using sampledb::VerifyLevel;
    cli::add_choice<VerifyLevel>(
        app, "--verify", options.verify,
        {{"stored", VerifyLevel::kStored}, {"quick", VerifyLevel::kQuick}, {"full", VerifyLevel::kFull}},
        "stored: every byte of every run; quick: headers, indexes and one page; full: every record as well");
    app.add_flag("--compact", options.compact, "rewrite complete intervals as few large runs; records stay exactly the same");
    app.add_flag("--skip-duplicates", options.skip_duplicates, "count parts that were named twice once, instead of refusing them");
    cli::add_parsed(app, "--job", options.job, sampledb::parse_job_id,
                    "where folders hold several jobs: the one to merge (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.replace = common.force;
    options.memory = common.memory;
    options.threads = common.threads;

    remove_temporaries_on_signals();
    const Result<merge::MergeReport> report = merge::merge(options, cli::progress(common, "merging"));
    if (!report) return cli::fail(report.error());
    for (const std::string& note : report->gathering.notes) cli::note(note);
    for (const sampledb::LeftOut& item : report->gathering.left_out) cli::warn(item.place + ": left out: " + item.reason);
    return cli::print_report(common.json ? merge::to_json(*report) : merge::to_text(*report),
                             report->gathering.left_out.empty() ? cli::kDone : cli::kDoneWithLosses);
} catch (...) {
    return latent::cli::fail_with_exception();
}
