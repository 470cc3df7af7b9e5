// The merging part of latent.h.
#include "tools/merge/merge.h"

#include <array>

#include "base/memory.h"
#include "base/printable.h"
#include "c_api/abi.h"

using namespace latent;

namespace {

Result<merge::MergeOptions> merge_options(const char* const* paths, size_t count, const char* output,
                                          const latent_merge_options& given) {
    merge::MergeOptions merge;
    if (paths == nullptr || count == 0) return latent::usage_error("no paths");
    for (size_t i = 0; i < count; ++i) {
        if (paths[i] == nullptr) return latent::usage_error("a path is null");
        merge.inputs.emplace_back(paths[i]);
    }
    if (output == nullptr) return latent::usage_error("output is null");
    merge.output = output;
    if (merge.output.extension() != ".latent")
        return latent::usage_error(std::string(output) + ": the name does not end in .latent");
    constexpr std::array kLevels = {sampledb::VerifyLevel::kStored, sampledb::VerifyLevel::kQuick, sampledb::VerifyLevel::kFull};
    if (given.verify >= kLevels.size()) return Error{ErrorCode::kUnsupported, "options.verify is not a level of this version"};
    merge.verify = kLevels[given.verify];
    merge.replace = given.replace != 0;
    merge.skip_duplicates = given.skip_duplicates != 0;
    merge.keep_going = given.keep_going != 0;
    merge.compact = given.compact != 0;
    if (given.threads > INT32_MAX) return Error{ErrorCode::kOutOfRange, "options.threads is too large"};
    merge.threads = static_cast<int>(given.threads);
    merge.memory = given.memory != 0 ? given.memory : default_memory();
    if (given.require.first != 0 || given.require.end != 0) {
        merge.require = sampledb::SampleRange{given.require.first, given.require.end};
        if (merge.require->empty()) return latent::usage_error("options.require is empty");
    }
    if (given.job_low != 0 || given.job_high != 0) merge.job = sampledb::JobId{given.job_low, given.job_high};
    return merge;
}

}  // namespace

latent_status latent_merge(const char* const* paths, size_t count, const char* output, const latent_merge_options* options,
                           latent_merge_info* info, latent_error* error) {
    return c::guarded(error, [&]() -> Status {
        latent_merge_options given{};
        if (options != nullptr) {
            const Result<latent_merge_options> known = c::taken(options, sizeof(latent_merge_options), "options");
            if (!known) return known.error();
            given = *known;
        }
        if (info != nullptr) {
            if (const auto fits = c::taken(info, sizeof(latent_merge_info), "info"); !fits) return fits.error();
        }
        const Result<merge::MergeOptions> merge = merge_options(paths, count, output, given);
        if (!merge) return merge.error();
        Progress progress;
        if (given.progress != nullptr) progress = [&](double done, const std::string&) { given.progress(given.context, done); };
        const Result<merge::MergeReport> report = merge::merge(*merge, progress);
        if (!report) return report.error();
        for (const sampledb::LeftOut& item : report->run_set.left_out) {
            if (given.left_out != nullptr) given.left_out(given.context, printable_line(item.place + ": " + item.reason).c_str());
        }
        if (info == nullptr) return {};
        latent_merge_info value{};
        value.samples = report->coverage.size();
        value.files = report->files;
        value.runs_in = report->runs_in, value.runs_out = report->runs_out;
        value.camera_records = report->camera_records, value.light_records = report->light_records;
        value.bytes = report->bytes;
        value.left_out = report->run_set.left_out.size();
        return c::give(value, info, sizeof(latent_merge_info), "info");
    });
}
