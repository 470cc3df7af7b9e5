// tools/inspect/gen.h: synthetic files of any size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/write/part_writer.h"
#include "tools/inspect/synthetic.h"

namespace latent::inspect {

struct GenOptions {
    std::filesystem::path output;
    SyntheticScene scene;
    std::uint64_t first = 0;          // sample number, a multiple of the run length
    std::uint64_t records = 1000000;  // samples that have a camera record
    double checkpoint_seconds = 60;
    bool force = false;
    int threads = 0;
};

struct GenReport {
    std::filesystem::path output;
    sampledb::Job job;
    sampledb::WriterCounts counts;
    double seconds = 0;
};

// Writes the part; goes on where an earlier call was interrupted, like every writer. Errors: those of PartWriter, and kUsage if
// there are no so large sample numbers.
Result<GenReport> generate(const GenOptions& options, const Progress& progress = {});

std::string to_text(const GenReport& report);
nlohmann::json to_json(const GenReport& report);

}  // namespace latent::inspect
