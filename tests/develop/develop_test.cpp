#include <gtest/gtest.h>

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

}  // namespace
}  // namespace latent::develop
