#include "sampledb/write/grain_window.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "sampledb/data/grain.h"

namespace latent::sampledb {
namespace {

using Clock = CheckpointClock::Clock;
using Time = GrainWindow::Time;

constexpr SampleRange kRange{0, 8 * kGrainSamples};

SampleRange nth(std::uint64_t number) { return {number * kGrainSamples, (number + 1) * kGrainSamples}; }

// A grain of 8 MiB or a little more.
Grain heavy(std::uint64_t number) {
    Grain grain{nth(number), {}};
    grain.records.sample.resize(std::size_t{1} << 20);
    return grain;
}

TEST(GrainWindow, GrainsLeaveInOrderWhateverTheOrderTheyComeIn) {
    GrainWindow window(Coverage(kRange), kRange);
    for (const std::uint64_t number : {3u, 1u, 0u, 2u}) ASSERT_TRUE(window.put({nth(number), {}}));
    for (std::uint64_t number = 0; number < 4; ++number)
        EXPECT_EQ(window.take(nth(number).first, Time::max()).grain->range, nth(number));
    EXPECT_EQ(window.unsubmitted(), Coverage(SampleRange{nth(4).first, kRange.end}));
}

TEST(GrainWindow, WhatIsNotAMissingGrainIsRefused) {
    Coverage missing(kRange);
    missing.remove(nth(2));
    GrainWindow window(missing, kRange);
    ASSERT_TRUE(window.put({nth(1), {}}));
    for (const SampleRange wrong : {nth(1), nth(2), SampleRange{5, 1029}, SampleRange{3072, 4000}, SampleRange{3072, 3072}, nth(8)})
        EXPECT_EQ(window.put({wrong, {}}).error().code, ErrorCode::kOutOfRange) << wrong.first;
}

TEST(GrainWindow, TheOldestMissingGrainFindsRoomWhenNoOtherDoes) {
    const SampleRange range{0, 64 * kGrainSamples};
    GrainWindow window(Coverage(range), range);
    std::atomic<std::uint64_t> behind = 0;
    std::thread ahead([&] {
        for (std::uint64_t number = 1; number < 24; ++number, ++behind) EXPECT_TRUE(window.put(heavy(number)));
    });
    while (behind < 7) std::this_thread::yield();
    ASSERT_TRUE(window.put(heavy(0)));
    for (std::uint64_t number = 0; number < 24; ++number)
        EXPECT_EQ(window.take(nth(number).first, Time::max()).grain->range, nth(number));
    ahead.join();
}

TEST(GrainWindow, AfterTheDeadlineWhatWasInOrderIsTakenAndNothingMoreUntilItIsSaved) {
    GrainWindow window(Coverage(kRange), kRange);
    for (const std::uint64_t number : {0u, 1u, 3u}) ASSERT_TRUE(window.put({nth(number), {}}));
    const Time deadline = Clock::now();
    EXPECT_TRUE(window.take(nth(0).first, deadline).grain);
    ASSERT_TRUE(window.put({nth(2), {}}));
    EXPECT_TRUE(window.take(nth(1).first, deadline).grain);
    EXPECT_FALSE(window.take(nth(2).first, deadline).grain);
    window.saved(nth(1).end, Time::max());
    EXPECT_TRUE(window.take(nth(2).first, Time::max()).grain);
    EXPECT_TRUE(window.take(nth(3).first, Clock::now()).grain);
    EXPECT_FALSE(window.take(nth(4).first, Clock::now() + std::chrono::milliseconds(1)).grain);
}

TEST(GrainWindow, AFlushAsksForACheckpointAtTheFirstGapAndNotBefore) {
    GrainWindow window(Coverage(kRange), kRange);
    for (const std::uint64_t number : {0u, 1u, 3u}) ASSERT_TRUE(window.put({nth(number), {}}));
    std::thread flushing([&] { window.flush(); });
    for (std::uint64_t number = 0; number < 2; ++number) EXPECT_TRUE(window.take(nth(number).first, Time::max()).grain);
    EXPECT_FALSE(window.take(nth(2).first, Time::max()).grain);
    window.saved(nth(2).first, Time::max());
    flushing.join();
}

TEST(GrainWindow, RenderersWaitFromTheMomentThatTheDiskIsLateUntilTheirGrainsAreSaved) {
    GrainWindow window(Coverage(kRange), kRange);
    window.saved(0, Clock::now());
    std::atomic<int> returned = 0;
    std::vector<std::thread> renderers;
    for (std::uint64_t number = 0; number < 3; ++number) {
        renderers.emplace_back([&, number] {
            EXPECT_TRUE(window.put({nth(number), {}}));
            ++returned;
        });
    }
    for (std::uint64_t number = 0; number < 3; ++number) EXPECT_TRUE(window.take(nth(number).first, Time::max()).grain);
    window.saved(nth(1).end, Clock::now());  // one of three is not on disk
    EXPECT_EQ(returned, 0);
    window.saved(nth(2).end, Clock::now());
    for (std::thread& renderer : renderers) renderer.join();
    EXPECT_EQ(returned, 3);
}

TEST(GrainWindow, ClosingEndsEveryWait) {
    const SampleRange range{0, 64 * kGrainSamples};
    GrainWindow window(Coverage(range), range);
    std::vector<std::thread> waiting;
    waiting.emplace_back([&] { EXPECT_FALSE(window.take(0, Time::max()).grain); });
    waiting.emplace_back([&] {
        Status status;
        for (std::uint64_t number = 1; status; ++number) status = window.put(heavy(number));
        EXPECT_EQ(status.error().code, ErrorCode::kStopped);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    window.close();
    for (std::thread& thread : waiting) thread.join();
    window.flush();
    EXPECT_EQ(window.put({nth(0), {}}).error().code, ErrorCode::kStopped);
}

}  // namespace
}  // namespace latent::sampledb
