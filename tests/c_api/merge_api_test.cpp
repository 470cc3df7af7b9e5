// latent_merge: the same file as latent-merge writes, the same refusals, and what is left out is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "c_api/latent.h"
#include "tests/faults/process.h"
#include "tests/support/synthetic.h"

namespace latent {
namespace {

namespace fs = std::filesystem;
using namespace latent::testing;
using namespace latent::sampledb;

constexpr std::uint64_t kS = synthetic::kShortRun;

struct Heard {
    std::vector<double> progress;
    std::vector<std::string> left_out;
};

class MergeApiTest : public ::testing::Test {
 protected:
    MergeApiTest() {
        options_.size = sizeof options_;
        options_.context = &heard_;
        options_.progress = [](void* heard, double done) { static_cast<Heard*>(heard)->progress.push_back(done); };
        options_.left_out = [](void* heard, const char* item) { static_cast<Heard*>(heard)->left_out.emplace_back(item); };
        info_.size = sizeof info_;
    }

    std::string part(const std::string& name, std::initializer_list<std::uint64_t> boundaries) const {
        const fs::path path = folder_ / name;
        synthetic::write_file(path, synthetic::make_file(synthetic::make_short_job(), synthetic::runs_between(boundaries)).bytes);
        return path.string();
    }
    latent_status merge(const std::vector<std::string>& inputs, const std::string& output) {
        std::vector<const char*> paths;
        for (const std::string& input : inputs) paths.push_back(input.c_str());
        return latent_merge(paths.data(), paths.size(), output.c_str(), &options_, &info_, &error_);
    }

    TemporaryFolder folder_;
    Heard heard_;
    latent_merge_options options_{};
    latent_merge_info info_{};
    latent_error error_{};
};

TEST_F(MergeApiTest, TheOutputIsThatOfTheToolToTheLastByte) {
    const std::string a = part("a.latent", {0, kS, 2 * kS, 3 * kS}), b = part("b.latent", {3 * kS, 4 * kS, 5 * kS});
    for (const bool compact : {false, true}) {
        const std::string by_tool = folder_ / (compact ? "tool-c.latent" : "tool.latent");
        const std::string by_call = folder_ / (compact ? "call-c.latent" : "call.latent");
        std::vector<std::string> command = {tool("latent-merge"), a, b, "-o", by_tool, "--quiet"};
        if (compact) command.emplace_back("--compact");
        ASSERT_EQ(run(command).status, 0);
        options_.compact = compact ? 1 : 0;
        ASSERT_EQ(merge({b, a}, by_call), LATENT_OK) << error_.message;
        EXPECT_EQ(read_text(by_call), read_text(by_tool));
        EXPECT_EQ(info_.samples, 5 * kS);
        EXPECT_EQ(info_.files, 2u);
        EXPECT_EQ(info_.runs_in, 5u);
        EXPECT_EQ(info_.runs_out, compact ? 1u : 5u);
        EXPECT_EQ(info_.bytes, fs::file_size(by_call));
        EXPECT_EQ(info_.left_out, 0u);
    }
    EXPECT_TRUE(heard_.left_out.empty());
    ASSERT_FALSE(heard_.progress.empty());
    EXPECT_TRUE(std::ranges::all_of(heard_.progress, [](double done) { return done >= 0 && done <= 1; }));
}

TEST_F(MergeApiTest, WhatIsDamagedIsLeftOutAndNamed) {
    const std::string a = part("a.latent", {0, kS, 2 * kS, 3 * kS}), out = folder_ / "out.latent";
    std::string bytes = read_text(a);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    std::ofstream(a, std::ios::binary) << bytes;
    ASSERT_EQ(merge({a}, out), LATENT_OK) << error_.message;
    EXPECT_EQ(info_.samples, 2 * kS);
    EXPECT_EQ(info_.left_out, 1u);
    ASSERT_EQ(heard_.left_out.size(), 1u);
    EXPECT_NE(heard_.left_out[0].find("a.latent"), std::string::npos) << heard_.left_out[0];
}

TEST_F(MergeApiTest, AFailureIsAnErrorWithAMessageAndLeavesNoOutput) {
    const std::string a = part("a.latent", {0, kS, 2 * kS, 3 * kS}), out = folder_ / "out.latent";
    const std::vector<std::string> before = folder_.names();
    const auto refused = [&](latent_status status, latent_status expected) {
        EXPECT_EQ(status, expected) << error_.message;
        EXPECT_EQ(error_.status, expected);
        EXPECT_GT(std::strlen(error_.message), 5u);
        error_ = {};
        EXPECT_EQ(folder_.names(), before);
    };
    const auto with = [&](auto change) {
        const latent_merge_options saved = options_;
        change(options_);
        const latent_status status = merge({a}, out);
        options_ = saved;
        return status;
    };
    refused(merge({}, out), LATENT_USAGE);
    refused(merge({a}, folder_ / "out.txt"), LATENT_USAGE);
    refused(merge({a, a}, out), LATENT_MISMATCH);
    refused(merge({a, folder_ / "absent.latent"}, out), LATENT_NOT_FOUND);
    refused(merge({a}, a), LATENT_EXISTS);
    refused(with([](latent_merge_options& o) { o.size = 0; }), LATENT_USAGE);
    refused(with([](latent_merge_options& o) { o.verify = 3; }), LATENT_UNSUPPORTED);
    refused(with([](latent_merge_options& o) { o.threads = ~0u; }), LATENT_OUT_OF_RANGE);
    refused(with([](latent_merge_options& o) { o.require = {5, 4}; }), LATENT_USAGE);
    refused(with([](latent_merge_options& o) { o.require = {0, 3 * kS + 1}; }), LATENT_MISMATCH);
    refused(with([](latent_merge_options& o) { o.job_low = 1; }), LATENT_MISMATCH);
    const char* const null_path[] = {nullptr};
    refused(latent_merge(null_path, 1, out.c_str(), &options_, &info_, &error_), LATENT_USAGE);
    refused(latent_merge(nullptr, 1, out.c_str(), &options_, &info_, &error_), LATENT_USAGE);
    const char* const paths[] = {a.c_str()};
    refused(latent_merge(paths, 1, nullptr, &options_, &info_, &error_), LATENT_USAGE);
    info_.size = 0;
    refused(latent_merge(paths, 1, out.c_str(), &options_, &info_, &error_), LATENT_USAGE);
    EXPECT_EQ(latent_merge(paths, 1, out.c_str(), nullptr, nullptr, nullptr), LATENT_OK);
    EXPECT_EQ(read_text(out).substr(0, 8), read_text(a).substr(0, 8));
}

}  // namespace
}  // namespace latent
