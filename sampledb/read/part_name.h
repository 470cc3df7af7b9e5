// sampledb/read/part_name.h: what lies under a name: NAME.latent, once published, and the attempts at it, NAME.latent.part.<nonce>.
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/file_reader.h"

namespace latent::sampledb {

// Whether the name is that of an attempt, NAME.latent.part.<nonce>: a file that may lack its footer.
bool is_attempt(const std::filesystem::path& path);

// A name for a new attempt at `name` (NAME.latent).
std::filesystem::path new_attempt(const std::filesystem::path& name);
// Errors: kUsage: the name leaves no room for that of an attempt.
Status check_length(const std::filesystem::path& name);

// The attempts under `name` (NAME.latent), in the order of their names.
std::vector<std::filesystem::path> attempts_of(const std::filesystem::path& name);

// Errors: kMismatch, naming both jobs and what the user can do.
Status check_same_job(const FoundFile& file, const Job& job);

// All sample numbers that a file's runs hold.
Result<Coverage> coverage_of(const ByteSource& source, const FileContents& contents);

// What NAME.latent holds of a range: there is no such file; samples of the range alone, but not all; all of it, and maybe others.
enum class Published { kNot, kInPart, kWhole };

// Errors: kMismatch (another job; not all of the range, but samples beyond it), and those of reading the file.
Result<Published> look_at_published(const std::filesystem::path& name, const Job& job, SampleRange range);

// Whatever NAME.latent is by now, it becomes an attempt: another file can take its name, and nothing is lost. No error if it is
// gone.
Status make_attempt_of(const std::filesystem::path& name);

// Removes the attempts of this job whose runs NAME.latent, which holds `covered`, has made superfluous.
void remove_superfluous_attempts(const std::filesystem::path& name, const Job& job, const Coverage& covered);

// Removes NAME.latent and every attempt at it.
Status remove_everything(const std::filesystem::path& name);

}  // namespace latent::sampledb
