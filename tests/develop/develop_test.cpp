#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using namespace sampledb;

constexpr const char* kFilters[] = {"quartic", "quartic:-6,3", "quartic:-2,1.5", "mitchell", "mitchell-separable", "gaussian",
                                    "lanczos", "box"};

struct Made {
    Job job;
    MemoryGathering gathering;
    Records records;
    std::uint64_t samples;
};

// `runs` runs of `per_run` samples each.
Made make(const Job& job, int runs, std::uint64_t per_run, const synthetic::Scene& scene) {
    Made made{job, MemoryGathering(job), {}, runs * per_run};
    for (int i = 0; i < runs; ++i) {
        const SampleRange range{i * per_run, (i + 1) * per_run};
        made.gathering.add(Coverage(range), synthetic::make_records(job, range, scene));
    }
    made.records = synthetic::make_records(job, {0, made.samples}, scene);
    return made;
}

Job xyz_job() { return synthetic::make_job(RecordKind::kXyz); }

TEST(Develop, AgreesWithTheDefinitionForEveryFilterAndBothImages) {
    synthetic::Scene scene;
    scene.light_per_sample = 0.3;
    scene.split_shares = true;
    const Made made = make(xyz_job(), 3, 1 << 14, scene);
    for (const char* filter : kFilters) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(75, 50, filter);
        const std::vector<ReferencePixel> expected = reference(made.job, made.records, made.samples, settings);
        const Developed got = develop_in_memory(made.gathering, settings);
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
