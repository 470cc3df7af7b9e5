#include "render/program/more_than.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/url.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/input_files.h"
#include "sampledb/read/part_name.h"

namespace latent::render {

namespace fs = std::filesystem;

Result<std::uint64_t> end_of_samples(const std::vector<fs::path>& inputs, const fs::path& output, const sampledb::Job& job) {
    std::vector<fs::path> others = inputs;
    std::erase(others, output);  // which may not be there yet
    const Result<std::vector<sampledb::InputFile>> files = sampledb::list_input_files(others);
    if (!files) return files.error();
    std::vector<fs::path> own = sampledb::attempts_of(output);
    own.push_back(output);
    std::uint64_t end = 0;
    for (const sampledb::InputFile& input : *files) {
        const auto is_input = [&](const fs::path& path) {
            std::error_code ignored;
            return path == input.path || fs::equivalent(path, input.path, ignored);
        };
        if (std::ranges::any_of(own, is_input)) continue;
        const Result<sampledb::FoundFile> file = sampledb::open_file(input.path);
        if (!file && !input.named && file.error().code == ErrorCode::kForeign) continue;
        if (!file) return file.error();
        if (const Status same = sampledb::same_job(file->contents.header.job, job); !same) {
            if (!input.named) continue;
            return Error{ErrorCode::kMismatch,
                         fmt::format("--more-than {}: holds {}", shown_name(input.path), same.error().message)};
        }
        for (const sampledb::RunInfo& run : file->contents.runs) end = std::max(end, run.header.samples.end);
    }
    return end;
}

}  // namespace latent::render
