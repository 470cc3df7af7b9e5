// render/program/more_than.h: --more-than: samples after those that finished files hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/result.h"
#include "sampledb/data/job.h"

namespace latent::render {

// The number after the last sample of `inputs`: files, folders and patterns; in the latter two, what is not of the job is skipped.
// The output itself and its attempts may be among them, and do not count: a command that is run again begins where it began.
// Errors: kMismatch (another job), and those of finding and reading a file.
Result<std::uint64_t> end_of_samples(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                                     const sampledb::Job& job);

}  // namespace latent::render
