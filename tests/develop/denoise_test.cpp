// Denoised pixels are means over neighbours that the samples cannot tell apart; what they can tell apart stays apart.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "color/rgb_space.h"
#include "tests/color/simd_targets.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"
#include "tools/develop/denoise/denoiser.h"
#include "tools/develop/picture/picture.h"
#include "tools/develop/picture/pixel_array.h"

namespace latent::develop {
namespace {

using latent::testing::TemporaryFolder;
using sampledb::Coverage;
using sampledb::Job;
using sampledb::SampleRange;

constexpr int kSide = 64;
constexpr PixelRect kAll{0, 0, kSide, kSide};
constexpr double kSigma = 0.1;
const std::vector<std::string> kNames = {"R", "variance.R", "half0.R", "half1.R", "albedo.R", "albedo.G", "albedo.B"};

struct Pixel {
    float value, albedo;
};

// Pixels whose halves have normal noise, so that their mean has the standard error kSigma.
template <class At>
std::vector<float> noisy(const At& at, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, static_cast<float>(kSigma * std::sqrt(2.0)));
    std::vector<float> pixels;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const Pixel pixel = at(x, y);
            const float half0 = pixel.value + noise(random), half1 = pixel.value + noise(random);
            pixels.insert(pixels.end(), {(half0 + half1) / 2, 0, half0, half1, pixel.albedo, pixel.albedo, pixel.albedo});
        }
    }
    return pixels;
}

struct Statistics {
    double mean = 0, square = 0, said = 0;  // of errors, of their squares, of the variance layer
};
// Of pixels of some columns, over several pictures.
template <class At>
Statistics errors(const At& at, int x0, int x1, double amount = 1) {
    constexpr int kPictures = 8;
    Statistics sums;
    for (unsigned seed = 1; seed <= kPictures; ++seed) {
        const std::vector<float> out = denoise(DenoisedValues::find(kNames), amount, kAll, noisy(at, seed), kAll);
        for (int y = 0; y < kSide; ++y) {
            for (int x = x0; x < x1; ++x) {
                const float* const pixel = out.data() + static_cast<std::size_t>(y * kSide + x) * kNames.size();
                const double error = static_cast<double>(pixel[0] - at(x, y).value);
                sums.mean += error, sums.square += error * error, sums.said += static_cast<double>(pixel[1]);
            }
        }
    }
    const double count = kPictures * kSide * (x1 - x0);
    return {sums.mean / count, sums.square / count, sums.said / count};
}

TEST(Denoise, NoiseOfAPlainSurfaceFallsAndItsMeanStays) {
    const Statistics plain = errors([](int, int) { return Pixel{1, 0.5f}; }, 0, kSide);
    EXPECT_LT(plain.square, kSigma * kSigma / 16);
    EXPECT_GT(plain.square, kSigma * kSigma / 97);  // there are 97 neighbours
    // Neighbours are chosen by the noise that they are averaged with, so there is more than the layer says.
    EXPECT_GT(plain.said, plain.square / 3);
    EXPECT_LT(plain.said, plain.square);
    // 4 standard errors: means over pictures of 64 x 64 pixels are independent of what the denoiser does, but for its weights.
    EXPECT_LT(std::abs(plain.mean), 4 * kSigma / std::sqrt(8.0 * kSide * kSide));
}

TEST(Denoise, WhatDiffersByManyStandardErrorsStaysApart) {
    for (const double step : {6 * kSigma, 20 * kSigma}) {
        const auto edge = [&](int x, int) { return Pixel{x < kSide / 2 ? 1.0f : static_cast<float>(1 + step), 0.5f}; };
        const Statistics beside = errors(edge, kSide / 2 - 1, kSide / 2 + 1), left = errors(edge, kSide / 2 - 1, kSide / 2);
        EXPECT_LT(beside.square, kSigma * kSigma / 4) << step;  // there, half of the neighbours are left
        EXPECT_LT(std::abs(left.mean), 0.01 * step) << step;
    }
}

TEST(Denoise, SurfacesStayApartWhereLightAloneDoesNotTell) {
    const auto faint = [](bool seen) {
        return [seen](int x, int) { return Pixel{x < kSide / 2 ? 1.0f : 1.05f, seen && x >= kSide / 2 ? 0.8f : 0.5f}; };
    };
    const double blurred = errors(faint(false), kSide / 2 - 2, kSide / 2).mean,
                 sharp = errors(faint(true), kSide / 2 - 2, kSide / 2).mean;
    EXPECT_GT(blurred, 0.01);  // a fifth of the step or more crosses the edge
    EXPECT_LT(std::abs(sharp), blurred / 4);
}

TEST(Denoise, AnAmountIsAMixWithTheNoisyPicture) {
    const std::vector<float> pixels = noisy([](int x, int) { return Pixel{1 + 0.01f * static_cast<float>(x), 0.5f}; }, 3);
    const DenoisedValues values = DenoisedValues::find(kNames);
    const std::vector<float> all = denoise(values, 1, kAll, pixels, kAll), half = denoise(values, 0.5, kAll, pixels, kAll);
    for (std::size_t i = 0; i < all.size(); i += kNames.size()) ASSERT_NEAR(half[i], (all[i] + pixels[i]) / 2, 1e-6) << i;
}

TEST(Denoise, APixelDependsOnThoseWithinReachAlone) {
    const std::vector<float> pixels = noisy(
        [](int x, int y) {
            return Pixel{1 + 0.1f * static_cast<float>((x ^ y) & 8), 0.5f};
        },
        4);
    const DenoisedValues values = DenoisedValues::find(kNames);
    const std::vector<float> all = denoise(values, 1, kAll, pixels, kAll);
    for (const PixelRect& wanted : {PixelRect{20, 25, 21, 26}, PixelRect{0, 40, 9, 64}, PixelRect{13, 0, 64, 3}}) {
        const PixelRect held = within_reach(wanted, kAll);
        const auto part_of = [&](const std::vector<float>& from, const PixelRect& part) {
            std::vector<float> out;
            for (std::int64_t y = part.y0; y < part.y1; ++y) {
                const auto row = from.begin() + (y * kSide + part.x0) * static_cast<std::int64_t>(kNames.size());
                out.insert(out.end(), row, row + part.width() * static_cast<std::int64_t>(kNames.size()));
            }
            return out;
        };
        EXPECT_EQ(denoise(values, 1, held, part_of(pixels, held), wanted), part_of(all, wanted));
    }
}

// All light of a bright pixel is in one half: its standard error is as large as its value. Dark pixels beyond the reach of patches
// and of measured variances take none of it, although the difference is only one standard error.
TEST(Denoise, IsTheSameOnAllProcessors) {
    const std::vector<float> pixels = noisy(
        [](int x, int y) {
            return Pixel{1 + 0.1f * static_cast<float>((x ^ y) & 8), 0.5f};
        },
        6);
    const DenoisedValues values = DenoisedValues::find(kNames);
    const std::vector<float> once = denoise(values, 1, kAll, pixels, {3, 0, 50, 61});
    color::with_every_simd_target([&] { EXPECT_EQ(denoise(values, 1, kAll, pixels, {3, 0, 50, 61}), once); });
}

TEST(Denoise, LightOfFewSamplesDoesNotSpreadOverTheDark) {
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0, static_cast<float>(kSigma));
    std::vector<float> pixels;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const bool bright = x >= kSide / 2, first = (random() & 1) != 0;
            const float half0 = bright ? (first ? 200.0f : 0.0f) : 1 + noise(random),
                        half1 = bright ? 200 - half0 : 1 + noise(random);
            pixels.insert(pixels.end(), {(half0 + half1) / 2, 0, half0, half1, 0.5f, 0.5f, 0.5f});
        }
    }
    const std::vector<float> out = denoise(DenoisedValues::find(kNames), 1, kAll, pixels, kAll);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide / 2 - 3; ++x)
            EXPECT_NEAR(out[static_cast<std::size_t>(y * kSide + x) * kNames.size()], 1, 4 * kSigma) << x << "," << y;
    }
}

TEST(Denoise, PixelsWithoutRecordsNeitherGetLightNorTakeIt) {
    const auto plain = [](int, int) { return Pixel{0.3f, 0.5f}; };
    std::vector<std::string> names = kNames;
    names.emplace_back("weight");
    const auto is_known = [](int x, int y) { return x % 8 != 4 || y % 8 != 4; };
    const auto with_weight = [&](const std::vector<float>& from) {
        std::vector<float> pixels;
        for (int i = 0; i < kSide * kSide; ++i) {
            const float* const pixel = from.data() + static_cast<std::size_t>(i) * kNames.size();
            const bool known = is_known(i % kSide, i / kSide);
            for (std::size_t k = 0; k < kNames.size(); ++k)
                pixels.push_back(known || k >= 4 ? pixel[k] : 0);  // surfaces do not tell
            pixels.push_back(known ? 3.0f : 0.0f);
        }
        return pixels;
    };
    const std::vector<float> out = denoise(DenoisedValues::find(names), 1, kAll, with_weight(noisy(plain, 9)), kAll);
    double sum = 0, count = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const float value = out[static_cast<std::size_t>(i) * names.size()];
        if (is_known(i % kSide, i / kSide))
            sum += static_cast<double>(value), ++count;
        else
            EXPECT_EQ(value, 0) << i;
    }
    EXPECT_NEAR(sum / count, 0.3, 4 * kSigma / std::sqrt(count));
}

// Light of one group that varies, and of another that ends at an edge.
TEST(Denoise, LightGroupsAreDenoisedByThemselvesAndTheirSumIsThePicture) {
    const auto group = [](bool edge) { return [edge](int x, int) { return Pixel{edge && x >= kSide / 2 ? 0.2f : 1.0f, 0.5f}; }; };
    const std::vector<float> alone[2] = {noisy(group(false), 6), noisy(group(true), 7)};
    const std::vector<std::string> names = {"R",         "noisy.R",         "variance.R",      "half0.R",
                                            "half1.R",   "light.a.R",       "half0.light.a.R", "half1.light.a.R",
                                            "light.b.R", "half0.light.b.R", "half1.light.b.R", "albedo.R",
                                            "albedo.G",  "albedo.B"};
    std::vector<float> pixels;
    for (std::size_t i = 0; i < alone[0].size(); i += kNames.size()) {
        const float *const a = &alone[0][i], *const b = &alone[1][i];
        const float sum = a[0] + b[0];
        pixels.insert(pixels.end(), {sum, sum, 0, a[2] + b[2], a[3] + b[3], a[0], a[2], a[3], b[0], b[2], b[3], a[4], a[5], a[6]});
    }
    const std::vector<float> out = denoise(DenoisedValues::find(names), 1, kAll, pixels, kAll);
    const auto denoised = [](const std::vector<float>& from) { return denoise(DenoisedValues::find(kNames), 1, kAll, from, kAll); };
    const std::vector<float> a = denoised(alone[0]), b = denoised(alone[1]);
    for (std::size_t pixel = 0; pixel < out.size() / names.size(); ++pixel) {
        const float* const all = &out[pixel * names.size()];
        const std::size_t at = pixel * kNames.size();
        ASSERT_EQ(all[5], a[at]) << pixel;
        ASSERT_EQ(all[8], b[at]) << pixel;
        ASSERT_EQ(all[0], a[at] + b[at]) << pixel;
        ASSERT_EQ(all[1], pixels[pixel * names.size() + 1]) << pixel;
        ASSERT_EQ(all[2], a[at + 1] + b[at + 1]) << pixel;
    }
}

class DenoisedFile : public ::testing::Test {
 protected:
    static constexpr std::uint32_t kWidth = 300;

    DenoisedFile() {
        Job job = synthetic::make_short_job();
        job.extra = {{"normal.x", sampledb::ColumnType::kF32},
                     {"normal.y", sampledb::ColumnType::kF32},
                     {"normal.z", sampledb::ColumnType::kF32},
                     {"depth", sampledb::ColumnType::kF32}};
        write("with.latent", job);
        job.extra.clear();
        write("without.latent", job);
        options_.size = std::to_string(kWidth);
        options_.denoise = 1;
    }
    void write(const std::string& name, const Job& job) {
        std::vector<Coverage> runs;
        for (std::uint64_t i = 0; i < 60; ++i)
            runs.emplace_back(SampleRange{i * synthetic::kShortRun, (i + 1) * synthetic::kShortRun});
        synthetic::write_file(folder_ / name, synthetic::make_file(job, runs).bytes);
    }
    PixelArray develop(const std::string& name, const PictureOptions& options) const {
        PictureOptions all = options;
        all.inputs = {folder_ / name};
        PixelArray picture;
        const Result<PictureReport> report = develop_picture(all, picture, {});
        EXPECT_TRUE(report) << report.error().message;
        return picture;
    }

    TemporaryFolder folder_;
    PictureOptions options_;
};

TEST_F(DenoisedFile, ACropIsAPartOfTheWholeForAnyThreadsAndMemory) {
    for (const char* name : {"with.latent", "without.latent"}) {
        const PixelArray whole = develop(name, options_);
        EXPECT_EQ(whole.channels(), (std::vector<std::string>{"R", "G", "B"}));
        PictureOptions options = options_;
        options.crop = PixelRect{3, 70, 290, 141};
        options.threads = 1;
        options.memory = 48 << 20;
        const PixelArray crop = develop(name, options);
        ASSERT_EQ(crop.width(), 287u);
        for (std::size_t y = 0; y < crop.height(); ++y) {
            const std::size_t row = ((y + 70) * kWidth + 3) * 3;
            ASSERT_TRUE(std::equal(crop.pixels().begin() + static_cast<std::ptrdiff_t>(y * crop.width() * 3),
                                   crop.pixels().begin() + static_cast<std::ptrdiff_t>((y + 1) * crop.width() * 3),
                                   whole.pixels().begin() + static_cast<std::ptrdiff_t>(row)))
                << name << " " << y;
        }
    }
}

TEST_F(DenoisedFile, LayersThatWereAskedForAreThoseOfTheNoisyPicture) {
    options_.layers.halves = options_.layers.depth = options_.layers.variance = options_.layers.noisy = true;
    const PixelArray denoised = develop("with.latent", options_);
    options_.denoise = 0;
    const PixelArray noisy = develop("with.latent", options_);
    ASSERT_EQ(denoised.channels(), noisy.channels());
    const std::size_t channels = noisy.channels().size();
    for (std::size_t i = 0; i < noisy.pixels().size(); ++i) {
        const std::string& channel = noisy.channels()[i % channels];
        if (channel.starts_with("half") || channel.starts_with("noisy.") || channel == "Z") {
            ASSERT_EQ(denoised.pixels()[i], noisy.pixels()[i]) << channel;
        } else if (channel.starts_with("variance.")) {
            ASSERT_GE(denoised.pixels()[i], 0);
        }
    }
}

// Pixels of a PFM file, from the top down.
std::vector<float> read_pfm(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string header = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
    const std::size_t row = std::size_t{width} * 3;
    std::vector<float> pixels(row * height);
    EXPECT_EQ(bytes.substr(0, header.size()), header);
    EXPECT_EQ(bytes.size(), header.size() + pixels.size() * sizeof(float));
    if (bytes.size() != header.size() + pixels.size() * sizeof(float)) return pixels;
    for (std::size_t y = 0; y < height; ++y)
        std::memcpy(&pixels[(height - 1 - y) * row], bytes.data() + header.size() + y * row * sizeof(float), row * sizeof(float));
    return pixels;
}

TEST_F(DenoisedFile, FilesForOidnHoldThePictureInLinearSrgbAndTheLayersOfTheFile) {
    options_.denoise = 0;
    options_.layers.normal = true;
    const PixelArray picture = develop("with.latent", options_);
    options_.layers = {};
    options_.inputs = {folder_ / "with.latent"};
    options_.for_oidn = folder_ / "p";
    const Result<PictureReport> report = develop_picture(options_, {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "p.alb.pfm"));
    const std::vector<float> rgb = read_pfm(folder_ / "p.hdr.pfm", report->width, report->height),
                             normal = read_pfm(folder_ / "p.nrm.pfm", report->width, report->height);
    ASSERT_EQ(rgb.size() * 2, picture.pixels().size());
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        const float* const pixel = &picture.pixels()[2 * i];
        const auto expected = color::RgbSpace::srgb().rgb_from_xyz * std::array<double, 3>{pixel[0], pixel[1], pixel[2]};
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(rgb[i + c], static_cast<float>(expected[c])) << i;
            ASSERT_EQ(normal[i + c], pixel[3 + c]) << i;
        }
    }
    const Result<PictureReport> again = develop_picture(options_, {});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, ErrorCode::kExists);
}

}  // namespace
}  // namespace latent::develop
