#include "base/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/hidden_name.h"
#include "tests/faults/process.h"

namespace latent {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
    testing::TemporaryFolder folder_;
    static ByteSpan bytes_of(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }
};

TEST_F(FileTest, AnOutputHasNoNameUntilItIsPublished) {
    {
        Result<OutputFile> out = OutputFile::create(folder_ / "a", false);
        ASSERT_TRUE(out);
        ASSERT_TRUE(out->file().write_all(0, bytes_of("half")));
        EXPECT_FALSE(fs::exists(folder_ / "a"));
    }
    EXPECT_EQ(folder_.names().size(), 0u);
    Result<OutputFile> out = OutputFile::create(folder_ / "a", false);
    ASSERT_TRUE(out->file().write_all(0, bytes_of("whole")));
    ASSERT_TRUE(out->publish());
    EXPECT_EQ(testing::read_text(folder_ / "a"), "whole");
    EXPECT_EQ(folder_.names().size(), 1u);
}

TEST_F(FileTest, AnExistingOutputIsRefusedBeforeAndAtPublishing) {
    Result<OutputFile> first = OutputFile::create(folder_ / "a", false);
    Result<OutputFile> second = OutputFile::create(folder_ / "a", false);
    ASSERT_TRUE(first && second);
    ASSERT_TRUE(first->file().write_all(0, bytes_of("first")));
    ASSERT_TRUE(first->publish());
    const Status late = second->publish();
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, ErrorCode::kExists);
    EXPECT_EQ(OutputFile::create(folder_ / "a", false).error().code, ErrorCode::kExists);
    EXPECT_EQ(testing::read_text(folder_ / "a"), "first");
}

TEST_F(FileTest, AReplacedOutputKeepsItsOldContentUntilThen) {
    std::ofstream(folder_ / "a") << "old";
    {
        Result<OutputFile> abandoned = OutputFile::create(folder_ / "a", true);
        ASSERT_TRUE(abandoned);
        EXPECT_EQ(folder_.names().size(), 1u);  // where the file system has files without a name, SIGKILL would leave nothing
    }
    EXPECT_EQ(testing::read_text(folder_ / "a"), "old");
    Result<OutputFile> out = OutputFile::create(folder_ / "a", true);
    ASSERT_TRUE(out->file().write_all(0, bytes_of("new")));
    ASSERT_TRUE(out->publish());
    EXPECT_EQ(testing::read_text(folder_ / "a"), "new");
    EXPECT_EQ(folder_.names().size(), 1u);
}

TEST_F(FileTest, WhatADeadOwnerLeftIsRemovedWhenTheSameOutputIsNextCreatedAndNothingElse) {
    const std::string nonce = "0123456789abcdef";
    std::vector<std::string> kept = {".a." + nonce + ".tmp.old", ".a." + nonce + "0.tmp", ".a.0123456789ABCDEF.tmp",
                                     ".ab." + nonce + ".tmp", "a." + nonce + ".tmp"};
    for (const std::string& name : kept) std::ofstream(folder_ / name) << "x";
    std::ofstream(folder_ / (".a." + nonce + ".tmp")) << "x";
    std::ofstream(folder_ / ".a.ffffffffffffffff.tmp") << "x";
    const int living = ::open((folder_ / ".a.ffffffffffffffff.tmp").c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_TRUE(lock_hidden(living));
    kept.push_back(".a.ffffffffffffffff.tmp");
    ASSERT_TRUE(OutputFile::create(folder_ / "a", false));
    std::ranges::sort(kept);
    EXPECT_EQ(folder_.names(), kept);
    ::close(living);
    ASSERT_TRUE(OutputFile::create(folder_ / "a", true));
    EXPECT_EQ(folder_.names().size(), kept.size() - 1);
}

TEST_F(FileTest, OnlyAFileIsEverReplaced) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(OutputFile::create(pipe, true).error().code, ErrorCode::kExists);
    EXPECT_EQ(OutputFile::create(folder_.path(), true).error().code, ErrorCode::kExists);
    EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(FileTest, CopyingARangeCopiesExactlyThatRange) {
    std::string text(3 << 20, ' ');
    for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 2654435761u >> 24);
    std::ofstream(folder_ / "a", std::ios::binary) << text;
    Result<File> source = File::open_read(folder_ / "a");
    Result<File> target = File::create_exclusive(folder_ / "b");
    ASSERT_TRUE(source && target);
    ASSERT_TRUE(target->copy_from(*source, 12345, 0, 2 << 20));
    EXPECT_EQ(testing::read_text(folder_ / "b"), text.substr(12345, 2 << 20));
    const Status beyond = target->copy_from(*source, 2 << 20, 0, 2 << 20);
    ASSERT_FALSE(beyond);
    EXPECT_EQ(beyond.error().code, ErrorCode::kTruncated);
}

TEST_F(FileTest, WhatIsNotARegularFileIsRefusedAtOnce) {
    const fs::path pipe = folder_ / "pipe", link = folder_ / "link";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);  // nobody writes to it: reading it would wait for ever
    fs::create_symlink(pipe, link);
    for (const fs::path& path : {pipe, link, fs::path("/dev/zero")}) {
        const Result<File> file = File::open_read(path);
        ASSERT_FALSE(file);
        EXPECT_EQ(file.error().code, ErrorCode::kForeign);
        EXPECT_EQ(file.error().message, path.string() + ": not a regular file");
    }
    fs::create_symlink("loop", folder_ / "loop");
    const Result<File> loop = File::open_read(folder_ / "loop");
    ASSERT_FALSE(loop);
    EXPECT_EQ(loop.error().code, ErrorCode::kForeign);
    EXPECT_TRUE(loop.error().message.ends_with("loop: a symbolic link that leads back to itself")) << loop.error().message;
}

TEST_F(FileTest, FoldersAndMissingFilesAreNamed) {
    EXPECT_EQ(File::open_read(folder_.path()).error().code, ErrorCode::kForeign);
    EXPECT_EQ(File::open_read("").error().message, "empty file name");
    const Result<File> missing = File::open_read(folder_ / "none");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
    EXPECT_NE(missing.error().message.find("none"), std::string::npos);
}

}  // namespace
}  // namespace latent
