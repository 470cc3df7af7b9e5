// tools/inspect/verify.h: is every byte of a file as it was written?
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/file_reader.h"

namespace latent::inspect {

enum class Depth : std::uint8_t {
    kQuick,  // headers, indexes, one page of each run
    kPages,  // every stored byte
    kDeep,   // and every record, decoded: place, order, sample number, finite values
};

struct VerifyReport {
    std::filesystem::path path;
    Depth depth = Depth::kPages;
    std::uint64_t size = 0, runs = 0, pages = 0, records = 0;
    bool finished = false;
    std::uint64_t unfinished_tail = 0;
    std::vector<std::string> damage;  // in the order of the file; empty: the file is sound
    std::uint64_t not_finite = 0;     // deep: values that are NaN or infinite (data, not damage)
};

// Errors: kNotFound, kForeign, kUnsupported, kIo. A file whose header cannot be read is damage, not an error.
// Runs are read by `threads` threads at once (0: one for each processor).
Result<VerifyReport> verify(const std::filesystem::path& path, Depth depth, int threads, const Progress& progress = {});

std::string to_text(const VerifyReport& report);
nlohmann::json to_json(const VerifyReport& report);

}  // namespace latent::inspect
