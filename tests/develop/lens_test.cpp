// Laws of a lens and a shutter that are chosen after rendering: their weights, and pictures of weighted records.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string_view>

#include "tests/color/simd_targets.h"
#include "tests/develop/developed.h"
#include "tests/faults/process.h"
#include "tools/develop/lens/lens_columns.h"
#include "tools/develop/lens/lens_rows.h"
#include "tools/develop/picture/picture.h"

namespace latent::develop {
namespace {

using sampledb::ColumnType;
using sampledb::Coverage;
using sampledb::Job;
using sampledb::RecordClass;
using sampledb::RecordKind;
using sampledb::Records;

Job job_with_lens() {
    Job job = synthetic::make_job(RecordKind::kXyz);
    job.extra = {{"lens.x", ColumnType::kU8}, {"lens.y", ColumnType::kU8}, {"shutter", ColumnType::kU8}};
    return job;
}

// Points that are uniform on the disk, as columns hold them.
void add_lens(Records& records, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (sampledb::ExtraColumn& column : records.extra) column.values.clear();
    for (std::size_t row = 0; row < records.size(); ++row) {
        double x = 1, y = 1;
        while (x * x + y * y > 1) x = 2 * unit(random) - 1, y = 2 * unit(random) - 1;
        for (const auto& [column, fraction] : {std::pair(0, (x + 1) / 2), std::pair(1, (y + 1) / 2), std::pair(2, unit(random))})
            records.extra[static_cast<std::size_t>(column)].values.push_back(static_cast<std::byte>(fraction * 256));
    }
}

Records records_of(const Job& job, sampledb::SampleRange range, const synthetic::Scene& scene) {
    Records records = synthetic::make_records(job, range, scene);
    add_lens(records, static_cast<std::uint32_t>(range.first));
    return records;
}

// Within so many tolerances of each value.
void expect_near(const Developed& developed, const std::vector<ReferencePixel>& expected, double tolerances) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(static_cast<double>(developed.picture.pixels()[3 * i + c]), expected[i].value[c],
                        tolerances * expected[i].tolerance[c]);
    }
}

MemoryRunSet runs_with_lens(const synthetic::Scene& scene, int runs = 4, std::uint64_t per_run = 4096) {
    const Job job = job_with_lens();
    return make_runs(job, runs, per_run, [&](const sampledb::SampleRange& range) { return records_of(job, range, scene); });
}

constexpr Layers kAllLayers{.variance = true, .weight = true, .count = true, .halves = true};

LensChoice choice(const char* aperture, const char* shutter = "", bool follows = false) {
    LensChoice lens;
    lens.exposure_follows = follows;
    if (*aperture != 0) lens.aperture = *parse_aperture(aperture);
    if (*shutter != 0) lens.shutter = *parse_shutter(shutter);
    return lens;
}

// What the values of the only row of a page are multiplied by.
double factor(const LensWeights& weights, const sampledb::Page& page) {
    LensWeights::Factors factors;
    weights.factors(page, 0, 1, factors);
    return static_cast<double>(factors.value[0]);
}

double mean_of(const char* aperture, const char* shutter = "") {
    const Result<LensWeights> weights = LensWeights::make(job_with_lens(), choice(aperture, shutter));
    EXPECT_TRUE(weights) << weights.error().message;
    return weights ? weights->mean() : 0;
}

// Sums over the cells of the lens are right to about the square of a cell's side, 1/128, times the edge's length.
TEST(Aperture, LetsAsMuchLightPassAsItsAreaSays) {
    constexpr double kPi = std::numbers::pi, kTolerance = 2e-4;
    EXPECT_NEAR(mean_of("1"), 1, 1e-12);
    EXPECT_NEAR(mean_of("0.35"), 0.35 * 0.35, kTolerance);
    for (const int n : {3, 5, 6, 9, 64})
        EXPECT_NEAR(mean_of(("0.8,blades:" + std::to_string(n) + ":17").c_str()), 0.64 * n / 2 * std::sin(2 * kPi / n) / kPi,
                    kTolerance);
    EXPECT_NEAR(mean_of("0.8,blades:6:17:1"), 0.64, kTolerance);
    EXPECT_NEAR(mean_of("gaussian"), (1 - std::exp(-2)) / 2, kTolerance);
    EXPECT_NEAR(mean_of("0.5,gaussian"), 0.25 * (1 - std::exp(-2)) / 2, kTolerance);
    EXPECT_NEAR(mean_of("anamorphic:2"), 0.5, kTolerance);
    EXPECT_NEAR(mean_of("0.6,left"), 0.18, kTolerance);
}

// In the corners, what two unit circles at a distance d have in common: 2 acos(d/2) - d/2 sqrt(4 - d^2).
TEST(Aperture, ACatsEyeIsWhatTwoRimsHaveInCommon) {
    const Result<LensWeights> weights = LensWeights::make(job_with_lens(), choice("cat-eye:0.8"));
    ASSERT_TRUE(weights);
    const auto mean_at = [&](double u, double v) {
        sampledb::Page page;
        page.record_class = RecordClass::kLight;  // whose weight is divided by the mean
        page.u = {static_cast<std::uint32_t>(u * 0x1p32)}, page.v = {static_cast<std::uint32_t>(v * 0x1p32)};
        page.extra = sampledb::extra_columns(job_with_lens());
        for (sampledb::ExtraColumn& column : page.extra) column.values = {std::byte{128}};
        return 1 / factor(*weights, page);
    };
    const auto common = [](double d) { return (2 * std::acos(d / 2) - d / 2 * std::sqrt(4 - d * d)) / std::numbers::pi; };
    EXPECT_NEAR(mean_at(0.5, 0.5), 1, 4e-3);  // a rim takes up to half of the cells along it
    for (const double corner : {1e-6, 1 - 1e-6}) EXPECT_NEAR(mean_at(corner, corner), common(0.8), 1e-3);
    EXPECT_NEAR(mean_at(0.75, 0.25), common(0.4), 1e-3);
}

TEST(Shutter, LetsAsMuchLightPassAsItsCurveSays) {
    EXPECT_NEAR(mean_of("", "0.2:0.5"), 0.3, 1e-12);
    EXPECT_NEAR(mean_of("", "0.75:1,0:0.25"), 0.5, 1e-12);
    EXPECT_NEAR(mean_of("", "soft"), 0.5, 1e-6);
    EXPECT_NEAR(mean_of("", "film,0.5:0.75"), 0.25 * 7 / 8, 1e-6);
    EXPECT_NEAR(mean_of("", "0:0.5,rolling:0.6"), 0.5 * 0.4, 1e-6);
}

TEST(Shutter, OfACurveInAFileIsItsIntegral) {
    const testing::TemporaryFolder folder;
    const std::string path = (folder / "ramp.csv").string();
    synthetic::write_file(path, std::as_bytes(std::span("time,transmission\n0,0\n1,1\n", 26)));
    EXPECT_NEAR(mean_of("", ("0:0.5," + path).c_str()), 0.25, 1e-6);
}

TEST(Shutter, ThatRollsExposesLowerRowsLater) {
    const Result<LensWeights> weights = LensWeights::make(job_with_lens(), choice("", "rolling:0.75"));
    ASSERT_TRUE(weights);
    sampledb::Page page;
    page.u = {0}, page.v = {0};
    page.extra = sampledb::extra_columns(job_with_lens());
    for (const double v : {0.0, 0.3337, 0.5, 0.99}) {
        page.v[0] = static_cast<std::uint32_t>(v * 0x1p32);
        double all = 0;
        for (int time = 0; time < 256; ++time) {
            for (sampledb::ExtraColumn& column : page.extra) column.values = {static_cast<std::byte>(time)};
            const double begin = time / 256.0, end = (time + 1) / 256.0, opens = 0.75 * v, closes = opens + 0.25;
            const double open = std::max(0.0, std::min(end, closes) - std::max(begin, opens)) * 256;
            EXPECT_NEAR(factor(*weights, page), open, 1.0 / 64) << "where it begins or ends, by a quarter of a step of its table";
            all += factor(*weights, page);
        }
        EXPECT_NEAR(all, 0.25 * 256, 1e-3) << "whatever the row";
    }
}

// For pixels of a picture.
void expect_near(const MemoryPicture& a, const std::vector<double>& b, double relative) {
    ASSERT_EQ(a.pixels().size(), b.size());
    for (std::size_t i = 0; i < b.size(); ++i)
        ASSERT_NEAR(static_cast<double>(a.pixels()[i]), b[i], relative * std::max(1.0, std::abs(b[i]))) << i;
}

// Records are dropped, or count as they are: what the definition makes of them.
TEST(Lens, APictureOfAPartIsThatOfItsRecords) {
    const Job job = job_with_lens();
    const sampledb::SampleRange range{0, 16384};
    Records records = records_of(job, range, {.light_per_sample = 0.3, .split_shares = true});
    MemoryRunSet run_set(job);
    run_set.add(Coverage(range), records);
    const LensChoice lens = choice("left", "0.25:0.5");
    for (std::size_t i = 0; i < records.size(); ++i) {
        const auto column = [&](std::size_t c) { return static_cast<int>(records.extra[c].values[i]); };
        const bool kept = column(0) < 128 && column(2) >= 64 && column(2) < 128;
        const float factor = !kept ? 0.0f : records.record_class[i] == RecordClass::kLight ? 8.0f : 1.0f;
        for (auto* values : {&records.x, &records.y, &records.z}) (*values)[i] *= factor;
        records.share[i] *= factor;
    }
    for (const char* filter : {"quartic", "box", "quartic:-5,2"}) {
        SCOPED_TRACE(filter);
        const Settings settings = settings_for(12, 8, filter);
        const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {}, lens);
        expect_near(developed, reference(job, records, range.size(), settings), 8);
    }
}

// The camera images of parts, weighted by what they have of a pixel's weight, are the whole; so are the light images, weighted by
// what they have of the lens and of the time.
TEST(Lens, PartsAddUpToTheWhole) {
    const MemoryRunSet run_set = runs_with_lens({.light_per_sample = 0.3});
    const std::vector<std::vector<LensChoice>> partitions = {
        {choice("left"), choice("right")},
        {choice("", "0:0.3"), choice("", "0.3:0.8"), choice("", "0.8:1")},
        {choice("left", "0:0.3"), choice("right", "0:0.3"), choice("left", "0.3:1"), choice("right", "0.3:1")},
        {choice("left", "0:0.3,rolling:0.4"), choice("right", "0:0.3,rolling:0.4")}};
    for (const bool camera : {true, false}) {
        Settings settings = settings_for(12, 8);
        (camera ? settings.light : settings.camera) = false;
        for (std::size_t p = 0; p < partitions.size(); ++p) {
            SCOPED_TRACE(p);
            // The last partition is that of a shutter which rolls.
            const LensChoice all = p == 3 ? choice("", "0:0.3,rolling:0.4") : LensChoice{};
            const Developed whole = develop_in_memory(run_set, settings, 2, nullptr, {.weight = true}, all);
            const std::size_t pixels = whole.picture.pixels().size() / 4;
            std::vector<double> sum(pixels * 4);
            double area = 0;
            for (const LensChoice& part : partitions[p]) {
                const double its_area = LensWeights::make(run_set.job(), part)->mean();
                area += its_area;
                const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {.weight = true}, part);
                for (std::size_t i = 0; i < pixels; ++i) {
                    const float* const pixel = &developed.picture.pixels()[4 * i];
                    const double weight = camera ? static_cast<double>(pixel[3]) : its_area;
                    for (std::size_t c = 0; c < 3; ++c) sum[4 * i + c] += weight * static_cast<double>(pixel[c]);
                    sum[4 * i + 3] += static_cast<double>(pixel[3]);
                }
            }
            for (std::size_t i = 0; i < pixels; ++i) {
                for (std::size_t c = 0; c < 3; ++c) sum[4 * i + c] /= camera ? sum[4 * i + 3] : area;
            }
            expect_near(whole.picture, sum, 1e-6);
        }
    }
}

TEST(Lens, KeepsTheExposureUnlessItIsToFollow) {
    const MemoryRunSet run_set = runs_with_lens({.look = synthetic::Scene::Look::kUniform, .black = 0, .light_per_sample = 0}, 8);
    const Settings settings = settings_for(6, 4, "box");
    for (const char* aperture : {"0.5,blades:6:10:0.3", "gaussian", "cat-eye:0.7"}) {
        SCOPED_TRACE(aperture);
        const Developed kept = develop_in_memory(run_set, settings, 2, nullptr, {}, choice(aperture, "film,0.1:0.9"));
        expect_near(kept.picture, std::vector<double>(kept.picture.pixels().size(), 1), 1e-6);
        const Developed followed = develop_in_memory(run_set, settings, 2, nullptr, {}, choice(aperture, "film,0.1:0.9", true));
        double sum = 0;
        for (const float value : followed.picture.pixels()) sum += static_cast<double>(value);
        EXPECT_NEAR(sum / static_cast<double>(followed.picture.pixels().size()), mean_of(aperture, "film,0.1:0.9"), 5e-3);
    }
}

TEST(Lens, PixelsDependOnNeitherMemoryNorThreads) {
    const MemoryRunSet run_set = runs_with_lens({.light_per_sample = 0.3}, 24, 16384);
    for (const char* filter : {"quartic", "quartic:-6,2"}) {  // without and with negative lobes
        const Developed whole = expect_same_with_little_memory(run_set, settings_for(330, 220, filter), kAllLayers,
                                                               choice("0.5,blades:5,cat-eye:0.3", "soft,rolling:0.2"));
        EXPECT_EQ(whole.counts.fallback_pixels > 0, std::string_view(filter) != "quartic");
    }
}

TEST(Lens, OnlySamplesThatCountAreCounted) {
    const MemoryRunSet run_set = runs_with_lens({.light_per_sample = 0});
    const Settings settings = settings_for(6, 4, "box");
    const auto count = [&](const LensChoice& lens) {
        const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {.count = true}, lens);
        double sum = 0;
        for (std::size_t i = 3; i < developed.picture.pixels().size(); i += 4)
            sum += static_cast<double>(developed.picture.pixels()[i]);
        return sum;
    };
    const double all = count({});
    EXPECT_EQ(all, static_cast<double>(run_set.coverage().size()));
    EXPECT_EQ(count(choice("left")) + count(choice("right")), all);
    EXPECT_LT(count(choice("left")), 0.55 * all);
}

// Moves records by hand. Light records count for the part of the lens that the rendered film has seen their new place through.
TEST(Focus, MovesEachRecordByItsPointOfTheLens) {
    const Job job = job_with_lens();
    const sampledb::SampleRange range{0, 16384};
    const Records records = records_of(job, range, {.light_per_sample = 0.3});
    MemoryRunSet run_set(job);
    run_set.add(Coverage(range), records);
    LensChoice lens;
    lens.film_shift = {0.08, -0.12};
    const LensCells cells = cells_of({});
    const auto middle = [](std::size_t cell) { return (static_cast<double>(cell) + 0.5) / 128 - 1; };
    Records moved = records.without_rows();
    for (std::size_t i = 0; i < records.size(); ++i) {
        double at[2];
        for (std::size_t axis = 0; axis < 2; ++axis)
            at[axis] = (axis == 0 ? records.u : records.v)[i] * 0x1p-32 +
                       lens.film_shift[axis] * middle(static_cast<std::size_t>(records.extra[axis].values[i]));
        if (!(at[0] >= 0 && at[0] < 1 && at[1] >= 0 && at[1] < 1)) continue;
        moved.append(records, i, 0);
        moved.u.back() = static_cast<std::uint32_t>(at[0] * 0x1p32), moved.v.back() = static_cast<std::uint32_t>(at[1] * 0x1p32);
        if (records.record_class[i] == RecordClass::kCamera) continue;
        double all = 0, seen = 0;
        for (std::size_t cell = 0; cell < cells.area.size(); ++cell) {
            const double u = at[0] - lens.film_shift[0] * middle(cell % kLensCells),
                         v = at[1] - lens.film_shift[1] * middle(cell / kLensCells);
            all += static_cast<double>(cells.area[cell]);
            if (u >= 0 && u < 1 && v >= 0 && v < 1) seen += static_cast<double>(cells.area[cell]);
        }
        for (auto* values : {&moved.x, &moved.y, &moved.z}) values->back() *= static_cast<float>(all / seen);
    }
    for (const Settings& settings : {settings_for(24, 16), settings_for(72, 48)}) {  // one cell, and four
        const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {}, lens);
        expect_near(developed, reference(job, moved, range.size(), settings), 4);
    }
}

// Even by more than the film's width, and with any number of rows.
TEST(Focus, MovesRecordsAlikeOnAllProcessors) {
    constexpr int kLevel = 3;
    constexpr std::size_t kRows = 1003;
    constexpr std::uint32_t kElsewhere = 4 * 5;
    const AxisMove along_u{-0.11f, 2, 4}, along_v{1.7f, 1, 5};
    std::mt19937 random(7);
    std::vector<std::uint8_t> x(kRows), y(kRows);
    std::vector<std::uint32_t> u(kRows), v(kRows);
    for (std::size_t i = 0; i < kRows; ++i)
        x[i] = static_cast<std::uint8_t>(random()), y[i] = static_cast<std::uint8_t>(random()),
        u[i] = static_cast<std::uint32_t>(random()), v[i] = static_cast<std::uint32_t>(random());
    std::vector<std::uint32_t> first_u, first_v;
    color::with_every_simd_target([&] {
        std::vector<std::uint32_t> to_u = u, to_v = v, cells(kRows);
        move_positions(along_u, along_v, kLevel, x.data(), y.data(), to_u.data(), to_v.data(), cells);
        std::size_t wanted = 0;
        for (std::size_t i = 0; i < kRows; ++i) {
            const double at_u = u[i] * 0x1p-32 + static_cast<double>(along_u.shift) * middle_of_cell(x[i]),
                         at_v = v[i] * 0x1p-32 + static_cast<double>(along_v.shift) * middle_of_cell(y[i]);
            const double cell_u = std::floor(at_u * (1 << kLevel)) - 2, cell_v = std::floor(at_v * (1 << kLevel)) - 1;
            const bool is_wanted = cell_u >= 0 && cell_u < 4 && cell_v >= 0 && cell_v < 5;
            ASSERT_EQ(cells[i], is_wanted ? static_cast<std::uint32_t>(cell_v * 4 + cell_u) : kElsewhere) << i;
            if (!is_wanted) continue;
            ++wanted;
            ASSERT_NEAR(to_u[i] * 0x1p-32, at_u, 1e-7);
            ASSERT_NEAR(to_v[i] * 0x1p-32, at_v, 1e-7);
        }
        EXPECT_GT(wanted, kRows / 20);
        if (first_u.empty()) first_u = to_u, first_v = to_v;
        EXPECT_EQ(to_u, first_u);
        EXPECT_EQ(to_v, first_v);
    });
}

TEST(Lens, WeighsRecordsAlikeOnAllProcessors) {
    const Job job = job_with_lens();
    const Records records = records_of(job, {0, 1003}, {.light_per_sample = 0});
    sampledb::Page page;
    page.count = records.size(), page.u = records.u, page.v = records.v, page.extra = records.extra;
    const Result<LensWeights> weights =
        LensWeights::make(job, choice("0.9,gaussian,cat-eye:0.3", "0.1:0.9,soft,rolling:0.2", true));
    ASSERT_TRUE(weights);
    LensWeights::Factors first;
    color::with_every_simd_target([&] {
        LensWeights::Factors factors;
        weights->factors(page, 0, page.count, factors);
        if (first.value.empty()) first = factors;
        EXPECT_EQ(factors.value, first.value);
        EXPECT_EQ(factors.share, first.share);
    });
}

TEST(Focus, CountsRecordsThatAreNotFiniteWhereTheyAreMoved) {
    const Job job = job_with_lens();
    const sampledb::SampleRange range{0, 16384};
    Records records = records_of(job, range, {.light_per_sample = 0});
    LensChoice lens;
    lens.film_shift = {0.08, -0.12};
    std::uint64_t on_film = 0;
    for (std::size_t i = 0; i < records.size(); i += 37) {
        records.x[i] = std::numeric_limits<float>::quiet_NaN();
        const auto at = [&](std::size_t axis, std::uint32_t from) {
            return from * 0x1p-32 + lens.film_shift[axis] * middle_of_cell(static_cast<std::size_t>(records.extra[axis].values[i]));
        };
        const double u = at(0, records.u[i]), v = at(1, records.v[i]);
        on_film += u >= 0 && u < 1 && v >= 0 && v < 1;
    }
    MemoryRunSet run_set(job);
    run_set.add(Coverage(range), records);
    const Developed developed = develop_in_memory(run_set, settings_for(72, 48), 2, nullptr, {}, lens);
    EXPECT_LT(on_film, records.size() / 37);
    EXPECT_EQ(developed.counts.camera_not_finite, on_film);
}

// In the strip at the border of a refocused picture, light records weigh 1 / M: of the cells that lie in both rims, and that the
// rendered film has seen this place through.
TEST(Focus, OfACatsEyeCountsWhatBothRimsAndTheFilmHaveInCommon) {
    constexpr double kEye = 0.8, kSteps = 500;
    LensChoice lens = choice("cat-eye:0.8");
    lens.film_shift = {0.08, -0.12};
    const Job job = job_with_lens();
    const Result<LensWeights> weights = LensWeights::make(job, lens);
    ASSERT_TRUE(weights);
    const double to_corner = std::hypot(job.aspect_width, job.aspect_height) / 2;
    sampledb::Page page;
    page.record_class = RecordClass::kLight;
    page.u = {0}, page.v = {0};
    page.extra = sampledb::extra_columns(job);
    for (sampledb::ExtraColumn& column : page.extra) column.values = {std::byte{128}};
    for (const auto& [u, v] : {std::pair(0.02, 0.5), {0.5, 0.03}, {0.97, 0.96}, {0.01, 0.9}, {0.5, 0.5}}) {
        double seen = 0, all = 0;
        for (double i = 0.5; i < kSteps; ++i) {
            for (double j = 0.5; j < kSteps; ++j) {
                const double x = 2 * i / kSteps - 1, y = 2 * j / kSteps - 1;
                if (x * x + y * y > 1) continue;
                ++all;
                const double from_u = u - lens.film_shift[0] * x, from_v = v - lens.film_shift[1] * y;
                const double rear_x = x - (u - 0.5) * kEye * job.aspect_width / to_corner,
                             rear_y = y + (v - 0.5) * kEye * job.aspect_height / to_corner;
                if (rear_x * rear_x + rear_y * rear_y <= 1 && from_u >= 0 && from_u < 1 && from_v >= 0 && from_v < 1) ++seen;
            }
        }
        page.u[0] = static_cast<std::uint32_t>(u * 0x1p32), page.v[0] = static_cast<std::uint32_t>(v * 0x1p32);
        // A cell's width, 1/128, along the edge of what the film has seen, which is half of it too far at most; as above, rims.
        EXPECT_NEAR(1 / factor(*weights, page), seen / all, 6e-3) << u << ", " << v;
    }
}

TEST(Focus, DependsOnNeitherMemoryNorThreads) {
    const MemoryRunSet run_set = runs_with_lens({.light_per_sample = 0.3}, 24, 16384);
    LensChoice lens = choice("0.8");
    lens.film_shift = {0.01, 0.02};
    expect_same_with_little_memory(run_set, settings_for(330, 220, "quartic:-6,2"), kAllLayers, lens);
}

class LensTool : public ::testing::Test {
 protected:
    // A file of records that do or do not tell where they met the lens, of a lens that the provenance does or does not tell.
    testing::Outcome develop(bool columns, bool lens, const std::vector<std::string>& options) {
        Job job = job_with_lens();
        if (!columns) job.extra.clear();
        const std::string told = lens ? R"({"lens": {"radius": 0.006, "focus": 3, "window": [-0.5, -0.3, 0.5, 0.3]}})" : "{}";
        synthetic::write_file(folder_ / "a.latent",
                              synthetic::make_file(job, synthetic::runs_between({0, synthetic::kShortRun}), true, {}, told).bytes);
        std::vector<std::string> command = {testing::tool("latent-develop"),
                                            (folder_ / "a.latent").string(),
                                            "-o",
                                            (folder_ / "a.exr").string(),
                                            "--force",
                                            "--size",
                                            "30"};
        command.insert(command.end(), options.begin(), options.end());
        return testing::run(command);
    }
    testing::TemporaryFolder folder_;
};

TEST_F(LensTool, SaysWhatItCostsAndWhatItMadeOfAnFNumber) {
    const testing::Outcome outcome = develop(true, true, {"--aperture", "f:6,blades:6", "--focus", "2.5", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json report = nlohmann::json::parse(outcome.out);
    const double part = 0.25 * 3 * std::sin(std::numbers::pi / 3) / std::numbers::pi;  // rendered as f/3
    EXPECT_NEAR(report["lens"]["light"].get<double>(), part, 1e-3);
    EXPECT_NEAR(report["lens"]["samples_kept"].get<double>(), part, 2e-3);  // cells along the edge count for less
    EXPECT_NEAR(report["lens"]["noise"].get<double>(), 1 / std::sqrt(part), 0.02);
    EXPECT_EQ(report["lens"]["focus"], 2.5);
}

TEST_F(LensTool, WritesTheFramesOfASequence) {
    const testing::Outcome outcome = develop(true, true, {"--frames", "3", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json reports = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(reports.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(reports[i]["output"], (folder_ / fmt::format("a.{:04}.exr", i + 1)).string());
        EXPECT_TRUE(std::filesystem::exists(reports[i]["output"].get<std::string>()));
    }
    std::filesystem::remove(folder_ / "a.0001.exr");
    const testing::Outcome dry = develop(true, true, {"--frames", "3", "--json", "--dry-run"});
    ASSERT_EQ(dry.status, 0) << dry.err;
    const nlohmann::json forecast = nlohmann::json::parse(dry.out);
    EXPECT_EQ(forecast["pictures"], 3);
    EXPECT_EQ(forecast["output"], reports[0]["output"]);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.0001.exr"));
    const auto at = [&](const char* name) { return (folder_ / name).string(); };
    EXPECT_EQ(testing::run({testing::tool("latent-develop"), at("a.latent"), "-o", at("a.exr"), "--frames", "3"}).status, 1);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.0001.exr"));
}

TEST_F(LensTool, SaysWhatToDoAboutFilesThatCannot) {
    const auto refusal = [&](bool columns, bool lens, const std::vector<std::string>& options) {
        const testing::Outcome outcome = develop(columns, lens, options);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        return outcome.err;
    };
    EXPECT_NE(refusal(false, true, {"--aperture", "0.5"}).find("again with --aov lens"), std::string::npos);
    EXPECT_NE(refusal(false, true, {"--focus", "2"}).find("again with --aov lens"), std::string::npos);
    EXPECT_NE(refusal(false, true, {"--frames", "2"}).find("again with --aov time"), std::string::npos);
    EXPECT_NE(refusal(true, true, {"--focus", "9,9"}).find("again with --aov depth,lens, or give a distance"), std::string::npos);
    EXPECT_NE(refusal(true, false, {"--focus", "2"}).find("do not describe their camera's lens"), std::string::npos);
    EXPECT_NE(refusal(true, true, {"--aperture", "f:2"}).find("rendered as f/3; a wider one must be rendered"), std::string::npos);
}

// Frames of a sequence divide the exposure: the shutter of each runs from its beginning to its end.
TEST(Frames, TogetherAreTheWholeExposure) {
    PictureOptions options;
    options.output = "a/film.exr";
    options.frames = 4;
    const std::vector<PictureOptions> frames = frames_of(options);
    ASSERT_EQ(frames.size(), 4u);
    EXPECT_EQ(frames[2].output, "a/film.0003.exr");
    const MemoryRunSet run_set = runs_with_lens({.light_per_sample = 0.3});
    Settings settings = settings_for(12, 8);
    settings.camera = false;
    const Developed whole = develop_in_memory(run_set, settings);
    std::vector<double> sum(whole.picture.pixels().size());
    for (const PictureOptions& frame : frames) {
        const Developed developed = develop_in_memory(run_set, settings, 2, nullptr, {}, frame.lens);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<double>(developed.picture.pixels()[i]) / 4;
    }
    expect_near(whole.picture, sum, 1e-6);
}

TEST(Lens, WhatIsMissingOrImpossibleIsRefusedInOneLine) {
    Job without = job_with_lens();
    without.extra.clear();
    const auto message = [&](const LensChoice& lens) {
        const Result<LensWeights> weights = LensWeights::make(without, lens);
        return weights ? "" : weights.error().message;
    };
    EXPECT_NE(message(choice("0.5")).find("render the scene again with --aov lens"), std::string::npos);
    EXPECT_NE(message(choice("", "0:0.5")).find("render the scene again with --aov time"), std::string::npos);
    for (const char* wide : {"1.5", "2"})
        EXPECT_NE(parse_aperture(wide).error().message.find("a wider lens must be rendered"), std::string::npos);
    for (const char* bad : {"", "0", "-1", "blades:2", "blades:6.5", "blades", "blades:6:10:2", "gaussian:1", "anamorphic:0.5",
                            "cat-eye", "left:1", "star", "0.5,", "f:0", "0.5,f:8", "0.5,0.4", "left,right", "blades:5,blades:6"})
        EXPECT_FALSE(parse_aperture(bad)) << bad;
    for (const char* bad : {"", "0.5", "0.5:0.2", "0:1.5", "0:0.5,0.4:1", "soft,film", "rolling:1", "rolling", "0:0.5:1", "a:b",
                            "rolling:0.1,rolling:0.2"})
        EXPECT_FALSE(parse_shutter(bad)) << bad;
    EXPECT_FALSE(LensWeights::make(job_with_lens(), choice("", "/does/not/exist.csv")));
}

}  // namespace
}  // namespace latent::develop
