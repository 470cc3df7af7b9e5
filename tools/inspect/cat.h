// tools/inspect/cat.h: records as text, one a line.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/gathering.h"

namespace latent::inspect {

enum class TextFormat : std::uint8_t { kCsv, kJsonLines };

struct CatOptions {
    std::vector<std::filesystem::path> inputs;
    TextFormat format = TextFormat::kCsv;
    std::optional<sampledb::SampleRange> samples;
    std::optional<sampledb::JobId> job;           // where folders hold several: this one
    std::optional<std::array<double, 4>> region;  // u0, v0, u1, v1 in [0,1]
    std::uint64_t limit = ~std::uint64_t{0};      // records
    std::uint64_t memory = std::uint64_t{1} << 30;
};

// Writes to `out`, in the order of the file: run by run, page by page. Positions are exact fractions of 2^32; wavelengths of jobs
// with a density are written out. Pages that are damaged are left out and listed.
// Errors: those of Gathering::open, kIo (reading failed, or `out` takes no more).
Result<sampledb::GatherReport> cat(const CatOptions& options, std::FILE* out);

}  // namespace latent::inspect
