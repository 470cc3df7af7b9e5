#include "tools/inspect/damage.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::inspect {

using namespace sampledb;

bool is_damage(const Error& error) { return error.code == ErrorCode::kCorrupt || error.code == ErrorCode::kTruncated; }

Damage lost_run(std::size_t number, const RunInfo& run, const Error& why) {
    return {run.offset, run.header.size(),
            fmt::format("run {} at byte {}: {}; samples {}..{} lost", number, run.offset, why.message, run.header.samples.first,
                        run.header.samples.end)};
}

Result<std::vector<RunInfo>> runs_that_only_the_footer_knows(const ByteSource& source, const FileContents& walked) {
    if (!walked.finished) return std::vector<RunInfo>{};
    const Result<FileContents> by_footer = read_file(source);
    if (!by_footer) return by_footer.error();
    std::vector<RunInfo> runs;
    for (const RunInfo& run : by_footer->runs) {
        if (std::ranges::find(walked.runs, run.offset, &RunInfo::offset) == walked.runs.end()) runs.push_back(run);
    }
    return runs;
}

Damage lost_with_its_header(const RunInfo& run) {
    return {run.offset, run.header.size(),
            fmt::format("run at byte {}: its header is damaged; samples {}..{} lost", run.offset, run.header.samples.first,
                        run.header.samples.end)};
}

}  // namespace latent::inspect
