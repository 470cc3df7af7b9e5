#include "tools/develop/channels/layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::RecordKind;
using sampledb::Records;

constexpr Layers kAll{.variance = true, .weight = true, .count = true, .halves = true};
// Where they are among the outputs of three channels.
constexpr int kVariance = 3, kWeight = 6, kCount = 7, kHalf = 8;

TEST(Layers, AreReadInAnyOrderAndOthersRefused) {
    EXPECT_EQ(*parse_layers("count,variance"), (Layers{.variance = true, .count = true}));
    EXPECT_EQ(*parse_layers("weight"), Layers{.weight = true});
    EXPECT_EQ(*parse_layers("gloss,weight,studio:matte,gloss"), (Layers{.weight = true, .columns = {"gloss", "studio:matte"}}));
    for (const char* bad : {"", "count,", "count,,weight"}) EXPECT_FALSE(parse_layers(bad)) << bad;
    EXPECT_EQ(*parse_layers("lights,depth"), (Layers{.lights = true, .depth = true}));
    const RowLayout layout{3, kAll};
    EXPECT_THAT(layout.names({"R", "G", "B"}),
                ::testing::ElementsAre("R", "G", "B", "variance.R", "variance.G", "variance.B", "weight", "count", "half0.R",
                                       "half0.G", "half0.B", "half1.R", "half1.G", "half1.B"));
    EXPECT_EQ(layout.outputs(), 14);
    const RowLayout with_lights{3, {.lights = true, .depth = true}, false, {"Key", "World"}};
    EXPECT_THAT(with_lights.names({"R", "G", "B"}),
                ::testing::ElementsAre("R", "G", "B", "light.Key.R", "light.Key.G", "light.Key.B", "light.World.R", "light.World.G",
                                       "light.World.B", "Z"));
    EXPECT_EQ(with_lights.outputs(), 10);
    const RowLayout with_halves{1, {.noisy = true, .halves = true, .lights = true}, false, {"Key"}};
    EXPECT_THAT(with_halves.names({"Y"}), ::testing::ElementsAre("Y", "noisy.Y", "half0.Y", "half1.Y", "light.Key.Y",
                                                                 "half0.light.Key.Y", "half1.light.Key.Y"));
    EXPECT_EQ(with_halves.outputs(), 7);
}

// Written down once: files developed by different versions must agree about halves.
TEST(Halves, OfTheFirstSamplesAreTheseForever) {
    std::string halves;
    for (std::uint64_t n = 0; n < 32; ++n) halves += static_cast<char>('0' + half_of(n));
    EXPECT_EQ(halves, "01100101010101010110101001101010");
}

TEST(Halves, AreCountedWithoutLookingAtEachSample) {
    std::mt19937 random(5);
    for (int i = 0; i < 200; ++i) {
        const std::uint64_t first = random() % 50, end = first + random() % 50, later = end + 1 + random() % 9;
        Coverage coverage({first, end});
        coverage.add({later, later + random() % 20});
        std::uint64_t counted[2] = {};
        for (std::uint64_t n = 0; n < 200; ++n) counted[half_of(n)] += coverage.contains(n) ? 1 : 0;
        EXPECT_EQ(count_in_half(coverage, 0), counted[0]);
        EXPECT_EQ(count_in_half(coverage, 1), counted[1]);
    }
}

// Which of two neighbours comes first is a fair coin: 3.3 sigma is 0.1 %.
TEST(Halves, AreDrawnWithoutRegardToTheNumber) {
    constexpr int kPairs = 1 << 16;
    int first = 0, changes = 0;
    for (std::uint64_t i = 0; i < kPairs; ++i) {
        EXPECT_NE(half_of(2 * i), half_of(2 * i + 1));
        first += half_of(2 * i);
        changes += half_of(2 * i) != half_of(2 * i + 2);
    }
    EXPECT_NEAR(first, kPairs / 2, 3.3 * std::sqrt(kPairs) / 2);
    EXPECT_NEAR(changes, kPairs / 2, 3.3 * std::sqrt(kPairs) / 2);
}

synthetic::Scene scene_of(bool light) { return {.light_per_sample = light ? 0.3 : 0, .split_shares = true}; }

Job job_of(bool light) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    if (!light) job.light_paths_per_sample = 0;
    return job;
}

TEST(Layers, ChangeNoBitOfThePicture) {
    for (const char* filter : {"quartic", "quartic:-6,2", "box", "mitchell-separable"}) {
        SCOPED_TRACE(filter);
        const MemoryRunSet run_set = make_runs(job_of(true), 3, 4096, scene_of(true));
        const Settings settings = settings_for(90, 60, filter);
        const Developed plain = develop_in_memory(run_set, settings), rich = develop_in_memory(run_set, settings, 2, nullptr, kAll);
        // Samples with two records have one value when they count as one, which rounds their sum.
        for (int y = 0; y < 60; ++y) {
            for (int x = 0; x < 90; ++x) {
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(rich.picture.at(x, y, c), plain.picture.at(x, y, c), 2e-6 * (1 + plain.picture.at(x, y, c)));
            }
        }
        const Layers no_samples{.weight = true, .halves = true};
        const Developed same = develop_in_memory(run_set, settings, 2, nullptr, no_samples);
        for (int y = 0; y < 60; ++y) {
            for (int x = 0; x < 90; ++x) {
                for (int c = 0; c < 3; ++c) EXPECT_EQ(same.picture.at(x, y, c), plain.picture.at(x, y, c));
            }
        }
    }
}

TEST(Layers, AreTheSameBitsHoweverTheyAreDeveloped) {
    const MemoryRunSet run_set = make_runs(job_of(true), 24, 4096, scene_of(true));
    for (const char* filter : {"quartic", "quartic:-6,2"}) {
        SCOPED_TRACE(filter);
        expect_same_with_little_memory(run_set, settings_for(330, 220, filter), kAll);
    }
}

// The definitions, sample by sample in double precision.
TEST(Layers, AreWhatTheirDefinitionsSay) {
    const Job job = job_of(false);
    const int width = 30, height = 20;
    MemoryRunSet run_set(job);
    const Records records = synthetic::make_records(job, {0, 16384}, scene_of(false));
    run_set.add(Coverage({0, 16384}), records);
    for (const char* name : {"quartic", "box", "gaussian"}) {
        SCOPED_TRACE(name);
        const Settings settings = settings_for(width, height, name);
        const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, kAll);
        struct Sample {
            double x = 0, y = 0, s[3] = {}, c = 0;
        };
        std::map<std::uint64_t, Sample> samples;
        for (std::size_t i = 0; i < records.size(); ++i) {
            Sample& sample = samples[records.sample[i]];
            sample.x = records.u[i] * 0x1p-32 * width, sample.y = records.v[i] * 0x1p-32 * height;
            sample.s[0] += records.x[i], sample.s[1] += records.y[i], sample.s[2] += records.z[i];
            sample.c += records.share[i];
        }
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                double weight[3] = {}, sum[3][3] = {}, squares[3] = {}, count = 0;  // all, half 0, half 1
                const auto weight_of = [&](const Sample& s) {
                    const double dx = x + 0.5 - s.x, dy = y + 0.5 - s.y;
                    return settings.filter.weight(dx, dy);
                };
                for (const auto& [n, s] : samples) {
                    const double w = weight_of(s);
                    if (w == 0) continue;
                    ++count;
                    for (const int part : {0, 1 + half_of(n)}) {
                        weight[part] += w * s.c;
                        for (int c = 0; c < 3; ++c) sum[part][c] += w * s.s[c];
                    }
                }
                for (const auto& [n, s] : samples) {
                    const double w = weight_of(s);
                    for (int c = 0; c < 3; ++c) squares[c] += std::pow(w * (s.s[c] - s.c * sum[0][c] / weight[0]), 2);
                }
                const auto at = [&](int c) { return static_cast<double>(developed.picture.at(x, y, c)); };
                EXPECT_NEAR(at(kWeight) / weight[0], 1, 1e-5);
                EXPECT_NEAR(at(kCount), count, 1 + 0.02 * count);  // weights next to 0 round to 0
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(at(kVariance + c) / (squares[c] / weight[0] / weight[0]), 1, 1e-4);
                    EXPECT_NEAR(at(kHalf + c) / (sum[1][c] / weight[1]), 1, 1e-5);
                    EXPECT_NEAR(at(kHalf + 3 + c) / (sum[2][c] / weight[2]), 1, 1e-5);
                }
            }
        }
    }
}

// Over 32 seeds, the mean of 600 pixels: the spread of a variance of 32 is 25 %, of its mean over 600 pixels 1 %.
TEST(Layers, TheVarianceIsTheSpreadOverSeeds) {
    const Job job = job_of(false);
    const Settings settings = settings_for(30, 20, "box");
    std::vector<double> sum(600), squares(600);
    double layer = 0;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        synthetic::Scene scene = scene_of(false);
        scene.seed = seed;
        const Developed developed = develop_in_memory(make_runs(job, 1, 16384, scene), settings, 2, nullptr, {.variance = true});
        for (std::size_t i = 0; i < 600; ++i) {
            const auto at = [&](int c) {
                return static_cast<double>(developed.picture.at(static_cast<int>(i % 30), static_cast<int>(i / 30), c));
            };
            sum[i] += at(1);
            squares[i] += at(1) * at(1);
            layer += at(kVariance + 1) / 32;
        }
    }
    double spread = 0;
    for (std::size_t i = 0; i < 600; ++i) spread += (squares[i] - sum[i] * sum[i] / 32) / 31;
    EXPECT_NEAR(layer / spread, 1, 0.2);
}

// The light image of a half is that of its own paths: both halves have the mean of the whole, and differ by their noise.
TEST(Halves, ShowTheLightImageAtItsFullBrightness) {
    const Job job = job_of(true);
    const MemoryRunSet run_set = make_runs(job, 4, 4096, scene_of(true));
    Settings settings = settings_for(30, 20);
    settings.camera = false;
    const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {.halves = true});
    double whole = 0, halves[2] = {}, difference = 0;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 30; ++x) {
            const auto at = [&](int c) { return static_cast<double>(developed.picture.at(x, y, c)); };
            whole += at(1);
            halves[0] += at(4);
            halves[1] += at(7);
            difference += std::abs(at(4) - at(7));
            EXPECT_NEAR((at(4) + at(7)) / 2, at(1), 1e-5 * (at(4) + at(7)));  // halves of equal size
        }
    }
    EXPECT_NEAR(halves[0] / whole, 1, 0.1);
    EXPECT_NEAR(halves[1] / whole, 1, 0.1);
    EXPECT_GT(difference, 0.05 * whole);
}

}  // namespace
}  // namespace latent::develop
