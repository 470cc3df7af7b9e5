// tests/support/opened_runs.h: what readers select of files, every record of it decoded and checked.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "sampledb/read/run_set.h"

namespace latent::synthetic {

// Fails the test, and is null, if the files cannot be opened; fails it as well if anything of them is left out.
inline std::unique_ptr<sampledb::RunSet> open_runs(const std::vector<std::filesystem::path>& inputs,
                                                   sampledb::VerifyLevel verify = sampledb::VerifyLevel::kFull) {
    sampledb::RunSetOptions options;
    options.inputs = inputs;
    options.verify = verify;
    auto run_set = sampledb::RunSet::open(options);
    EXPECT_TRUE(run_set) << run_set.error().message;
    if (!run_set) return nullptr;
    for (const sampledb::LeftOut& left : (*run_set)->report().left_out) ADD_FAILURE() << left.place << ": " << left.reason;
    return std::move(*run_set);
}

// A run by what it holds, whatever file it is in.
struct RunContent {
    sampledb::Coverage coverage;
    Hash128 hash;
    bool operator==(const RunContent&) const = default;
};

inline std::vector<RunContent> runs_of(const sampledb::RunSet& run_set) {
    std::vector<RunContent> runs;
    for (const sampledb::SelectedRun& run : run_set.runs()) runs.push_back({run.coverage, run.header.content_hash});
    return runs;
}
inline std::vector<RunContent> runs_of(const std::filesystem::path& file) {
    const auto run_set = open_runs({file});
    return run_set ? runs_of(*run_set) : std::vector<RunContent>{};
}

}  // namespace latent::synthetic
