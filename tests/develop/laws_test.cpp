// What must not change a bit of any pixel, and what must not change at all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/hash.h"
#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::RecordKind;
using sampledb::Records;
using sampledb::SampleRange;

constexpr std::uint64_t kMiB = 1 << 20;

Job xyz_job() { return synthetic::make_job(RecordKind::kXyz); }

synthetic::Scene with_light(double light_per_sample) {
    synthetic::Scene scene;
    scene.light_per_sample = light_per_sample;
    scene.split_shares = true;
    return scene;
}

// A large picture is cut into regions whose records fit, a small one takes its records in several batches.
TEST(Determinism, ThreadsAndMemoryChangeNoBit) {
    const MemoryRunSet run_set = make_runs(xyz_job(), 14, 1 << 15, with_light(0.2));
    for (const auto& [width, filter] : {std::pair{1050u, "quartic:-5,2"}, {75u, "quartic"}, {600u, "lanczos"}}) {
        SCOPED_TRACE(fmt::format("{} {}", width, filter));
        Settings settings = settings_for(width, width * 2 / 3, filter);
        settings.memory = 2048 * kMiB;
        const Developed whole = develop_in_memory(run_set, settings, 1);
        EXPECT_EQ(whole.counts.regions, 1u);
        EXPECT_EQ(whole.counts.batches, 1u);
        std::uint64_t max_regions = 0, max_batches = 0;
        for (const auto& [memory, threads] : {std::pair{24, 2}, {40, 1}, {64, 3}}) {
            SCOPED_TRACE(memory);
            settings.memory = memory * kMiB;
            const Developed cut = develop_in_memory(run_set, settings, threads);
            EXPECT_EQ(cut.picture.pixels(), whole.picture.pixels());
            EXPECT_EQ(cut.picture.order(), whole.picture.order()) << "tiles are written in one order";
            EXPECT_EQ(cut.counts.pages, whole.counts.pages);
            EXPECT_EQ(cut.counts.fallback_pixels, whole.counts.fallback_pixels);
            EXPECT_EQ(cut.counts.empty_pixels, whole.counts.empty_pixels);
            max_regions = std::max(max_regions, cut.counts.regions);
            max_batches = std::max(max_batches, cut.counts.batches);
        }
        if (width > 75) {
            EXPECT_GE(max_regions, 4u);
        } else {
            EXPECT_GE(max_batches, 2u);
        }
    }
}

TEST(Determinism, InstructionSetsChangeNoBit) {
    const MemoryRunSet run_set = make_runs(xyz_job(), 2, 1 << 14, with_light(0.5));
    for (const char* filter : kFilters) {
        SCOPED_TRACE(filter);
        const Settings settings = settings_for(150, 100, filter);
        ASSERT_TRUE(set_simd_level("best"));
        const Developed best = develop_in_memory(run_set, settings);
        for (const std::string_view level : simd_levels()) {
            SCOPED_TRACE(level);
            ASSERT_TRUE(set_simd_level(level));
            EXPECT_EQ(develop_in_memory(run_set, settings).picture.pixels(), best.picture.pixels());
        }
    }
    EXPECT_FALSE(set_simd_level("abacus"));
    ASSERT_TRUE(set_simd_level("best"));
}

TEST(Determinism, ACropHoldsThePixelsOfTheWhole) {
    const MemoryRunSet run_set = make_runs(xyz_job(), 4, 1 << 14, with_light(0.3));
    for (const char* filter : {"quartic", "quartic:-5,2", "lanczos", "box"}) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(375, 250, filter);
        const Developed whole = develop_in_memory(run_set, settings);
        for (const PixelRect& crop : {PixelRect{0, 0, 20, 20}, {100, 60, 301, 199}, {374, 249, 375, 250}, {0, 100, 375, 101}}) {
            settings.crop = crop;
            const Developed part = develop_in_memory(run_set, settings);
            for (std::int64_t y = crop.y0; y < crop.y1; ++y) {
                for (std::int64_t x = crop.x0; x < crop.x1; ++x) {
                    for (int c = 0; c < 3; ++c) ASSERT_EQ(part.picture.at(x, y, c), whole.picture.at(x, y, c)) << x << ' ' << y;
                }
            }
        }
    }
}

// Light records of value 1 at random positions: every pixel's expectation is (light records per sample) / (light paths per sample).
// With n records per pixel, pixel values are sums of independent weights: z scores from the sample variance of the class.
TEST(LightImage, UniformRecordsDevelopFlatUpToTheBorder) {
    Job job = xyz_job();
    synthetic::Scene scene;
    scene.look = synthetic::Scene::Look::kUniform;
    scene.light_per_sample = 4;
    const MemoryRunSet run_set = make_runs(job, 4, 1 << 14, scene);
    for (const char* filter : kFilters) {
        for (const auto& [width, height] : {std::pair{48u, 32u}, {33u, 22u}}) {
            SCOPED_TRACE(fmt::format("{} {}x{}", filter, width, height));
            Settings settings = settings_for(width, height, filter);
            settings.camera = false;
            const Developed whole = develop_in_memory(run_set, settings);
            if (height == 22) {
                settings.crop = {0, 0, 5, 22};
                EXPECT_EQ(develop_in_memory(run_set, settings).picture.at(0, 0, 1), whole.picture.at(0, 0, 1));
            }
            // Classes: corners, the border rows and columns, the next ones, the inside.
            double sum[4] = {}, square[4] = {};
            int count[4] = {};
            for (std::uint32_t y = 0; y < height; ++y) {
                for (std::uint32_t x = 0; x < width; ++x) {
                    const std::uint32_t edge_x = std::min(x, width - 1 - x), edge_y = std::min(y, height - 1 - y);
                    const int at = edge_x <= 1 && edge_y <= 1      ? 0
                                   : std::min(edge_x, edge_y) == 0 ? 1
                                   : std::min(edge_x, edge_y) == 1 ? 2
                                                                   : 3;
                    const double value = static_cast<double>(whole.picture.at(x, y, 1));
                    sum[at] += value;
                    square[at] += value * value;
                    ++count[at];
                }
            }
            for (int at = 0; at < 4; ++at) {
                const double mean = sum[at] / count[at];
                const double deviation = std::sqrt((square[at] / count[at] - mean * mean) / count[at]);
                // Neighbours share records, so the mean of a class scatters more than independent pixels would: by at most the
                // number of pixels of a footprint (64 for the widest), under 5 for these filters along a line. 64 tests: 4.5 sigma.
                EXPECT_NEAR(mean, 4.0, 4.5 * 2 * deviation) << "class " << at;
            }
        }
    }
}

TEST(CameraImage, AConstantStaysConstantToTheLastBitsForEveryFilter) {
    synthetic::Scene scene;
    scene.look = synthetic::Scene::Look::kUniform;
    scene.black = 0;
    scene.light_per_sample = 0;
    const MemoryRunSet run_set = make_runs(xyz_job(), 1, 1 << 14, scene);
    for (const char* filter : kFilters) {
        for (const std::uint32_t width : {30u, 150u, 600u}) {  // 27, 1.1 and 0.07 samples per pixel
            SCOPED_TRACE(fmt::format("{} {}", filter, width));
            const Developed got = develop_in_memory(run_set, settings_for(width, width * 2 / 3, filter));
            std::uint64_t black = 0;
            for (const float value : got.picture.pixels()) {
                black += value == 0 ? 1 : 0;
                EXPECT_TRUE(value == 0 || std::abs(value - 1) <= 2e-7f) << value;
            }
            EXPECT_EQ(black, 3 * got.counts.empty_pixels);
            EXPECT_TRUE(width != 600 || got.counts.fallback_pixels + got.counts.empty_pixels > 0);
        }
    }
}

// A lamp of 10^4 in a dark room, with its edges through pixels, and light records on both sides of them: no pixel is darker than
// what it sees. With the sharp filters some are.
TEST(Picture, NoPixelBesideALampIsDarkerThanItsDarkestRecordByDefault) {
    const Job job = xyz_job();
    Records records = synthetic::make_records(job, {0, 1 << 15}, {.black = 0, .light_per_sample = 1});
    const auto in_lamp = [](std::uint32_t u, std::uint32_t v) {
        return u > 0x50000000u && u < 0x88888888u && v > 0x31234567u && v < 0x7FFFFFFFu;
    };
    for (std::size_t i = 0; i < records.size(); ++i)
        records.x[i] = records.y[i] = records.z[i] = in_lamp(records.u[i], records.v[i]) ? 1e4f : 0.125f;
    MemoryRunSet run_set(job);
    run_set.add(Coverage({0, 1 << 15}), records);
    const auto least = [&](const char* filter, bool camera) {
        Settings settings = settings_for(60, 40, filter);
        settings.camera = camera;
        settings.light = !camera;
        const Developed got = develop_in_memory(run_set, settings);
        return std::ranges::min(got.picture.pixels());
    };
    const std::string standard = Filter::standard().name();
    EXPECT_GE(least(standard.c_str(), true), 0.125f * (1 - 1e-6f));
    EXPECT_GT(least(standard.c_str(), false), 0);
    for (const char* sharp : {"quartic:-5,2", "mitchell", "lanczos"}) {
        EXPECT_LT(least(sharp, true), -10) << sharp;
        EXPECT_LT(least(sharp, false), -10) << sharp;
    }
}

TEST(CameraImage, FewSamplesFallBackToTheNonNegativePartOfTheFilter) {
    const Job job = xyz_job();
    const synthetic::Scene scene = with_light(0);
    const MemoryRunSet run_set = make_runs(job, 1, 2048, scene);
    const Records records = synthetic::make_records(job, {0, 2048}, scene);
    const Settings settings = settings_for(75, 50, "quartic:-6,2");
    const std::vector<ReferencePixel> expected = reference(job, records, 2048, settings);
    const Developed got = develop_in_memory(run_set, settings);
    EXPECT_GT(got.counts.fallback_pixels, 50u);
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 75; ++x) {
            const ReferencePixel& pixel = expected[y * 75 + x];
            // sum w c may be as small as 0.05 of its expectation, so errors of the weights count up to 20 times
            ASSERT_NEAR(got.picture.at(x, y, 1), pixel.value[1], 20 * pixel.tolerance[1]) << x << ' ' << y;
        }
    }
}

TEST(Records, NotFiniteOnesCountAsBlackAndAreCounted) {
    const Job job = xyz_job();
    synthetic::Scene scene = with_light(0.5);
    scene.split_shares = false;
    Records records = synthetic::make_records(job, {0, 4096}, scene);
    Records black = records;
    std::uint64_t camera = 0, light = 0;
    for (std::size_t i = 0; i < records.size(); i += 37) {
        const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                             -std::numeric_limits<float>::infinity()};
        (i % 2 == 0 ? records.x : records.z)[i] = bad[i % 3];
        black.x[i] = black.y[i] = black.z[i] = 0;
        ++(records.record_class[i] == RecordClass::kCamera ? camera : light);
    }
    MemoryRunSet with(job), without(job);
    with.add(Coverage({0, 4096}), records);
    without.add(Coverage({0, 4096}), black);
    Settings settings = settings_for(300, 200);
    settings.memory = 24 * kMiB;
    const Developed a = develop_in_memory(with, settings), b = develop_in_memory(without, settings);
    EXPECT_EQ(a.picture.pixels(), b.picture.pixels());
    EXPECT_EQ(a.counts.camera_not_finite, camera);
    EXPECT_EQ(a.counts.light_not_finite, light);
    EXPECT_EQ(b.counts.camera_not_finite + b.counts.light_not_finite, 0u);
}

// Keeps a hash of all tiles in their order, where pictures are too large to keep.
class HashSink final : public TileSink {
 public:
    Status write(int x, int y, std::span<const float> pixels) override {
        const int place[] = {x, y};
        hasher_.update(std::as_bytes(std::span(place)));
        hasher_.update(std::as_bytes(pixels));
        return {};
    }
    Hash128 digest() const { return hasher_.digest(); }

 private:
    Hasher128 hasher_;
};

TEST(Memory, HundredsOfPanesReadEveryPageOnceAndChangeNoBit) {
    for (const auto& [width, height] : {std::pair{8192u, 8192u}, {7000u, 5000u}}) {
        SCOPED_TRACE(width);
        Job job = xyz_job();
        job.aspect_width = width == height ? 1 : 7;
        job.aspect_height = width == height ? 1 : 5;
        const MemoryRunSet run_set = make_runs(job, 4, 1 << 16, with_light(0.05));
        const auto channels = Channels::xyz(job, nullptr);
        Settings settings = settings_for(width, height);
        Hash128 expected;
        for (const std::uint64_t memory : {1024, 28}) {
            settings.memory = memory * kMiB;
            HashSink sink;
            Threads(2).run([&] {
                const Result<DevelopCounts> counts = develop(run_set, *channels, settings, sink);
                ASSERT_TRUE(counts) << counts.error().message;
                EXPECT_EQ(counts->pages_decoded, counts->pages);
                EXPECT_TRUE(memory > 28 || counts->panes > 500) << counts->panes;
            });
            if (memory == 1024) expected = sink.digest();
            EXPECT_EQ(sink.digest(), expected);
        }
    }
}

// A run's light pages cover more of the film than its camera pages, and those more than a region: held meanwhile, each is decoded
// once. Held here: 32 runs of 3277 light records, 60 bytes each, beside a region of 131072 camera records, 24 bytes each.
TEST(Memory, PagesLargerThanRegionsAreDecodedOnce) {
    const MemoryRunSet run_set = make_runs(xyz_job(), 32, 1 << 16, with_light(0.05));
    Settings settings = settings_for(3000, 2000);
    const auto channels = Channels::xyz(run_set.job(), nullptr);
    Hash128 expected;
    for (const std::uint64_t memory : {1024, 32}) {
        settings.memory = memory * kMiB;
        HashSink sink;
        Result<DevelopCounts> counts = DevelopCounts{};
        Threads(2).run([&] { counts = develop(run_set, *channels, settings, sink); });
        ASSERT_TRUE(counts) << counts.error().message;
        EXPECT_EQ(counts->pages_decoded, counts->pages) << memory;
        EXPECT_EQ(counts->decode_factor(), 1);
        EXPECT_TRUE(memory == 1024 || counts->regions >= 8) << counts->regions;
        if (memory == 1024) expected = sink.digest();
        EXPECT_EQ(sink.digest(), expected);
    }
    // With less, some are decoded again, and no bit changes.
    settings.memory = 20 * kMiB;
    HashSink sink;
    Threads(2).run([&] {
        const Result<DevelopCounts> counts = develop(run_set, *channels, settings, sink);
        ASSERT_TRUE(counts) << counts.error().message;
        EXPECT_GT(counts->pages_decoded, counts->pages);
    });
    EXPECT_EQ(sink.digest(), expected);
}

// An index that names smaller squares than its pages fill: what they hold is not written past the memory that they were given.
TEST(Records, OutsideTheSquareOfTheirPageAreAnError) {
    class Misplaced final : public MemoryRunSet {
     public:
        using MemoryRunSet::MemoryRunSet;
        Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override {
            std::vector<sampledb::PageInfo> pages = **MemoryRunSet::pages(run);
            for (sampledb::PageInfo& page : pages) page.node = {20, 3 << 18, 3 << 18};
            return std::make_shared<const std::vector<sampledb::PageInfo>>(std::move(pages));
        }
    };
    const Job job = xyz_job();
    Misplaced run_set(job);
    run_set.add(Coverage({0, 1 << 14}), synthetic::make_records(job, {0, 1 << 14}, with_light(0.05)));
    const auto channels = Channels::xyz(job, nullptr);
    HashSink sink;
    const Result<DevelopCounts> counts = develop(run_set, *channels, settings_for(3000, 2000), sink);
    ASSERT_FALSE(counts);
    EXPECT_EQ(counts.error().code, ErrorCode::kCorrupt);
}

// Records at the far corners of a film of more than 2^32 pixels, in samples beyond 2^32.
TEST(Scale, FarCornersOfPicturesBeyond32BitsAreRight) {
    Job job = xyz_job();
    job.positions = {};
    job.aspect_width = job.aspect_height = 1;
    const std::uint64_t first = std::uint64_t{1} << 33;
    Records records;
    const auto add = [&](std::uint64_t sample, RecordClass record_class, std::uint32_t u, std::uint32_t v, float value) {
        records.sample.push_back(sample);
        records.record_class.push_back(record_class);
        records.u.push_back(u);
        records.v.push_back(v);
        records.share.push_back(record_class == RecordClass::kCamera ? 1.0f : 0.0f);
        records.x.push_back(value);
        records.y.push_back(2 * value);
        records.z.push_back(value / 4);
    };
    constexpr std::uint32_t kSide = 70000;
    const auto centre = [](std::uint64_t pixel) { return static_cast<std::uint32_t>(((2 * pixel + 1) << 31) / kSide); };
    add(first, RecordClass::kCamera, centre(kSide - 1), centre(kSide - 1), 3);
    add(first + 1, RecordClass::kCamera, centre(kSide - 3), centre(kSide - 2), 5);
    add(first + 2, RecordClass::kCamera, centre(0), centre(kSide - 1), 7);
    add(first + 3, RecordClass::kLight, centre(kSide - 1), centre(kSide - 1), 0.5f);
    MemoryRunSet run_set(job);
    run_set.add(Coverage({first, first + 1024}), records);

    Settings settings = settings_for(kSide, kSide, "box");
    settings.crop = {kSide - 300, kSide - 200, kSide, kSide};
    const Developed got = develop_in_memory(run_set, settings);
    const double light = 0.5 * kSide * static_cast<double>(kSide) / 1024;
    EXPECT_FLOAT_EQ(got.picture.at(kSide - 1, kSide - 1, 0), static_cast<float>(3 + light));
    EXPECT_EQ(got.picture.at(kSide - 3, kSide - 2, 1), 10);
    EXPECT_EQ(std::ranges::count_if(got.picture.pixels(), [](float v) { return v != 0; }), 6);
    settings.crop = {0, kSide - 1, 1, kSide};
    EXPECT_EQ(develop_in_memory(run_set, settings).picture.at(0, kSide - 1, 0), 7);
}

}  // namespace
}  // namespace latent::develop
