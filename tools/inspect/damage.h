// tools/inspect/damage.h: how what is lost of a file is told: by run, byte and sample numbers.
#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/file_reader.h"

namespace latent::inspect {

// Whether an error is about the bytes of a file, not about reading them.
bool is_damage(const Error& error);

// The `number`th run of a file is lost, and why.
sampledb::Damage lost_run(std::size_t number, const sampledb::RunInfo& run, const Error& why);

// Runs that a finished file's footer lists and that a walk from run to run did not meet: their headers are damaged.
// Errors: those of read_file.
Result<std::vector<sampledb::RunInfo>> runs_that_only_the_footer_knows(const sampledb::ByteSource& source,
                                                                       const sampledb::FileContents& walked);
sampledb::Damage lost_with_its_header(const sampledb::RunInfo& run);

}  // namespace latent::inspect
