// A job is what its header says, field by field.
#include "sampledb/data/job.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "sampledb/data/limits.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/frames.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::make_job;

Job with_everything() {
    Job job = make_job(RecordKind::kSpectral);
    job.extra = {{"depth", ColumnType::kF32}, {"group", ColumnType::kU8}};
    return job;
}

// Each changes one field to another valid value.
const std::vector<std::function<void(Job&)>>& changes() {
    static const std::vector<std::function<void(Job&)>> list = {
        [](Job& j) { j.id.high ^= 1; },
        [](Job& j) { j.aspect_width = 5; },
        [](Job& j) { j.aspect_height = 7; },
        [](Job& j) { j.batch = 27; },
        [](Job& j) { j.density = {}; },
        [](Job& j) { j.light_unit_cd_m2 = 683; },
        [](Job& j) { j.light_paths_per_sample = 2; },
        [](Job& j) { j.run_samples *= 2; },
        [](Job& j) { j.run_bytes /= 2; },
        [](Job& j) { j.precision = 11; },
        [](Job& j) { j.positions.shift_v += 1; },
        [](Job& j) { j.positions = {}; },
        [](Job& j) { j.positions = synthetic::pixels_of(1 << 20, 1); },
        [](Job& j) { j.positions = synthetic::pixels_of(3, 2), j.precision = 9; },
        [](Job& j) { j.extra[0].name = "distance"; },
        [](Job& j) { j.extra[1].type = ColumnType::kU16; },
        [](Job& j) { j.extra.pop_back(); },
        [](Job& j) { j.kind = RecordKind::kXyz, j.batch = 0, j.density = {}; },
    };
    return list;
}

TEST(Job, EveryFieldTellsJobsApartAndSurvivesTheHeader) {
    const Job job = with_everything();
    EXPECT_TRUE(same_job(job, job));
    for (std::size_t i = 0; i < changes().size(); ++i) {
        SCOPED_TRACE(i);
        Job other = job;
        changes()[i](other);
        ASSERT_TRUE(other.validate());
        const Status same = same_job(job, other);
        ASSERT_FALSE(same);
        EXPECT_EQ(same.error().code, ErrorCode::kMismatch);
        const Result<Bytes> header = encode_file_header({other, "{\"a\": 1}"});
        ASSERT_TRUE(header);
        EXPECT_EQ(header->size() % (2 * kBlock), 0u);
        const Result<FileHeader> decoded = decode_file_header(*header);
        ASSERT_TRUE(decoded);
        EXPECT_TRUE(same_job(decoded->job, other));
        EXPECT_EQ(decoded->provenance_json, "{\"a\": 1}");
    }
}

TEST(Job, ImpossibleJobsAreRefused) {
    const auto refused = [](auto change) {
        Job job = with_everything();
        change(job);
        return !job.validate() && !encode_file_header({job, ""});
    };
    EXPECT_FALSE(refused([](Job&) {}));
    EXPECT_TRUE(refused([](Job& j) { j.aspect_width = 0; }));
    EXPECT_TRUE(refused([](Job& j) { j.aspect_width = 4; }));  // 4:2
    EXPECT_TRUE(refused([](Job& j) { j.batch = 0; }));
    EXPECT_TRUE(refused([](Job& j) { j.batch = kMaxPairs + 1; }));
    EXPECT_TRUE(refused([](Job& j) { j.kind = RecordKind::kXyz; }));  // with wavelengths
    EXPECT_TRUE(refused([](Job& j) { j.light_unit_cd_m2 = 0; }));
    EXPECT_TRUE(refused([](Job& j) { j.light_unit_cd_m2 = std::numeric_limits<double>::quiet_NaN(); }));
    EXPECT_TRUE(refused([](Job& j) { j.run_samples = 1000; }));
    EXPECT_TRUE(refused([](Job& j) { j.run_samples = 1u << 23; }));
    EXPECT_TRUE(refused([](Job& j) { j.run_bytes = 1000; }));
    EXPECT_TRUE(refused([](Job& j) { j.precision = 0; }));
    EXPECT_TRUE(refused([](Job& j) { j.precision = 24; }));
    EXPECT_TRUE(refused([](Job& j) { j.positions.sampler = PositionSampler::kNone; }));  // with shifts
    EXPECT_TRUE(refused([](Job& j) { j.positions.width = j.positions.height = 3; }));    // which Halton's positions do not have
    EXPECT_TRUE(refused([](Job& j) { j.positions = synthetic::pixels_of(0, 2); }));
    EXPECT_TRUE(refused([](Job& j) { j.positions = synthetic::pixels_of(3, (1 << 20) + 1); }));
    EXPECT_TRUE(refused([](Job& j) { j.extra[1].name = j.extra[0].name; }));
    EXPECT_TRUE(refused([](Job& j) { j.extra[1].name.clear(); }));
    EXPECT_TRUE(refused([](Job& j) { j.extra[1].name.assign(65, 'x'); }));
    EXPECT_TRUE(refused([](Job& j) { j.extra[1].type = static_cast<ColumnType>(7); }));
    EXPECT_TRUE(refused([](Job& j) {
        for (int i = 0; i < 200; ++i) j.extra.push_back({std::to_string(i), ColumnType::kU8});
    }));
    EXPECT_FALSE(encode_file_header({with_everything(), std::string(kMaxProvenanceSize + 1, ' ')}));
}

TEST(Job, RunsAreNear64MiB) {
    for (const std::uint64_t bytes : {1u, 17u, 33u, 100u, 141u, 1000u, 5000u, 100000u, 100000000u}) {
        const std::uint64_t samples = default_run_samples(bytes);
        EXPECT_TRUE(std::has_single_bit(samples));
        const double ratio = static_cast<double>(samples * bytes) / (64 << 20);
        if (samples != 1u << 10 && samples != 1u << 22) {
            EXPECT_GT(ratio, 0.7) << bytes;
            EXPECT_LT(ratio, 1.42) << bytes;
        }
        EXPECT_GE(samples, 1u << 10);
        EXPECT_LE(samples, 1u << 22);
    }
}

}  // namespace
}  // namespace latent::sampledb
