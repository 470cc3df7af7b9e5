// latent-inspect: what is in a file, whether it is sound, what can be saved of it, its records as text, its noise; synthetic files.
#include <nlohmann/json.hpp>

#include "base/cli.h"
#include "base/temporary_path.h"
#include "tools/develop/picture/report.h"
#include "tools/inspect/arguments.h"
#include "tools/inspect/cat.h"
#include "tools/inspect/gen.h"
#include "tools/inspect/help.h"
#include "tools/inspect/info.h"
#include "tools/inspect/noise.h"
#include "tools/inspect/print.h"
#include "tools/inspect/recover.h"
#include "tools/inspect/verify.h"

namespace {

using namespace latent;
using namespace latent::inspect;
using Paths = std::vector<std::filesystem::path>;

cli::CommonOptions common;

int run_info(const Paths& named) {
    return print_each(named, common.json, [](const std::filesystem::path& path) { return read_info(path, common.memory); });
}

int run_verify(const Paths& named, sampledb::VerifyLevel level, bool strict) {
    return print_each(named, common.json, [=](const std::filesystem::path& path) {
        return verify(path, level, strict, common.threads, cli::progress(common, "verifying"));
    });
}

int run_recover(const std::filesystem::path& input, const std::filesystem::path& output) {
    const Result<RecoverReport> report = recover(input, output, common.force, cli::progress(common, "recovering"));
    if (!report) return cli::fail(report.error());
    return cli::print_report(text_of(*report, common.json), report->lost_anything() ? cli::kDoneWithLosses : cli::kDone);
}

int run_cat(const CatOptions& options) {
    const Result<sampledb::RunSetReport> report = cat(options, stdout);
    if (!report) return cli::fail(report.error());
    for (const std::string& note : report->notes) cli::note(note);
    for (const sampledb::LeftOut& item : report->left_out) cli::warn(item.place + ": left out: " + item.reason);
    return report->left_out.empty() ? cli::kDone : cli::kDoneWithLosses;
}

int run_noise(NoiseOptions options) {
    options.force = common.force;
    options.picture.threads = common.threads;
    const Result<NoiseReport> report = look_for_noise(options, cli::progress(common, "developing"));
    if (!report) return cli::fail(report.error());
    const develop::PictureReport& picture = report->noise.picture;
    for (const std::string& note : picture.run_set.notes) cli::note(note);
    for (const std::string& loss : develop::losses(picture)) cli::warn(loss);
    return cli::print_report(text_of(*report, common.json), picture.has_losses() ? cli::kDoneWithLosses : cli::kDone);
}

int run_gen(GenOptions options) {
    options.force = common.force;
    options.threads = common.threads;
    const Result<GenReport> report = generate(options, cli::progress(common, "generating"));
    if (!report) return cli::fail(report.error());
    return cli::print_report(text_of(*report, common.json), cli::kDone);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Show, verify, recover, print, measure or generate .latent files.", "latent-inspect"};
    app.require_subcommand(1)->fallthrough()->footer(help::kTool);
    cli::add_common(app, common, false);
    Paths files;
    std::filesystem::path output;
    CatOptions cat_options;
    NoiseOptions noise_options;
    GenOptions gen_options;
    bool quick = false, deep = false, strict = false;

    CLI::App* info = app.add_subcommand("info", "Show the contents of files.")->footer(help::kInfo);
    info->add_option("FILE", files, ".latent files, finished or not, their http(s) URLs, or folders of files")->required();
    cli::add_memory(*info, common.memory, "memory limit for the list of runs");

    CLI::App* verify = app.add_subcommand("verify", "Check files for damage.")->footer(help::kVerify);
    verify->add_option("FILE", files, ".latent files, finished or not, their http(s) URLs, or folders of files")->required();
    CLI::Option* quick_flag = verify->add_flag("--quick", quick, "check only headers, indexes and one page of each run");
    verify->add_flag("--deep", deep, "decode and check every record, in addition to every byte")->excludes(quick_flag);
    verify->add_flag("--strict", strict, "like --deep, and list violations of the rules for writers")->excludes(quick_flag);

    CLI::App* recover = app.add_subcommand("recover", "Copy the intact runs of a damaged file.")->footer(help::kRecover);
    recover->add_option("FILE", files, "damaged file; it is not changed")->required()->expected(1);
    recover->add_option("-o,--output", output, "file to write")->required()->check(cli::ends_in(".latent"));

    CLI::App* cat = app.add_subcommand("cat", "Print records as text or as a NumPy array.")->footer(help::kCat);
    add_cat_options(*cat, cat_options);

    CLI::App* noise = app.add_subcommand("noise", "Measure noise, and forecast what less takes.")->footer(help::kNoise);
    add_noise_options(*noise, noise_options);

    CLI::App* gen = app.add_subcommand("gen", "Generate a synthetic file for tests.")->footer(help::kGen);
    add_gen_options(*gen, gen_options);

    if (const auto done = cli::parse(app, argc, argv)) return *done;
    remove_temporaries_on_signals();
    if (common.json) cat_options.format = CatFormat::kJsonLines;
    if (*info) return run_info(files);
    using sampledb::VerifyLevel;
    if (*verify) {
        return run_verify(files, quick ? VerifyLevel::kQuick : deep || strict ? VerifyLevel::kFull : VerifyLevel::kStored, strict);
    }
    if (*recover) return run_recover(files.front(), output);
    if (*cat) return run_cat(cat_options);
    if (*noise) return run_noise(noise_options);
    return run_gen(gen_options);
} catch (...) {
    return latent::cli::fail_with_exception();
}
