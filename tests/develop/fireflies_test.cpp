// Samples that are far brighter than all around them are dimmed, and nothing else is.
#include "tools/develop/engine/fireflies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::RecordKind;
using sampledb::Records;

Job job_of() {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.positions = {};
    return job;
}

struct Place {
    double u, v;
};

// `count` samples of a uniform scene at random places; those at `bright` have 1000 in each channel, light records as well as camera
// records.
MemoryRunSet uniform(std::uint64_t count, const std::vector<Place>& bright, RecordClass of_bright = RecordClass::kCamera) {
    MemoryRunSet run_set(job_of());
    Records records;
    std::mt19937 random(7);
    for (std::uint64_t i = 0; i < count; ++i) {
        const bool is_bright = i < bright.size();
        const bool light = is_bright ? of_bright == RecordClass::kLight : i % 4 == 0;
        records.sample.push_back(i);
        records.record_class.push_back(light ? RecordClass::kLight : RecordClass::kCamera);
        const auto u = static_cast<std::uint32_t>(random()), v = static_cast<std::uint32_t>(random());
        records.u.push_back(is_bright ? static_cast<std::uint32_t>(bright[i].u * 0x1p32) : u);
        records.v.push_back(is_bright ? static_cast<std::uint32_t>(bright[i].v * 0x1p32) : v);
        records.share.push_back(light ? 0.0f : 1.0f);
        for (std::vector<float>* column : {&records.x, &records.y, &records.z}) column->push_back(is_bright ? 1000.0f : 1.0f);
    }
    run_set.add(Coverage({0, count}), records);
    return run_set;
}

Developed dimmed(const MemoryRunSet& run_set, Settings settings, int threads = 2, Layers layers = {}) {
    settings.dim_fireflies = layers.samples = true;
    return develop_in_memory(run_set, settings, threads, nullptr, layers);
}

double sum(const Developed& developed) {
    const std::vector<float>& pixels = developed.picture.pixels();
    return std::accumulate(pixels.begin(), pixels.end(), 0.0);
}

TEST(Fireflies, FewerThanFourNeighboursAreDimmedAndFourAreTrusted) {
    const Settings settings = settings_for(30, 20, "box");
    const std::vector<Place> near = {{0.501, 0.501}, {0.51, 0.49}, {0.52, 0.51}, {0.50, 0.52}};
    for (const RecordClass of_bright : {RecordClass::kCamera, RecordClass::kLight}) {
        for (std::size_t count = 0; count <= 4; ++count) {
            SCOPED_TRACE(count);
            const MemoryRunSet run_set =
                uniform(120'000, {near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count)}, of_bright);
            const Developed plain = develop_in_memory(run_set, settings), got = dimmed(run_set, settings);
            const bool camera = of_bright == RecordClass::kCamera;
            const DimmedLight& what = camera ? got.counts.camera_dimmed : got.counts.light_dimmed;
            const DimmedLight& other = camera ? got.counts.light_dimmed : got.counts.camera_dimmed;
            EXPECT_EQ(other.samples, 0u);
            EXPECT_EQ(what.samples, count < 4 ? count : 0u);
            if (what.samples == 0) {
                EXPECT_EQ(got.picture.pixels(), plain.picture.pixels());
            } else {
                EXPECT_DOUBLE_EQ(what.taken, static_cast<double>(3 * count) * (1000 - 2));  // 2 is twice the others
            }
        }
    }
}

// With the box filter, the sum over the picture is that over the records.
TEST(Fireflies, TheLightThatIsTakenIsWhatThePictureLacks) {
    const Settings settings = settings_for(30, 20, "box");
    const MemoryRunSet run_set = uniform(60'000, {{0.1, 0.1}, {0.5, 0.51}, {0.9, 0.2}}, RecordClass::kLight);
    const Developed plain = develop_in_memory(run_set, settings), got = dimmed(run_set, settings);
    EXPECT_EQ(got.counts.light_dimmed.samples, 3u);
    EXPECT_NEAR((sum(plain) - sum(got)) / (got.counts.light_dimmed.taken * 600 / 60'000), 1, 1e-4);
}

TEST(Fireflies, AreTheSameBitsHoweverTheyAreDeveloped) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    const synthetic::Scene scene{.light_per_sample = 0.3, .split_shares = true};
    const MemoryRunSet run_set = make_runs(job, 24, 4096, scene);
    for (const char* filter : {"quartic", "quartic:-6,2", "lanczos"}) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(330, 220, filter);
        settings.memory = std::uint64_t{1} << 30;
        const Layers layers{.variance = true, .halves = true};
        const Developed whole = dimmed(run_set, settings, 1, layers);
        EXPECT_GT(whole.counts.camera_dimmed.samples, 0u);
        EXPECT_GT(whole.counts.light_dimmed.samples, 0u);
        settings.memory = std::uint64_t{30} << 20;
        const Developed little = dimmed(run_set, settings, 2, layers);
        EXPECT_GT(little.counts.regions, whole.counts.regions);
        EXPECT_EQ(little.picture.pixels(), whole.picture.pixels());
        EXPECT_EQ(little.counts.camera_dimmed.samples, whole.counts.camera_dimmed.samples);
        EXPECT_EQ(little.counts.light_dimmed.samples, whole.counts.light_dimmed.samples);
        EXPECT_EQ(little.counts.camera_records, whole.counts.camera_records);
        settings.crop = {100, 90, 150, 110};
        const Developed part = dimmed(run_set, settings, 2, layers);
        for (std::int64_t y = 90; y < 110; ++y) {
            for (std::int64_t x = 100; x < 150; ++x) {
                for (int c = 0; c < 12; ++c) ASSERT_EQ(part.picture.at(x, y, c), whole.picture.at(x, y, c));
            }
        }
    }
}

// Many samples per pixel and little memory: records pass by in batches, and twice.
TEST(Fireflies, AreFoundInRecordsThatPassByInBatches) {
    const MemoryRunSet run_set = make_runs(synthetic::make_job(RecordKind::kXyz), 64, 16384, {.light_per_sample = 0.1});
    for (const char* filter : {"quartic", "quartic:-6,2"}) {
        Settings settings = settings_for(120, 80, filter);
        settings.memory = std::uint64_t{1} << 30;
        const Developed whole = dimmed(run_set, settings, 1);
        settings.memory = std::uint64_t{20} << 20;
        const Developed little = dimmed(run_set, settings, 2);
        EXPECT_GT(little.counts.batches, whole.counts.batches + 2);
        EXPECT_GT(little.counts.decode_factor(), 1.5);
        EXPECT_EQ(little.picture.pixels(), whole.picture.pixels());
        EXPECT_EQ(little.counts.camera_dimmed.samples, whole.counts.camera_dimmed.samples);
        EXPECT_EQ(little.counts.camera_records, whole.counts.camera_records);
    }
}

// Two records of share 1/2 are one sample: alone, neither would be more than twice as bright as the others.
TEST(Fireflies, RecordsOfASampleCountTogether) {
    MemoryRunSet run_set(job_of());
    Records records;
    std::mt19937 random(7);
    constexpr std::uint64_t kSamples = 40'000;
    for (std::uint64_t i = 0; i < kSamples; ++i) {
        const auto u = static_cast<std::uint32_t>(random()), v = static_cast<std::uint32_t>(random());
        for (int part = 0; part < 2; ++part) {
            records.sample.push_back(i);
            records.record_class.push_back(RecordClass::kCamera);
            records.u.push_back(u), records.v.push_back(v);
            records.share.push_back(0.5f);
            for (std::vector<float>* column : {&records.x, &records.y, &records.z}) column->push_back(i == 0 ? 1.8f : 0.5f);
        }
    }
    run_set.add(Coverage({0, kSamples}), records);
    EXPECT_EQ(dimmed(run_set, settings_for(30, 20)).counts.camera_dimmed.samples, 1u);
}

}  // namespace
}  // namespace latent::develop
