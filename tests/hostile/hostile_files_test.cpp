// Files that try to make a tool take much memory, or fail: a share of those that bench/hostile_files runs.
#include <gtest/gtest.h>

#include "tests/faults/process.h"
#include "tests/support/sanitizers.h"

namespace latent {
namespace {

TEST(HostileFiles, NoToolFailsOrTakesMuchMemory) {
    const char* const memory = testing::kSanitized ? "100000" : "164";
    const std::string tools = std::filesystem::path(testing::tool("latent-inspect")).parent_path();
    const testing::Outcome outcome =
        testing::run_python("tests/hostile/run_hostile_files.py", {tools, "--small", "--memory", memory});
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

}  // namespace
}  // namespace latent
