// Bytes of a file on a web server: those of the file, however badly the server behaves, or an error.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "base/stopwatch.h"
#include "sampledb/http/http_source.h"
#include "tests/faults/process.h"

namespace latent::sampledb {
namespace {

using namespace latent::testing;

constexpr std::size_t kSize = (3 << 20) + 1234;

// tests/remote/server.py, with a file of random bytes.
class HttpTest : public ::testing::Test {
 protected:
    HttpTest() {
        std::mt19937_64 random(1);
        for (std::byte& byte : bytes_) byte = static_cast<std::byte>(random());
        std::ofstream(folder_ / "file").write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(kSize));
        std::ofstream(folder_ / "empty").flush();
        server_ = std::make_unique<Child>(std::vector<std::string>{
            "/usr/bin/env", "python3", "-B", in_tree("tests/remote/server.py"), folder_.path().string(), folder_ / "port"});
        for (int i = 0; i < 3000 && !std::filesystem::exists(folder_ / "port"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        server_url_ = "http://127.0.0.1:" + read_text(folder_ / "port") + "/";
    }

    Result<std::shared_ptr<const HttpSource>> open(const std::string& path) const {
        return HttpSource::open(server_url_ + path, std::make_shared<BlockCache>(patience_));
    }
    std::shared_ptr<const HttpSource> opened(const std::string& path) const {
        auto source = open(path);
        EXPECT_TRUE(source) << source.error().message;
        return source ? *source : nullptr;
    }
    void expect_bytes(const ByteSource& source, std::uint64_t offset, std::size_t count) const {
        Bytes read(count);
        const Status status = source.read(offset, read);
        ASSERT_TRUE(status) << status.error().message;
        EXPECT_TRUE(std::equal(read.begin(), read.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset)))
            << offset << " " << count;
    }
    void expect_error(const std::string& path, ErrorCode code, const std::string& what) const {
        const auto source = open(path);
        ASSERT_FALSE(source) << path;
        EXPECT_EQ(source.error().code, code);
        EXPECT_NE(source.error().message.find(what), std::string::npos) << source.error().message;
        EXPECT_TRUE(source.error().message.starts_with(server_url_)) << source.error().message;
    }

    TemporaryFolder folder_;
    Bytes bytes_ = Bytes(kSize);
    Patience patience_{.first_wait = 0.01, .stalled_seconds = 1};
    std::unique_ptr<Child> server_;
    std::string server_url_;
};

TEST_F(HttpTest, ReadsAreThoseOfTheFileHoweverTheServerBehaves) {
    for (const std::string way : {"plain", "rough", "moved"}) {
        SCOPED_TRACE(way);
        const auto source = opened(way + "/file");
        ASSERT_TRUE(source);
        EXPECT_EQ(source->size(), kSize);
        expect_bytes(*source, 0, kSize);
        std::vector<std::thread> threads;
        for (unsigned seed = 0; seed < 4; ++seed) {
            threads.emplace_back([&, seed] {
                std::mt19937_64 random(seed);
                const auto again = opened(way + "/file");  // with a cache of its own, empty
                for (int i = 0; again && i < 30; ++i) {
                    const std::size_t count = 1 + random() % (random() % 20 == 0 ? 1 << 20 : 1 << 14);
                    const std::uint64_t offset = random() % (kSize - std::min(kSize, count) + 1);
                    if (random() % 3 == 0) again->will_read(offset, count);
                    if (random() % 3 == 0) source->will_read(random() % (2 * kSize), random() % (1 << 20));
                    expect_bytes(random() % 2 == 0 ? *again : *source, offset, count);
                }
            });
        }
        for (std::thread& thread : threads) thread.join();
    }
}

TEST_F(HttpTest, AnAnswerThatStallsIsAskedForAgain) {
    const auto source = opened("stalled/file");
    ASSERT_TRUE(source);
    expect_bytes(*source, 100'000, 50'000);
}

TEST_F(HttpTest, WhatIsBeyondTheEndIsTruncated) {
    const auto source = opened("plain/file");
    ASSERT_TRUE(source);
    Bytes two(2);
    EXPECT_EQ(source->read(kSize - 1, two).error().code, ErrorCode::kTruncated);
    EXPECT_EQ(source->read(~std::uint64_t{0}, two).error().code, ErrorCode::kTruncated);
    EXPECT_TRUE(source->read(kSize, {}));
    source->will_read(kSize, 1);
    source->will_read(~std::uint64_t{0}, ~std::uint64_t{0});
    expect_bytes(*source, kSize - 2, 2);
}

TEST_F(HttpTest, AFileThatBecomesShorterIsTruncatedAndOneThatGrowsIsReadUpToWhereItWas) {
    const auto source = opened("plain/file");
    ASSERT_TRUE(source);
    std::filesystem::resize_file(folder_ / "file", kSize + 100'000);
    expect_bytes(*source, kSize - 50'000, 50'000);
    std::filesystem::resize_file(folder_ / "file", 1'000'000);
    Bytes some(1000);
    EXPECT_EQ(source->read(2'000'000, some).error().code, ErrorCode::kTruncated);
    EXPECT_EQ(source->read(999'500, some).error().code, ErrorCode::kTruncated);
    expect_bytes(*source, 500'000, 1000);
}

TEST_F(HttpTest, AnEmptyFileIsEmpty) {
    const auto source = opened("plain/empty");
    ASSERT_TRUE(source);
    EXPECT_EQ(source->size(), 0u);
}

TEST_F(HttpTest, WhatTheServerRefusesIsAnErrorThatNamesTheUrl) {
    expect_error("plain/none", ErrorCode::kNotFound, "there is no such file on the server");
    expect_error("refused/file", ErrorCode::kIo, "refuses access (status 403)");
    expect_error("whole/file", ErrorCode::kIo, "must support range requests");
    expect_error("other/file", ErrorCode::kIo, "another range of bytes than the one requested");
    expect_error("broken/file", ErrorCode::kIo, "status 500 (tried 5 times)");
    server_->kill_now();
    expect_error("plain/file", ErrorCode::kIo, "tried 5 times");
    const auto nowhere = HttpSource::open("http://", std::make_shared<BlockCache>(patience_));
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().message.find("tried"), std::string::npos) << nowhere.error().message;
}

TEST_F(HttpTest, AServerThatGoesAwayIsAnErrorOfTheRead) {
    const auto source = opened("plain/file");
    ASSERT_TRUE(source);
    server_->kill_now();
    server_->wait();
    Bytes some(1000);
    EXPECT_EQ(source->read(2'000'000, some).error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace latent::sampledb
