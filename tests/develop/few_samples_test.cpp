// Pixels of few samples take the filter's non-negative part, from records that are looked through, or decoded, a second time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sampledb/codec/page_decoder.h"
#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::Records;

constexpr std::uint64_t kMebibyte = 1 << 20;

// A part of the film where only every hundredth record is kept.
struct Gap {
    double u0, v0, u1, v1;
};

// Runs of camera and a few light records at random positions, as foreign writers store them, thinned out in the gaps.
MemoryRunSet make_run_set(int runs, std::uint32_t per_run, const std::vector<Gap>& gaps) {
    Job job = synthetic::make_job(sampledb::RecordKind::kXyz);
    job.positions = {};
    MemoryRunSet run_set(job);
    std::mt19937 random(3);
    for (int run = 0; run < runs; ++run) {
        Records records;
        const std::uint64_t first = static_cast<std::uint64_t>(run) * per_run;
        for (std::uint32_t i = 0; i < per_run; ++i) {
            const auto u = static_cast<std::uint32_t>(random()), v = static_cast<std::uint32_t>(random());
            const bool in_gap = std::ranges::any_of(gaps, [&](const Gap& gap) {
                return u >= gap.u0 * 0x1p32 && u < gap.u1 * 0x1p32 && v >= gap.v0 * 0x1p32 && v < gap.v1 * 0x1p32;
            });
            if (in_gap && random() % 100 > 0) continue;
            const bool light = random() % 32 == 0;
            records.sample.push_back(first + i);
            records.record_class.push_back(light ? RecordClass::kLight : RecordClass::kCamera);
            records.u.push_back(u);
            records.v.push_back(v);
            records.share.push_back(light ? 0.0f : 1.0f);
            for (std::vector<float>* column : {&records.x, &records.y, &records.z})
                column->push_back(std::ldexp(static_cast<float>(random()), -32));
        }
        run_set.add(Coverage({first, first + per_run}), records);
    }
    return run_set;
}

struct Totals {
    std::uint64_t regions = 0, batches = 0, decoded_again = 0;
};

// Develops with all memory, then with little: no bit changes. Returns what little memory led to.
Totals expect_the_same_with_little_memory(const MemoryRunSet& run_set, Settings settings) {
    settings.memory = 2048 * kMebibyte;
    const Developed whole = develop_in_memory(run_set, settings, 1);
    EXPECT_EQ(whole.counts.batches, 1u);
    EXPECT_EQ(whole.counts.pages_decoded, whole.counts.pages);
    EXPECT_GT(whole.counts.fallback_pixels, 10u);
    EXPECT_GT(whole.counts.empty_pixels, 0u);
    Totals totals;
    for (const std::uint64_t memory : {18, 22, 30}) {
        SCOPED_TRACE(memory);
        settings.memory = memory * kMebibyte;
        const Developed little = develop_in_memory(run_set, settings, 2);
        EXPECT_EQ(little.picture.pixels(), whole.picture.pixels());
        EXPECT_EQ(little.picture.order(), whole.picture.order());
        EXPECT_EQ(little.counts.fallback_pixels, whole.counts.fallback_pixels);
        EXPECT_EQ(little.counts.empty_pixels, whole.counts.empty_pixels);
        EXPECT_EQ(little.counts.camera_records, whole.counts.camera_records);
        EXPECT_EQ(little.counts.light_records, whole.counts.light_records);
        totals.regions += little.counts.regions;
        totals.batches += little.counts.batches;
        totals.decoded_again += little.counts.pages_decoded - little.counts.pages;
    }
    return totals;
}

TEST(FewSamples, InASmallGapAreDecodedAgainWithoutTheOthers) {
    const MemoryRunSet run_set = make_run_set(20, 1 << 16, {{0.4, 0.4, 0.43, 0.43}});
    const Totals totals = expect_the_same_with_little_memory(run_set, settings_for(300, 200, "quartic:-6,2"));
    EXPECT_GT(totals.batches, 10u) << "records passed by";
    EXPECT_GT(totals.decoded_again, 0u);
    EXPECT_LT(totals.decoded_again, 3 * run_set.runs().size() * 4) << "a few pages of each run";
}

TEST(FewSamples, InHalfOfThePictureAreFoundInRegionsThatAreSmallEnough) {
    const MemoryRunSet run_set = make_run_set(28, 1 << 16, {{0.5, 0, 1, 1}});
    const Totals totals = expect_the_same_with_little_memory(run_set, settings_for(420, 280, "lanczos"));
    EXPECT_GT(totals.decoded_again, 0u);
    EXPECT_GT(totals.regions, 5u) << "some were cut";
}

TEST(FewSamples, AreWeighedAlikeWhereverPanesMeet) {
    // One record per pixel and gaps that cross the borders of panes, regions, blocks and tiles.
    const MemoryRunSet run_set =
        make_run_set(10, 1 << 16, {{0.245, 0, 0.255, 1}, {0, 0.49, 1, 0.51}, {0.7, 0.1, 0.9, 0.3}, {0.995, 0.99, 1, 1}});
    for (const auto& [filter, light] : {std::pair{"quartic:-6,2", true}, {"lanczos", true}, {"mitchell-separable", false}}) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(900, 600, filter);
        settings.light = light;
        const Totals totals = expect_the_same_with_little_memory(run_set, settings);
        EXPECT_GE(totals.regions, 12u);
    }
}

TEST(FewSamples, AgreeWithTheDefinition) {
    const MemoryRunSet run_set = make_run_set(1, 1 << 16, {{0.3, 0.3, 0.6, 0.5}});
    Records records;
    sampledb::PageDecoder decoder;
    for (const sampledb::PageInfo& info : **run_set.pages(0)) {
        sampledb::Page page;
        ASSERT_TRUE(run_set.read_page(0, info, {}, decoder, page));
        for (std::size_t i = 0; i < page.count; ++i) {
            records.record_class.push_back(page.record_class);
            records.sample.push_back(page.sample[i]);
            records.u.push_back(page.u[i]), records.v.push_back(page.v[i]);
            records.share.push_back(page.record_class == RecordClass::kCamera ? 1.0f : 0.0f);
            records.x.push_back(page.x[i]), records.y.push_back(page.y[i]), records.z.push_back(page.z[i]);
        }
    }
    for (const char* filter : {"quartic:-6,2", "lanczos", "mitchell-separable"}) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(150, 100, filter);
        settings.light = false;
        const Developed got = develop_in_memory(run_set, settings);
        EXPECT_GT(got.counts.fallback_pixels, 100u);
        const std::vector<ReferencePixel> expected = reference(run_set.job(), records, got.counts.camera_records, settings);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const auto x = static_cast<std::int64_t>(i % 150), y = static_cast<std::int64_t>(i / 150);
            // sum w c may be as small as 0.05 of its expectation, so errors of the weights count up to 20 times
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(got.picture.at(x, y, c), expected[i].value[c], 20 * expected[i].tolerance[c]) << x << ' ' << y;
        }
    }
}

}  // namespace
}  // namespace latent::develop
