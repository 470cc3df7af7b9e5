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
        return HttpSource::open(server_url_ + path, std::make_shared<RangeCache>(patience_));
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
    for (const std::string way : {"plain", "rough", "moved", "open-ended"}) {
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

TEST_F(HttpTest, AFileThatGrowsIsReadUpToWhereItWasAndOneThatBecomesShorterIsAnError) {
    const auto source = opened("plain/file");
    ASSERT_TRUE(source);
    std::filesystem::resize_file(folder_ / "file", kSize + 100'000);
    expect_bytes(*source, kSize - 50'000, 50'000);
    std::filesystem::resize_file(folder_ / "file", 1'000'000);
    Bytes some(1000);
    for (const std::uint64_t offset : {500'000, 999'500, 2'000'000})
        EXPECT_NE(source->read(offset, some).error().message.find("has become shorter on the server"), std::string::npos) << offset;
}

TEST_F(HttpTest, AFileThatIsReplacedByOneOfItsSizeIsAnError) {
    const auto source = opened("changing/file");
    ASSERT_TRUE(source);
    Bytes some(1000);
    const Status status = source->read(2'000'000, some);
    ASSERT_FALSE(status);
    EXPECT_TRUE(status.error().message.ends_with("has changed on the server since it was opened")) << status.error().message;
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
    expect_error("crumbs/file", ErrorCode::kIo, "the server sent only 10 of the ");
    expect_error("broken/file", ErrorCode::kIo, "status 500 (tried 5 times)");
    expect_error("circle/file", ErrorCode::kIo, "Maximum (10) redirects followed");
    expect_error("local-file/file", ErrorCode::kIo, "Protocol \"file\" not supported");
    expect_error("gopher/file", ErrorCode::kIo, "Protocol \"gopher\" not supported");
    server_->kill_now();
    expect_error("plain/file", ErrorCode::kIo, "tried 5 times");
    const auto nowhere = HttpSource::open("http://", std::make_shared<RangeCache>(patience_));
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error().message.find("tried"), std::string::npos) << nowhere.error().message;
}

struct Lie {
    const char* way;
    const char* words;  // of the error
};

TEST_F(HttpTest, AServerThatLiesIsAnErrorThatSaysHow) {
    for (const Lie lie :
         {Lie{"impossible-size", "does not say which bytes it sends"}, Lie{"overflowing-size", "does not say which bytes it sends"},
          Lie{"negative-size", "does not say which bytes it sends"}, Lie{"unknown-size", "does not say which bytes it sends"},
          Lie{"no-range", "does not say which bytes it sends"}, Lie{"longer-range", "another range of bytes"},
          Lie{"more", "announced 16384 bytes and sends 21384"}, Lie{"fewer", "announced 16384 bytes and sent 100"},
          Lie{"none", "announced 16384 bytes and sent 0"}, Lie{"compressed", "sends compressed bytes"},
          Lie{"status-204", "answers with status 204"}, Lie{"status-304", "answers with status 304"},
          Lie{"status-999", "answers with status 999 (tried 5 times)"}, Lie{"no-such-range", "refuses a range that it has"},
          Lie{"garbage", "cannot be read"}})
        expect_error(std::string(lie.way) + "/file", ErrorCode::kIo, lie.words);
}

TEST_F(HttpTest, AnAnswerThatNeverEndsIsCutOff) {
    patience_.lag_seconds = 3;
    std::vector<std::thread> threads;
    for (const Lie lie : {Lie{"endless-page", "cannot be read at byte 0"}, Lie{"endless-extension", "cannot be read at byte 0"},
                          Lie{"endless-header", "a header without end"}, Lie{"endless-line", "a line of the answer is too long"},
                          Lie{"endless-continue", "a header without end"}, Lie{"endless-size", "cannot be read at byte 0"},
                          Lie{"drip", "too slow"}, Lie{"silent", "cannot be read at byte 0"}, Lie{"later", "status 503"}})
        threads.emplace_back([this, lie] { expect_error(std::string(lie.way) + "/file", ErrorCode::kIo, lie.words); });
    for (std::thread& thread : threads) thread.join();
    for (const std::string way : {"endless-404", "endless-redirection"})
        expect_error(way + "/file", ErrorCode::kNotFound, "there is no such file");
}

TEST_F(HttpTest, AnAnswerWithoutALengthEndsWithTheRangeThatItAnnounces) {
    const auto source = opened("endless-bytes/file");
    ASSERT_TRUE(source);
    Bytes some(100'000);
    EXPECT_TRUE(source->read(500'000, some));
}

TEST_F(HttpTest, AFileThatShrinksWithEveryAnswerIsAnError) {
    const auto source = opened("shrinking/file");
    ASSERT_TRUE(source);
    Bytes some(1000);
    EXPECT_EQ(source->read(2'000'000, some).error().code, ErrorCode::kIo);
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
