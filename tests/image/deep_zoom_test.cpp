#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "image/deep_zoom_writer.h"
#include "tests/image/test_image.h"

namespace latent::image {
namespace {

namespace fs = std::filesystem;
using DeepZoomTest = FolderTest;

Result<std::unique_ptr<DeepZoomWriter>> create(const fs::path& path, int width, int height, const DeepZoomOptions& options) {
    return DeepZoomWriter::create(path, width, height, {}, "<html>page</html>", options);
}

Status write_levels(DeepZoomWriter& writer, int width, int height, std::size_t piece) {
    const std::vector<PixelFormat> levels = deep_zoom_levels(width, height);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (Status s =
                feed(test_rows(levels[i]), levels[i].row_bytes(), piece, [&](ByteSpan rows) { return writer.write_rows(i, rows); });
            !s)
            return s;
    }
    return writer.finish();
}

TEST_F(DeepZoomTest, LevelsHalveRoundingUpUntilOnePixelIsLeft) {
    const std::vector<PixelFormat> levels = deep_zoom_levels(5, 3);
    ASSERT_EQ(levels.size(), 4u);
    EXPECT_EQ(levels[1].width, 3);
    EXPECT_EQ(levels[1].height, 2);
    EXPECT_EQ(levels[3].width, 1);
    EXPECT_EQ(levels[3].height, 1);
    EXPECT_EQ(deep_zoom_levels(1, 1).size(), 1u);
}

// The tiles that a viewer asks for by the rule of [DZI]: level, column, row; each the part of its level with `overlap` around it.
TEST_F(DeepZoomTest, EveryTileIsItsPartOfItsLevelWithTheOverlap) {
    const int width = 600, height = 300;
    for (const int overlap : {0, 1}) {
        DeepZoomOptions options;
        options.png = true;
        options.overlap = overlap;
        const std::string name = "a" + std::to_string(overlap);
        auto writer = create(folder_ / (name + ".dzi"), width, height, options);
        ASSERT_TRUE(writer);
        ASSERT_TRUE(write_levels(**writer, width, height, 100));
        EXPECT_FALSE(fs::exists(folder_ / (name + "_files")));
        ASSERT_TRUE((*writer)->publish());
        const std::string descriptor = testing::read_text(folder_ / (name + ".dzi"));
        EXPECT_NE(descriptor.find("Format=\"png\" Overlap=\"" + std::to_string(overlap) + "\" TileSize=\"256\""),
                  std::string::npos);
        EXPECT_NE(descriptor.find("Width=\"600\" Height=\"300\""), std::string::npos);
        const std::vector<PixelFormat> levels = deep_zoom_levels(width, height);
        std::size_t tiles = 0;
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const Bytes rows = test_rows(levels[i]);
            for (int y = 0; y * 256 < levels[i].height; ++y) {
                for (int x = 0; x * 256 < levels[i].width; ++x) {
                    ++tiles;
                    const int x0 = std::max(0, x * 256 - overlap), x1 = std::min(levels[i].width, x * 256 + 256 + overlap);
                    const int y0 = std::max(0, y * 256 - overlap), y1 = std::min(levels[i].height, y * 256 + 256 + overlap);
                    std::vector<const std::byte*> pointers;
                    for (int row = y0; row < y1; ++row)
                        pointers.push_back(rows.data() + static_cast<std::size_t>(row) * levels[i].row_bytes() +
                                           static_cast<std::size_t>(3 * x0));
                    const Result<Bytes> expected = encode_png(pointers, {x1 - x0, y1 - y0, SampleType::kU8}, {}, {});
                    const fs::path tile = folder_ / (name + "_files") / std::to_string(levels.size() - 1 - i) /
                                          (std::to_string(x) + "_" + std::to_string(y) + ".png");
                    ASSERT_TRUE(fs::exists(tile)) << tile;
                    const std::string found = testing::read_text(tile);
                    EXPECT_TRUE(std::as_bytes(std::span(found)).size() == expected->size() &&
                                std::memcmp(found.data(), expected->data(), found.size()) == 0)
                        << tile;
                }
            }
        }
        std::size_t files = 0;
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / (name + "_files")))
            files += entry.is_regular_file();
        EXPECT_EQ(files, tiles);
    }
}

TEST_F(DeepZoomTest, NothingIsLeftOfAnAbandonedPyramid) {
    {
        auto writer = create(folder_ / "a.dzi", 600, 300, {});
        ASSERT_TRUE(writer);
        ASSERT_TRUE(write_levels(**writer, 600, 300, 300));
    }
    EXPECT_EQ(folder_.names().size(), 0u);
}

TEST_F(DeepZoomTest, WhatAKilledWriterLeftIsRemovedByTheNextButNotWhatALivingOneHas) {
    const pid_t child = ::fork();
    if (child == 0) {
        const auto writer = create(folder_ / "a.dzi", 600, 300, {});
        ::raise(SIGKILL);
    }
    ASSERT_GT(child, 0);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    ASSERT_EQ(folder_.names().size(), 1u);                                    // its hidden folder
    fs::create_directory(folder_ / ".a_files.b_files.0123456789abcdef.tmp");  // of another pyramid, a_files.b.dzi
    auto living = create(folder_ / "a.dzi", 600, 300, {});
    ASSERT_TRUE(living);
    EXPECT_EQ(folder_.names().size(), 2u);
    {
        const auto another = create(folder_ / "a.dzi", 600, 300, {});
        ASSERT_TRUE(another);
        EXPECT_EQ(folder_.names().size(), 3u);
    }
    ASSERT_TRUE(write_levels(**living, 600, 300, 300));
    ASSERT_TRUE((*living)->publish());
    EXPECT_EQ(folder_.names().size(), 4u);  // .dzi, .html, _files, and the other's
}

TEST_F(DeepZoomTest, WhatExistsIsRefusedAndReplacedOnlyByForce) {
    const auto make = [&](bool replace) -> Status {
        DeepZoomOptions options;
        options.replace = replace;
        auto writer = create(folder_ / "a.dzi", 300, 300, options);
        if (!writer) return writer.error();
        if (Status s = write_levels(**writer, 300, 300, 300); !s) return s;
        return (*writer)->publish();
    };
    ASSERT_TRUE(make(false));
    EXPECT_EQ(folder_.names().size(), 3u);
    for (const char* name : {"a.dzi", "a.html", "a_files"}) {
        const Status again = make(false);
        ASSERT_FALSE(again);
        EXPECT_EQ(again.error().code, ErrorCode::kExists);
        fs::remove_all(folder_ / name);
    }
    EXPECT_EQ(folder_.names().size(), 0u);
    ASSERT_TRUE(make(false));
    std::ofstream(folder_ / "a_files" / "old") << "left over";
    ASSERT_TRUE(make(true));
    EXPECT_FALSE(fs::exists(folder_ / "a_files" / "old"));
    EXPECT_EQ(folder_.names().size(), 3u);
}

}  // namespace
}  // namespace latent::image
