#include "render/program/more_than.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/url.h"
#include "sampledb/read/file_reader.h"

namespace latent::render {

namespace fs = std::filesystem;

Result<std::uint64_t> end_of_samples(const std::vector<fs::path>& files, const fs::path& output, const sampledb::Job& job) {
    std::uint64_t end = 0;
    for (const fs::path& path : files) {
        std::error_code ignored;
        if (path == output || fs::equivalent(path, output, ignored)) continue;
        if (fs::is_directory(path, ignored))
            return Error{ErrorCode::kUsage, fmt::format("--more-than {}: a folder; name the files in it", shown_name(path))};
        const Result<sampledb::FoundFile> file = sampledb::open_file(path);
        if (!file) return file.error();
        if (const Status same = sampledb::same_job(file->contents.header.job, job); !same)
            return Error{ErrorCode::kMismatch, fmt::format("--more-than {}: holds {}", shown_name(path), same.error().message)};
        for (const sampledb::RunInfo& run : file->contents.runs) end = std::max(end, run.header.samples.end);
    }
    return end;
}

}  // namespace latent::render
