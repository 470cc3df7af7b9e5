// The path of bench/gigapixel with the real tools, in budgets so small that the film is cut into hundreds of regions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "image/exr_reader.h"
#include "tests/faults/process.h"

namespace latent {
namespace {

using testing::Outcome;

constexpr int kCorner = 300;
constexpr long kSlackMiB = 100;

struct Case {
    int width, height;
    const char* aspect;
    const char* records;
    long develop_mib;
    int min_regions;
};

std::vector<float> corner_of(const std::filesystem::path& path, int width, int height) {
    std::vector<float> pixels(std::size_t{3} * kCorner * kCorner);
    const auto exr = image::ExrReader::open(path);
    if (!exr) {
        ADD_FAILURE() << exr.error().message;
        return pixels;
    }
    constexpr std::size_t kPlane = std::size_t{kCorner} * kCorner;
    image::ExrReader::Scratch scratch;
    const Status read = exr->read({width - kCorner, height - kCorner, width, height},
                                  {pixels.data(), pixels.data() + kPlane, pixels.data() + 2 * kPlane}, kCorner, scratch);
    EXPECT_TRUE(read) << read.error().message;
    return pixels;
}

class FlatMemory : public ::testing::TestWithParam<Case> {};

TEST_P(FlatMemory, LargePicturesAreDevelopedAndPrintedWithinTheBudgetReadingEachPageOnce) {
    const auto& [width, height, aspect, records, develop_mib, min_regions] = GetParam();
    const testing::TemporaryFolder folder;
    const std::string in = folder / "in.latent", whole = folder / "whole.exr", corner = folder / "corner.exr";
    const std::string size = fmt::format("{}x{}", width, height);

    const Outcome gen = testing::run(
        {testing::tool("latent-inspect"), "gen", "-o", in, "--records", records, "--light", "0.05", "--aspect", aspect});
    ASSERT_EQ(gen.status, 0) << gen.err;

    const Outcome develop = testing::run({testing::tool("latent-develop"), in, "-o", whole, "--size", size, "--memory",
                                          fmt::format("{}M", develop_mib), "--threads", "2", "--json"});
    ASSERT_EQ(develop.status, 0) << develop.err;
    const auto report = nlohmann::json::parse(develop.out);
    RecordProperty("regions", report["regions"].dump());
    RecordProperty("develop_peak_kib", std::to_string(develop.peak_rss_kib));
    EXPECT_GE(report["regions"], min_regions);
    EXPECT_EQ(report["decode_factor"], 1.0);
    EXPECT_LE(report["bytes_read"].get<double>(), 1.05 * static_cast<double>(std::filesystem::file_size(in)));
    EXPECT_LE(develop.peak_rss_kib, (develop_mib + kSlackMiB) << 10);

    const Outcome crop = testing::run({testing::tool("latent-develop"), in, "-o", corner, "--size", size, "--crop",
                                       fmt::format("{},{},{},{}", width - kCorner, height - kCorner, width, height)});
    ASSERT_EQ(crop.status, 0) << crop.err;
    const std::vector<float> expected = corner_of(corner, width, height);
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 0);
    EXPECT_TRUE(corner_of(whole, width, height) == expected) << "the far corner differs from the whole's";

    constexpr long kConvertMiB = 64;
    const Outcome convert = testing::run(
        {testing::tool("latent-convert"), whole, "-o", folder / "print.dzi", "--memory", fmt::format("{}M", kConvertMiB)});
    ASSERT_EQ(convert.status, 0) << convert.err;
    RecordProperty("convert_peak_kib", std::to_string(convert.peak_rss_kib));
    EXPECT_LE(convert.peak_rss_kib, (kConvertMiB + kSlackMiB) << 10);
    EXPECT_TRUE(std::filesystem::exists(folder / "print_files/0/0_0.jpg"));
    EXPECT_TRUE(std::filesystem::exists(folder / "print_files/13/0_0.jpg"));
}

INSTANTIATE_TEST_SUITE_P(Sizes, FlatMemory,
                         ::testing::Values(Case{8192, 8192, "1:1", "26M", 22, 200}, Case{7000, 5000, "7:5", "24M", 21, 100}),
                         [](const auto& a) { return fmt::format("{}x{}", a.param.width, a.param.height); });

}  // namespace
}  // namespace latent
