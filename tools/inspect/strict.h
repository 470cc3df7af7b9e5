// tools/inspect/strict.h: verify --strict: does a file follow the rules that readers rely on and need not check? docs/format.md,
// "What only writers can get right".
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/read/file_reader.h"
#include "tools/inspect/violation.h"

namespace latent::inspect {

// Reserved bytes, names and provenance of the header; provenance of the footer. Errors: kIo.
Result<Violations> check_header_strictly(const sampledb::ByteSource& source, const sampledb::FileContents& file);

// Order, page cut, squares, reserved fields, padding and shares of the `number`th run, which is known to be sound in full.
// Errors: those of reading it.
Result<Violations> check_run_strictly(const sampledb::ByteSource& source, std::size_t number, const sampledb::RunInfo& run,
                                      const sampledb::Job& job);

// Why a run's boundaries are not those that other writers would choose; "" if they may be. That is allowed, but worth a note.
std::string boundary_note(const sampledb::RunHeader& run, const sampledb::Job& job);

// Runs of the same samples with other records.
Violations check_runs_against_each_other(const std::vector<sampledb::RunInfo>& runs);

}  // namespace latent::inspect
