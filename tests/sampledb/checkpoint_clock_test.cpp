#include "sampledb/write/checkpoint_clock.h"

#include <gtest/gtest.h>

namespace latent::sampledb {
namespace {

using std::chrono::seconds;

const CheckpointClock::Time kStart{};

TEST(CheckpointClock, IsLateAfterTheInterval) {
    const CheckpointClock clock(60, kStart);
    EXPECT_EQ(clock.late_at(), kStart + seconds(60));
}

TEST(CheckpointClock, ACheckpointIsDueEarlyByTheLongestCommitButNoEarlierThanHalfOfTheInterval) {
    CheckpointClock clock(60, kStart);
    EXPECT_LT(clock.due(), kStart + seconds(60));
    clock.committed(kStart, kStart, kStart + seconds(10));
    clock.committed(kStart, kStart, kStart + seconds(2));
    EXPECT_EQ(clock.due(), kStart + seconds(50));
    clock.committed(kStart, kStart, kStart + seconds(40));
    EXPECT_EQ(clock.due(), kStart + seconds(30));
}

TEST(CheckpointClock, CountsWhatWasRenderedDuringACommit) {
    CheckpointClock clock(60, kStart);
    clock.committed(kStart + seconds(50), kStart + seconds(50), kStart + seconds(55));
    EXPECT_EQ(clock.late_at(), kStart + seconds(110));
}

// Rendering waits from 60 to 150: of the commit's 100 s, 10 were work.
TEST(CheckpointClock, DoesNotCountTheTimeThatRenderingWaited) {
    CheckpointClock clock(60, kStart);
    clock.committed(kStart + seconds(50), kStart + seconds(50), kStart + seconds(150));
    EXPECT_EQ(clock.late_at(), kStart + seconds(200));
}

TEST(CheckpointClock, ACommitThatBeginsLateLeavesNothingAtStake) {
    CheckpointClock clock(60, kStart);
    clock.committed(kStart + seconds(80), kStart + seconds(80), kStart + seconds(90));
    EXPECT_EQ(clock.late_at(), kStart + seconds(150));
}

}  // namespace
}  // namespace latent::sampledb
