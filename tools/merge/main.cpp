// latent-merge: the parts of one job become one file.
#include "base/cli.h"
#include "base/temporary_path.h"
#include "sampledb/data/parse.h"
#include "tools/merge/merge.h"
#include "tools/merge/report.h"

namespace {

using namespace latent;

constexpr const char* kExamples = R"(
The order of parts makes no difference: the output is the same to the last byte.
No sample is counted twice: if two named parts hold the same samples, they are
refused, unless --skip-duplicates is given. If a folder holds several jobs,
choose one with --job.

Folders may hold thousands of parts, finished or not. Other files in them, such
as logs, are listed, but do not count as losses. A named input must be usable,
unless --keep-going is given. --require is checked before anything is written.

Runs are copied unchanged. On XFS and btrfs the output shares its blocks with
the parts. The copies are verified; damaged runs are left out and listed. After
exit status 0 the parts can be deleted, unless --verify quick was used.

Levels of --verify:
  quick    headers, indexes and one page of each run
  stored   every byte, by its checksum
  full     every byte, and every record is decoded

Only --verify full and --compact use --threads.

Examples:
  latent-merge night-0.latent night-1.latent -o night.latent
      join two parts
  latent-merge parts/ -o all.latent
      join all parts in a folder, unfinished ones included
  latent-merge parts/ -o complete.latent --require 0:16777216
      fail if any of these samples is missing
  latent-merge night.latent -o night-large.latent --compact
      turn many small runs into a few large ones, which develop faster

Exit status: 0 done; 1 failed, no output; 2 wrong usage; 3 done, but damaged or
foreign input was left out and listed, or the report could not be written.)";

}  // namespace

int main(int argc, char** argv) try {
    merge::MergeOptions options;
    cli::CommonOptions common;
    CLI::App app{"Join the parts of one job into one file.", "latent-merge"};
    app.footer(kExamples);
    app.add_option("PART", options.inputs, "parts of one job, their http(s) URLs, or folders of parts")->required();
    app.add_option("-o,--output", options.output, "file to write")->required()->check(cli::ends_in(".latent"));
    cli::add_parsed(app, "--require", options.require, sampledb::parse_sample_range,
                    "samples that must be present, A to B-1; if any is missing, nothing is written")
        ->type_name("A:B");
    using sampledb::VerifyLevel;
    cli::add_choice<VerifyLevel>(app, "--verify", options.verify,
                                 {{"stored", VerifyLevel::kStored}, {"quick", VerifyLevel::kQuick}, {"full", VerifyLevel::kFull}},
                                 "level of verification; see below");
    app.add_flag("--compact", options.compact, "rewrite many small runs as a few large ones; records do not change");
    app.add_flag("--skip-duplicates", options.skip_duplicates, "accept parts that hold the same samples; each sample is used once");
    app.add_flag("--keep-going", options.keep_going, "leave out and list every input that cannot be used, even if it was named");
    cli::add_parsed(app, "--job", options.job, sampledb::parse_job_id,
                    "job to merge, if folders hold several (32 hexadecimal digits)")
        ->type_name("ID");
    cli::add_common(app, common, true);
    if (const auto done = cli::parse(app, argc, argv)) return *done;

    options.replace = common.force;
    options.memory = common.memory;
    options.threads = common.threads;

    remove_temporaries_on_signals();
    const Result<merge::MergeReport> report = merge::merge(options, cli::progress(common, "merging"));
    if (!report) return cli::fail(report.error());
    for (const std::string& note : report->run_set.notes) cli::note(note);
    for (const sampledb::LeftOut& item : report->run_set.left_out) cli::warn(item.place + ": left out: " + item.reason);
    return cli::print_report(common.json ? merge::to_json(*report) : merge::to_text(*report),
                             report->run_set.left_out.empty() ? cli::kDone : cli::kDoneWithLosses);
} catch (...) {
    return latent::cli::fail_with_exception();
}
