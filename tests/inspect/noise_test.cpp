#include "tools/inspect/noise.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sampledb/data/film_position.h"
#include "sampledb/write/part_writer.h"
#include "tests/inspect/inspect_test.h"
#include "tools/inspect/synthetic.h"

namespace latent::inspect {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using develop::Noise;
using develop::NoiseLevel;
using develop::NoiseMap;
using nlohmann::json;
using ::testing::HasSubstr;

constexpr std::uint32_t kWide = 128;              // pixels of the picture, in both directions
constexpr std::uint64_t kPixels = kWide * kWide;  // in 64 areas
constexpr std::uint64_t kSamples = 64 * kPixels;

// Each sample has a value of 0 or 2, with the same chance: mean 1, variance 1. Camera records, or light records of 0 or 2 at random
// places of the film.
Grain coins(const Job& job, SampleRange range, RecordClass record_class) {
    Grain grain{range, {}};
    for (std::uint64_t n = range.first; n < range.end; ++n) {
        std::uint64_t state = n << 20;
        const auto random = [&state] {  // [SplitMix64]
            std::uint64_t z = state += 0x9E3779B97F4A7C15u;
            z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
            z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
            return z ^ (z >> 31);
        };
        const std::uint64_t place = random();
        const FilmPosition at = record_class == RecordClass::kCamera
                                    ? halton23(n, job.positions)
                                    : FilmPosition{static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(place >> 32)};
        const float value = random() >> 63 == 0 ? 0.0f : 2.0f;
        Records& to = grain.records;
        to.sample.push_back(n);
        to.record_class.push_back(record_class);
        to.u.push_back(at.u);
        to.v.push_back(at.v);
        to.share.push_back(record_class == RecordClass::kCamera ? 1.0f : 0.0f);
        for (auto* column : {&to.x, &to.y, &to.z}) column->push_back(value);
    }
    return grain;
}

class NoiseTest : public InspectTest {
 protected:
    static SyntheticScene scene(RecordClass record_class) {
        SyntheticScene scene;
        scene.light_records = record_class == RecordClass::kLight ? 1 : 0;
        scene.run_samples = kSamples / 4;
        return scene;
    }
    fs::path toss(const std::string& name, std::uint64_t samples, RecordClass record_class = RecordClass::kCamera) const {
        const Job job = synthetic_job(scene(record_class));
        PartOptions part;
        part.path = folder_ / name;
        part.range = {0, samples};
        const auto writer = PartWriter::open(part, job);
        EXPECT_TRUE(writer) << writer.error().message;
        for (std::uint64_t first = 0; first < samples; first += kGrainSamples)
            EXPECT_TRUE((*writer)->submit(coins(job, {first, std::min(samples, first + kGrainSamples)}, record_class)));
        EXPECT_TRUE((*writer)->finish());
        return part.path;
    }
    static Noise noise_of(const fs::path& file, const std::string& filter, std::optional<develop::PixelRect> crop = std::nullopt) {
        develop::PictureOptions options;
        options.inputs = {file};
        options.size = std::to_string(kWide);
        options.filter = filter;
        options.crop = crop;
        Result<Noise> noise = develop::measure_noise(options, 4, false, {});
        EXPECT_TRUE(noise) << noise.error().message;
        return *std::move(noise);
    }
};

// The estimate of an area is the root of a mean of 256 squares of (nearly) normal differences: chi-square, with a relative standard
// deviation of 1 / sqrt(2 * 256), and a median 0.13 % below the mean. The median of the 64 areas has 1.25 / sqrt(64) of that.
constexpr double kMedianError = 1.2533 / 8 / 22.627;  // 0.69 %
constexpr double kSigmas = 4;

TEST_F(NoiseTest, IsThatOfIndependentSamplesOfKnownVariance) {
    const Noise noise = noise_of(toss("coins.latent", kSamples), "box");
    ASSERT_EQ(noise.levels.size(), 5u);
    for (std::size_t i = 0; i < 3; ++i) {
        const double n = 64 >> i;
        EXPECT_EQ(noise.levels[i].samples_per_pixel, n);
        // Halton's points put n into each pixel, give or take one or two, and a fair coin into either half: the mean of 1 / m for m
        // of n is 2 / n (1 + 1 / n).
        EXPECT_NEAR(noise.levels[i].relative.median, std::sqrt((1 + 1 / n) / n), (kSigmas * kMedianError + 0.002) / std::sqrt(n))
            << n;
    }
    EXPECT_LT(noise.levels[0].relative.p95 * 8, 1 + 3 / 22.627);  // 1.64 sigmas of an area, and some chance
}

// The default filter weighs the samples of a pixel and its neighbours, which divides the variance by (sum w)^2 / sum w^2.
TEST_F(NoiseTest, FollowsFromTheFilter) {
    double sum = 0, squares = 0;
    constexpr int kSteps = 600;
    constexpr double kRadius = 1.5, kStep = 2 * kRadius / kSteps;
    for (int y = 0; y < kSteps; ++y) {
        for (int x = 0; x < kSteps; ++x) {
            const double rho = std::hypot((x + 0.5) * kStep - kRadius, (y + 0.5) * kStep - kRadius) / kRadius;
            const double w = rho < 1 ? std::pow(1 - rho, 3) * (1 + 3 * rho) : 0;
            sum += w * kStep * kStep, squares += w * w * kStep * kStep;
        }
    }
    // Pixels share samples: of 256 in an area, as many as this are independent.
    const double independent = squares / (sum * sum);
    const Noise noise = noise_of(toss("coins.latent", kSamples), "quartic:-3,1.5");
    EXPECT_NEAR(noise.levels[0].relative.median, std::sqrt(independent / 64),
                kSigmas * kMedianError * std::sqrt(1 / independent) * std::sqrt(independent / 64));
}

// Light records at random places, one for each sample: their number in a pixel has the variance of its mean n, and so the sum of
// values of mean 1 and mean square 2 has the variance 2 n.
TEST_F(NoiseTest, CountsTheLightImage) {
    const Noise noise = noise_of(toss("light.latent", kSamples, RecordClass::kLight), "box");
    EXPECT_NEAR(noise.levels[0].relative.median, std::sqrt(2.0 / 64), (kSigmas * kMedianError + 0.002) * std::sqrt(2.0 / 64));
}

// The exponent is the slope over five levels whose logarithms have that error each; the forecast squares the median.
TEST_F(NoiseTest, OfMoreSamplesIsForecastByFewer) {
    const Noise all = noise_of(toss("coins.latent", kSamples), "quartic:-3,1.5");
    const double error = kMedianError * std::sqrt(2.6);  // overlapping pixels: (sum w)^2 / sum w^2 is 2.6 for this filter
    EXPECT_NEAR(all.exponent, 0.5, kSigmas * error / (std::log(2.0) * std::sqrt(10.0)) + 0.01);
    const Noise quarter = noise_of(toss("quarter.latent", kSamples / 4), "quartic:-3,1.5");
    EXPECT_NEAR(quarter.samples_for(all.levels[0].relative.median) / static_cast<double>(kSamples), 1,
                kSigmas * 2 * std::sqrt(2.0) * error);
    // The first quarter of the samples is what a file of these samples measures.
    EXPECT_EQ(all.levels[2].relative.median, quarter.levels[0].relative.median);
    EXPECT_EQ(all.levels[2].samples, quarter.levels[0].samples);
}

TEST_F(NoiseTest, OfACropIsThatOfItsPlaceInTheWhole) {
    const fs::path file = toss("coins.latent", 8 * kPixels);
    constexpr std::int64_t kSide = NoiseMap::kSide;
    const Noise all = noise_of(file, "quartic:-3,1.5");
    const Noise crop = noise_of(file, "quartic:-3,1.5", develop::PixelRect{2 * kSide, 3 * kSide, 5 * kSide + 4, 5 * kSide});
    ASSERT_EQ(crop.map.columns(), 4u);
    ASSERT_EQ(crop.map.rows(), 2u);
    for (std::size_t row = 0; row < 2; ++row) {
        for (std::size_t column = 0; column < 3; ++column)
            EXPECT_EQ(crop.map.relative(column, row), all.map.relative(2 + column, 3 + row));
    }
}

TEST_F(NoiseTest, IsReportedAsTextJsonAndMaps) {
    const std::string file = toss("coins.latent", 16 * kPixels);
    const auto measured = inspect({"noise", file, "--size", "128", "--json", "-o", folder_ / "noise.png"});
    ASSERT_EQ(measured.status, 0) << measured.err;
    const json report = json::parse(measured.out);
    EXPECT_EQ(report["width"], kWide);
    ASSERT_EQ(report["levels"].size(), 3u);
    EXPECT_EQ(report["levels"][0]["samples"], 16 * kPixels);
    ASSERT_EQ(report["targets"].size(), 3u);
    EXPECT_EQ(report["targets"][0]["median"], 0.02);
    EXPECT_TRUE(report["targets"][0]["cpu_seconds"].is_null());  // nobody has measured it
    // Half the noise takes as many bytes and samples more as the exponent says, which is not taken to be below 1/2.
    EXPECT_LE(report["targets"][1]["samples"].get<double>() / report["targets"][0]["samples"].get<double>(), 4 * (1 + 1e-9));
    const auto bytes = static_cast<double>(fs::file_size(file));
    const double samples = report["targets"][0]["samples"].get<double>();
    EXPECT_NEAR(report["targets"][0]["bytes"].get<double>() / samples * 16 * kPixels, bytes, 0.02 * bytes);
    EXPECT_GT(fs::file_size(folder_ / "noise.png"), 0u);
    const auto text = inspect({"noise", file, "--size", "128", "-o", folder_ / "noise.exr"});
    EXPECT_EQ(text.status, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("128 x 128 pixels of 128 x 128"));
    EXPECT_GT(fs::file_size(folder_ / "noise.exr"), 0u);
    EXPECT_EQ(inspect({"noise", file, "-o", folder_ / "noise.exr"}).status, 1);  // it exists
    EXPECT_EQ(inspect({"noise", file, "-o", folder_ / "noise.txt"}).status, 2);
}

TEST_F(NoiseTest, OfTooLittleIsSaidInWords) {
    const fs::path one = folder_ / "one.latent", black = folder_ / "black.latent";
    ASSERT_EQ(inspect({"gen", "-o", one, "--records", "1"}).status, 0);
    const auto refused = inspect({"noise", one});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, HasSubstr("two samples or more are needed to see noise"));
    ASSERT_EQ(inspect({"gen", "-o", black, "--records", "64K", "--texture", "black"}).status, 0);
    const auto dark = inspect({"noise", black, "--size", "16"});
    EXPECT_EQ(dark.status, 0) << dark.err;
    EXPECT_THAT(dark.out, HasSubstr("no light reaches the picture"));
    const auto few = inspect({"noise", toss("few.latent", 4 * kPixels), "--size", "128"});
    EXPECT_THAT(few.out, HasSubstr("too few samples to see how the median falls"));
}

}  // namespace
}  // namespace latent::inspect
