// tests/support/gathered.h: what readers select of files, every record of it decoded and checked.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "sampledb/read/gathering.h"

namespace latent::synthetic {

// Fails the test, and is null, if the files cannot be gathered; fails it as well if anything of them is left out.
inline std::unique_ptr<sampledb::Gathering> gather(const std::vector<std::filesystem::path>& inputs,
                                                   sampledb::VerifyLevel verify = sampledb::VerifyLevel::kFull) {
    sampledb::GatherOptions options;
    options.inputs = inputs;
    options.verify = verify;
    auto gathering = sampledb::Gathering::open(options);
    EXPECT_TRUE(gathering) << gathering.error().message;
    if (!gathering) return nullptr;
    for (const sampledb::LeftOut& left : (*gathering)->report().left_out) ADD_FAILURE() << left.place << ": " << left.reason;
    return std::move(*gathering);
}

// A run by what it holds, whatever file it is in.
struct RunContent {
    sampledb::Coverage coverage;
    Hash128 hash;
    bool operator==(const RunContent&) const = default;
};

inline std::vector<RunContent> runs_of(const sampledb::Gathering& gathering) {
    std::vector<RunContent> runs;
    for (const sampledb::SelectedRun& run : gathering.runs()) runs.push_back({run.coverage, run.header.content_hash});
    return runs;
}
inline std::vector<RunContent> runs_of(const std::filesystem::path& file) {
    const auto gathering = gather({file});
    return gathering ? runs_of(*gathering) : std::vector<RunContent>{};
}

}  // namespace latent::synthetic
