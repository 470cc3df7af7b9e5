#include <gtest/gtest.h>

#include <fstream>

#include "tests/faults/process.h"

namespace latent::testing {
namespace {

class Faults : public ::testing::Test {
 protected:
    TemporaryFolder folder_;
    const std::string content_ = std::string(10000, 'x');
    void SetUp() override { std::ofstream(folder_ / "source") << content_; }
    FaultOutcome probe(const std::string& rule) {
        return run_with_fault({tool("fault_probe"), folder_ / "source", folder_ / "target"}, {rule, folder_.path().string()});
    }
    bool published_whole() const { return read_text(folder_ / "target") == std::string(5000, '\7') + content_; }
};

TEST_F(Faults, WithoutARuleNothingHappens) {
    const FaultOutcome outcome = probe("");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_FALSE(outcome.happened);
    EXPECT_TRUE(published_whole());
}

TEST_F(Faults, EveryFailureIsReportedWithTheFileNamedAndLeavesNoOutput) {
    for (const char* rule :
         {"create:1+:EACCES", "write:1:ENOSPC", "write:1:EIO", "copy:1:ENOSPC", "read:1:EIO", "sync:1:EIO", "link:1:EROFS"}) {
        const FaultOutcome outcome = probe(rule);
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(outcome.status, 1) << rule;
        EXPECT_NE(outcome.err.find("target"), std::string::npos) << rule << ": " << outcome.err;
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"source"}) << rule;
    }
}

TEST_F(Faults, ShortTransfersInterruptionsAndMissingKernelCopiesAreOvercome) {
    for (const char* rule :
         {"write:1:short", "write:1:EINTR", "read:1:short", "copy:1:short", "copy:1:EINTR", "copy:1:zero", "copy:1:EXDEV"}) {
        const FaultOutcome outcome = probe(rule);
        EXPECT_TRUE(outcome.happened) << rule;
        EXPECT_EQ(outcome.status, 0) << rule << ": " << outcome.err;
        EXPECT_TRUE(published_whole()) << rule;
        std::filesystem::remove(folder_ / "target");
    }
}

TEST_F(Faults, AKilledProcessLeavesNoHalfOutput) {
    EXPECT_EQ(probe("link:1:kill").status, 128 + 9);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"source"});
    EXPECT_EQ(probe("link:1:kill-after").status, 128 + 9);
    EXPECT_TRUE(published_whole());
}

TEST_F(Faults, AFlippedBitReachesTheReader) { EXPECT_EQ(probe("read:1:flip").status, 3); }

}  // namespace
}  // namespace latent::testing
