// tools/inspect/cat.h: records as text, one a line, or as a NumPy array.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/memory.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/run_set.h"

namespace latent::inspect {

enum class CatFormat : std::uint8_t { kCsv, kJsonLines, kNpy };

struct CatOptions {
    std::vector<std::filesystem::path> inputs;
    CatFormat format = CatFormat::kCsv;
    std::vector<std::string> columns;  // for npy, in this order; none: all
    std::optional<sampledb::SampleRange> samples;
    std::optional<sampledb::JobId> job;           // where folders hold several: this one
    std::optional<std::array<double, 4>> region;  // u0, v0, u1, v1 in [0,1]
    std::uint64_t limit = ~std::uint64_t{0};      // records
    std::uint64_t memory = default_memory();
};

// Writes to `out`, in the order of the file: run by run, page by page. Positions are exact fractions of 2^32; wavelengths of jobs
// with a density are written out. Pages that are damaged are left out and listed. npy needs an empty file, to write its header
// last. Errors: those of RunSet::open, kUsage (columns, npy into a pipe), kIo (reading failed, or `out` takes no more).
Result<sampledb::RunSetReport> cat(const CatOptions& options, std::FILE* out);

}  // namespace latent::inspect
