// tools/inspect/verify.h: is every byte of a file as it was written?
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/read/file_reader.h"
#include "tools/inspect/violation.h"

namespace latent::inspect {

struct VerifyReport {
    std::filesystem::path path;
    sampledb::VerifyLevel level = sampledb::VerifyLevel::kStored;
    std::uint64_t size = 0, runs = 0, pages = 0, records = 0;
    bool finished = false;
    std::uint64_t unfinished_tail = 0;
    std::vector<std::string> damage;  // in the order of the file; empty: the file is sound
    std::uint64_t not_finite = 0;     // kFull: values that are NaN or infinite (data, not damage)
    bool strict = false;
    std::vector<std::string> notes;  // strict: what is allowed, and unusual
    Violations violations;           // strict: rules that are broken, though every reader reads the file
};

// Errors: kNotFound, kForeign, kUnsupported, kIo. A file whose header cannot be read is damage, not an error.
// Runs are read by `threads` threads at once (0: one for each processor). `strict`, at level kFull: looks for violations, too.
Result<VerifyReport> verify(const std::filesystem::path& path, sampledb::VerifyLevel level, bool strict, int threads,
                            const Progress& progress = {});

std::string to_text(const VerifyReport& report);
nlohmann::json to_json(const VerifyReport& report);

}  // namespace latent::inspect
