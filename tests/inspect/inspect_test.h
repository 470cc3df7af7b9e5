// tests/inspect/inspect_test.h: latent-inspect run on files in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent::inspect {

inline std::vector<sampledb::Coverage> four_runs() {
    constexpr std::uint64_t kS = synthetic::kShortRun;
    return synthetic::runs_between({0, kS, 2 * kS, 3 * kS, 3 * kS + 500});
}

class InspectTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;

    testing::Outcome inspect(std::vector<std::string> words) const {
        words.insert(words.begin(), testing::tool("latent-inspect"));
        return testing::run(words);
    }
    std::filesystem::path write(const std::string& name, ByteSpan bytes) const {
        synthetic::write_file(folder_ / name, bytes);
        return folder_ / name;
    }
};

}  // namespace latent::inspect
