#include <gtest/gtest.h>

#include <atomic>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using namespace sampledb;

TEST(Develop, AgreesWithTheDefinitionForEveryFilterAndBothImages) {
    synthetic::Scene scene;
    scene.light_per_sample = 0.3;
    scene.split_shares = true;
    const Job job = synthetic::make_job(RecordKind::kXyz);
    constexpr std::uint64_t kSamples = 3 << 14;
    const MemoryRunSet run_set = make_runs(job, 3, kSamples / 3, scene);
    const Records records = synthetic::make_records(job, {0, kSamples}, scene);
    for (const char* filter : kFilters) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(75, 50, filter);
        const std::vector<ReferencePixel> expected = reference(job, records, kSamples, settings);
        const Developed got = develop_in_memory(run_set, settings);
        int i = 0;
        for (int y = 0; y < 50; ++y) {
            for (int x = 0; x < 75; ++x, ++i) {
                for (int c = 0; c < 3; ++c) {
                    ASSERT_NEAR(got.picture.at(x, y, c), expected[i].value[c], expected[i].tolerance[c])
                        << x << ' ' << y << ' ' << c;
                }
            }
        }
        EXPECT_EQ(got.counts.fallback_pixels + got.counts.empty_pixels, 0u);
        EXPECT_EQ(got.counts.decode_factor(), 1.0);
    }
}

// Wherever it is when it is told so.
TEST(Develop, GivesUpSoonWhenItIsToldTo) {
    const MemoryRunSet run_set = make_runs(synthetic::make_job(RecordKind::kXyz), 3, 1 << 14, synthetic::Scene{});
    const auto channels = Channels::xyz(run_set.job(), nullptr);
    ASSERT_TRUE(channels);
    Settings settings = settings_for(330, 220);
    const auto asked_if_given_up_after = [&](int most, ErrorCode& code) {
        std::atomic<int> asked = 0;
        settings.stopped = [&] { return ++asked > most; };
        MemoryPicture picture(settings.crop, channels->layout().outputs());
        Result<DevelopCounts> counts = DevelopCounts{};
        Threads(2).run([&] { counts = develop(run_set, *channels, settings, picture); });
        code = counts ? ErrorCode::kIo : counts.error().code;
        return asked.load();
    };
    ErrorCode code{};
    const int all = asked_if_given_up_after(1 << 30, code);
    EXPECT_EQ(code, ErrorCode::kIo);  // done
    EXPECT_GT(all, 50);               // of pages and of cells
    for (const int after : {0, 1, all / 4, all / 2, all - 1}) {
        asked_if_given_up_after(after, code);
        EXPECT_EQ(code, ErrorCode::kStopped) << after << " of " << all;
    }
}

}  // namespace
}  // namespace latent::develop
