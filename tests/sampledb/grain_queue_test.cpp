#include "sampledb/write/grain_queue.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "sampledb/data/grain.h"

namespace latent::sampledb {
namespace {

TEST(GrainQueue, HandsOutEverySampleOnceInOrderAndNeverAcrossTheBorderOfAGrain) {
    Coverage missing(SampleRange{500, 5000});
    missing.add({6000, 6100});
    missing.add({7168, 8192});
    GrainQueue queue(missing);
    Coverage handed_out;
    for (SampleRange grain = queue.next(); !grain.empty(); grain = queue.next()) {
        EXPECT_EQ(grain.first / kGrainSamples, (grain.end - 1) / kGrainSamples);
        EXPECT_TRUE(handed_out.empty() || grain.first >= handed_out.ranges().back().end);
        handed_out.add(grain);
    }
    EXPECT_EQ(handed_out, missing);
    EXPECT_TRUE(queue.next().empty());
    EXPECT_TRUE(GrainQueue(Coverage()).next().empty());
}

TEST(GrainQueue, ThreadsShareTheGrains) {
    const Coverage missing(SampleRange{0, 1000 * kGrainSamples});
    GrainQueue queue(missing);
    std::vector<std::vector<SampleRange>> taken(4);
    std::vector<std::thread> threads;
    for (std::vector<SampleRange>& own : taken) {
        threads.emplace_back([&] {
            for (SampleRange grain = queue.next(); !grain.empty(); grain = queue.next()) own.push_back(grain);
        });
    }
    for (std::thread& thread : threads) thread.join();
    Coverage all;
    std::size_t grains = 0;
    for (const std::vector<SampleRange>& own : taken) {
        grains += own.size();
        for (const SampleRange& grain : own) all.add(grain);
    }
    EXPECT_EQ(grains, 1000u);
    EXPECT_EQ(all, missing);
}

}  // namespace
}  // namespace latent::sampledb
