// Laws of the layers of what is seen: means of columns by the filter, and the number of one record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>

#include "base/bytes.h"
#include "color/rgb_space.h"
#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

using sampledb::ColumnType;
using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::RecordKind;
using sampledb::Records;

constexpr Layers kAovs{.albedo = true, .normal = true, .depth = true, .position = true, .id = true};
// Where they are among the outputs of three channels.
constexpr int kAlbedo = 3, kNormal = 6, kDepth = 9, kPosition = 10, kId = 13;

// Columns as latent-render writes them, or of the wider types that the registry allows.
Job job_with_aovs(bool wide) {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.extra = {{"albedo.x", ColumnType::kF32},
                 {"albedo.y", ColumnType::kF32},
                 {"albedo.z", ColumnType::kF32},
                 {"normal.x", ColumnType::kF32},
                 {"normal.y", ColumnType::kF32},
                 {"normal.z", ColumnType::kF32},
                 {"depth", ColumnType::kF32},
                 {"position.x", wide ? ColumnType::kF64 : ColumnType::kF32},
                 {"position.y", wide ? ColumnType::kF64 : ColumnType::kF32},
                 {"position.z", wide ? ColumnType::kF64 : ColumnType::kF32},
                 {"object", wide ? ColumnType::kU64 : ColumnType::kU32},
                 {"material", wide ? ColumnType::kU16 : ColumnType::kU32}};
    return job;
}

// What a record sees: a function of its number, and nothing in a tenth of all.
struct Sight {
    float value[10];  // up to the position
    std::uint32_t object, material;
    bool hit;
};
Sight sight_of(std::uint64_t n) {
    std::mt19937 random(static_cast<std::uint32_t>(n));
    Sight sight{};
    sight.hit = random() % 10 != 0;
    sight.value[6] = std::numeric_limits<float>::infinity();
    if (!sight.hit) return sight;
    for (int i = 0; i < 10; ++i)
        sight.value[i] = std::ldexp(static_cast<float>(random() % 4096), -12) - (i < 3 || i == 6 ? 0 : 0.5f);
    sight.object = 1 + random() % 5, sight.material = 1 + random() % 60000;
    return sight;
}

void add_aovs(const Job& job, Records& records) {
    records.extra = extra_columns(job);
    for (std::size_t row = 0; row < records.size(); ++row) {
        const bool camera = records.record_class[row] == RecordClass::kCamera;
        const Sight sight = camera ? sight_of(records.sample[row]) : Sight{};
        for (std::size_t i = 0; i < records.extra.size(); ++i) {
            sampledb::ExtraColumn& column = records.extra[i];
            std::byte bytes[8];
            switch (column.type) {
                case ColumnType::kF32:
                    store_le(bytes, camera ? sight.value[i] : 0.0f);
                    break;
                case ColumnType::kF64:
                    store_le(bytes, camera ? static_cast<double>(sight.value[i]) : 0.0);
                    break;
                case ColumnType::kU64:
                    store_le(bytes, std::uint64_t{sight.object});
                    break;
                case ColumnType::kU16:
                    store_le(bytes, static_cast<std::uint16_t>(sight.material));
                    break;
                default:
                    store_le(bytes, i == 10 ? sight.object : sight.material);
            }
            column.values.insert(column.values.end(), bytes, bytes + sampledb::width(column.type));
        }
    }
}

Records records_of(const Job& job, sampledb::SampleRange range) {
    Job plain = job;
    plain.extra.clear();
    Records records = synthetic::make_records(plain, range, {.light_per_sample = 0.3, .split_shares = true});
    add_aovs(job, records);
    return records;
}

MemoryRunSet runs_with_aovs(const Job& job, int runs, std::uint64_t per_run) {
    return make_runs(job, runs, per_run, [&](const sampledb::SampleRange& range) { return records_of(job, range); });
}

TEST(AovLayers, AreWhatTheirDefinitionsSay) {
    const int width = 30, height = 20;
    for (const bool wide : {false, true}) {
        const Job job = job_with_aovs(wide);
        const MemoryRunSet run_set = runs_with_aovs(job, 1, 16384);
        const Records records = records_of(job, {0, 16384});
        for (const char* name : {"quartic", "gaussian", "box", "quartic:-5,2"}) {
            SCOPED_TRACE(name);
            const Settings settings = settings_for(width, height, name);
            const bool box = std::string_view(name) == "box";
            const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, kAovs);
            int different = 0;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    double weight = 0, hits = 0, mean[10] = {};
                    std::tuple<double, double, double> best{};
                    for (std::size_t i = 0; i < records.size(); ++i) {
                        if (records.record_class[i] != RecordClass::kCamera) continue;
                        const double dx = x + 0.5 - records.u[i] * 0x1p-32 * width, dy = y + 0.5 - records.v[i] * 0x1p-32 * height;
                        const double w = settings.filter.weight(dx, dy), wc = w * static_cast<double>(records.share[i]);
                        if (w == 0) continue;
                        const Sight sight = sight_of(records.sample[i]);
                        weight += wc, hits += sight.hit ? wc : 0;
                        for (int k = 0; k < 10 && sight.hit; ++k) mean[k] += wc * static_cast<double>(sight.value[k]);
                        if (records.share[i] > 0)
                            best = std::max(best, {box ? 1 - dx * dx - dy * dy : w, -1.0 * sight.object, -1.0 * sight.material});
                    }
                    const auto at = [&](int c) { return static_cast<double>(developed.picture.at(x, y, c)); };
                    const std::array<double, 3> rgb =
                        color::RgbSpace::srgb().rgb_from_xyz * std::array{mean[0] / weight, mean[1] / weight, mean[2] / weight};
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_NEAR(at(kAlbedo + c), std::clamp(rgb[static_cast<std::size_t>(c)], 0.0, 1.0), 1e-5);
                        EXPECT_NEAR(at(kNormal + c), mean[3 + c] / weight, 1e-5);
                        EXPECT_NEAR(at(kPosition + c), mean[7 + c] / hits, 1e-5);
                    }
                    EXPECT_NEAR(at(kDepth), mean[6] / hits, 1e-5);
                    different += at(kId) != -std::get<1>(best) || at(kId + 1) != -std::get<2>(best);
                }
            }
            EXPECT_LE(different, 3);  // weights of 24 bits: two records that are nearest may change places
        }
    }
}

TEST(AovLayers, AreTheSameBitsHoweverTheyAreDeveloped) {
    const Job job = job_with_aovs(false);
    const MemoryRunSet run_set = runs_with_aovs(job, 24, 4096);
    for (const char* filter : {"quartic", "quartic:-6,2", "box"}) {
        SCOPED_TRACE(filter);
        Settings settings = settings_for(330, 220, filter);
        const Developed whole = expect_same_with_little_memory(run_set, settings, kAovs);
        settings.memory = std::uint64_t{40} << 20;
        settings.crop = {100, 50, 240, 170};
        const Developed part = develop_in_memory(run_set, settings, 2, nullptr, kAovs);
        for (int y = 50; y < 170; ++y) {
            for (int x = 100; x < 240; ++x) {
                for (int c = 0; c < kId + 2; ++c)
                    ASSERT_EQ(std::bit_cast<std::uint32_t>(part.picture.at(x, y, c)),
                              std::bit_cast<std::uint32_t>(whole.picture.at(x, y, c)));
            }
        }
    }
}

TEST(AovLayers, ChangeNoBitOfThePictureAndOfOtherLayers) {
    const Job job = job_with_aovs(false);
    const MemoryRunSet run_set = runs_with_aovs(job, 1, 16384);
    const Layers others{.variance = true, .weight = true, .count = true, .halves = true};
    Layers all = kAovs;
    all.variance = all.weight = all.count = all.halves = true;
    const int before = RowLayout{3, others}.outputs();
    for (const char* filter : {"quartic:-6,2", "box"}) {
        const Settings settings = settings_for(90, 60, filter);
        const Developed plain = develop_in_memory(run_set, settings, 2, nullptr, others),
                        rich = develop_in_memory(run_set, settings, 2, nullptr, all),
                        aovs = develop_in_memory(run_set, settings, 2, nullptr, kAovs);
        for (int y = 0; y < 60; ++y) {
            for (int x = 0; x < 90; ++x) {
                for (int c = 0; c < before; ++c) ASSERT_EQ(rich.picture.at(x, y, c), plain.picture.at(x, y, c));
                for (int c = kAlbedo; c < kId + 2; ++c)
                    ASSERT_EQ(rich.picture.at(x, y, before - 3 + c), aovs.picture.at(x, y, c)) << c;
            }
        }
    }
}

TEST(AovLayers, OfAPixelThatSeesNothingAreZeroAndInfinitelyFar) {
    const Job job = job_with_aovs(false);
    Records records = records_of(job, {0, 4096});
    for (std::size_t i = 0; i < records.extra.size(); ++i) {
        for (std::size_t row = 0; row < records.size(); ++row)
            store_le(records.extra[i].values.data() + 4 * row, i == 6 ? std::numeric_limits<float>::infinity() : 0.0f);
    }
    MemoryRunSet run_set(job);
    run_set.add(Coverage({0, 4096}), records);
    const Developed developed = develop_in_memory(run_set, settings_for(12, 8, "quartic"), 1, nullptr, kAovs);
    for (int c = kAlbedo; c < kId + 2; ++c)
        EXPECT_EQ(developed.picture.at(5, 5, c), c == kDepth ? std::numeric_limits<float>::infinity() : 0.0f);
}

// Foreign files may hold anything.
TEST(AovLayers, ThatAreNoNumbersCountAsNothing) {
    const Job job = job_with_aovs(false);
    Records records = records_of(job, {0, 4096});
    for (std::size_t i = 0; i < 10; ++i) {
        for (std::size_t row = 0; row < records.size(); row += 3)
            store_le(records.extra[i].values.data() + 4 * row, std::numeric_limits<float>::quiet_NaN());
    }
    MemoryRunSet run_set(job);
    run_set.add(Coverage({0, 4096}), records);
    const Developed developed = develop_in_memory(run_set, settings_for(12, 8, "quartic"), 1, nullptr, kAovs);
    for (const float x : developed.picture.pixels()) EXPECT_TRUE(std::isfinite(x));
}

TEST(AovLayers, NeedTheirColumns) {
    Job job = job_with_aovs(false);
    std::erase_if(job.extra, [](const sampledb::ExtraColumnSpec& column) { return column.name == "normal.y"; });
    auto channels = Channels::xyz(job, nullptr);
    ASSERT_TRUE(channels);
    EXPECT_TRUE(channels->add_layers(job, {.albedo = true, .depth = true, .id = true}));
    const Status refused = channels->add_layers(job, {.normal = true});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
    EXPECT_THAT(refused.error().message, ::testing::AllOf(::testing::HasSubstr("normal.y"), ::testing::HasSubstr("--aov normal")));
}

TEST(AovLayers, HaveTheNamesThatOtherProgramsLookFor) {
    const RowLayout layout{3, kAovs};
    EXPECT_THAT(layout.names({"R", "G", "B"}),
                ::testing::ElementsAre("R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z", "Z", "P.X", "P.Y",
                                       "P.Z", "id.object", "id.material"));
    EXPECT_EQ(layout.outputs(), kId + 2);
    const Result<Layers> parsed = parse_layers("id,position,depth,normal,albedo");
    ASSERT_TRUE(parsed);
    EXPECT_EQ(*parsed, kAovs);
}

}  // namespace
}  // namespace latent::develop
