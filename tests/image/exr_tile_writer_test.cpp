#include "image/exr_tile_writer.h"

#include <ImathBox.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfTiledInputFile.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "tests/faults/process.h"

namespace latent::image {
namespace {

using latent::testing::TemporaryFolder;

constexpr int kChannels = 3;

struct Picture {
    int width, height;
    std::vector<float> pixels;  // kChannels each
    float& at(int x, int y, int c) { return pixels[(std::size_t(y) * width + x) * kChannels + c]; }
};

Picture noise(int width, int height) {
    Picture picture{width, height, std::vector<float>(std::size_t(width) * height * kChannels)};
    std::mt19937 random(7);
    for (float& value : picture.pixels) value = std::ldexp(static_cast<float>(random()), -20);
    return picture;
}

// Writes the picture as the data window at (x0, y0), its tiles in a shuffled order.
void write(const std::filesystem::path& path, Picture& picture, ExrTileSpec spec, unsigned order) {
    spec.channels = {"R", "G", "B"};
    spec.x1 = spec.x0 + picture.width;
    spec.y1 = spec.y0 + picture.height;
    spec.display_width = spec.x1 + 3;
    spec.display_height = spec.y1 + 5;
    Result<OutputFile> out = OutputFile::create(path, false);
    ASSERT_TRUE(out) << out.error().message;
    auto writer = ExrTileWriter::create(out->file(), spec, 1 << 20);
    ASSERT_TRUE(writer) << writer.error().message;
    std::vector<int> tiles((*writer)->tiles_x() * (*writer)->tiles_y());
    for (std::size_t i = 0; i < tiles.size(); ++i) tiles[i] = static_cast<int>(i);
    std::shuffle(tiles.begin(), tiles.end(), std::mt19937(order));
    for (const int tile : tiles) {
        const int tx = tile % (*writer)->tiles_x(), ty = tile / (*writer)->tiles_x();
        const int w = std::min(256, picture.width - tx * 256), h = std::min(256, picture.height - ty * 256);
        std::vector<float> pixels;
        for (int y = 0; y < h; ++y) {
            const float* row = &picture.at(tx * 256, ty * 256 + y, 0);
            pixels.insert(pixels.end(), row, row + w * kChannels);
        }
        ASSERT_TRUE((*writer)->write(tx, ty, pixels));
    }
    ASSERT_TRUE((*writer)->finish());
    ASSERT_TRUE(out->publish());
}

Picture read_level(Imf::TiledInputFile& file, int level) {
    const Imath::Box2i window = file.dataWindowForLevel(level);
    Picture picture{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}};
    picture.pixels.resize(std::size_t(picture.width) * picture.height * kChannels);
    Imf::FrameBuffer frame;
    const std::size_t pixel = kChannels * sizeof(float), row = picture.width * pixel;
    const char* names[] = {"R", "G", "B"};
    for (int c = 0; c < kChannels; ++c) {
        char* base =
            reinterpret_cast<char*>(&picture.pixels[c]) - window.min.x * std::ptrdiff_t(pixel) - window.min.y * std::ptrdiff_t(row);
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, base, pixel, row));
    }
    file.setFrameBuffer(frame);
    file.readTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    return picture;
}

TEST(ExrTileWriter, GivesBackEveryPixelInItsPlaceWhateverTheOrderOfTiles) {
    const TemporaryFolder folder;
    for (const bool zip : {false, true}) {
        SCOPED_TRACE(zip);
        Picture picture = noise(700, 515);
        ExrTileSpec spec;
        spec.x0 = 1000, spec.y0 = 31, spec.zip = zip;
        const auto path = folder / (zip ? "zip.exr" : "none.exr");
        write(path, picture, spec, 1);
        Imf::TiledInputFile file(path.c_str());
        EXPECT_TRUE(file.isComplete());
        EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({1000, 31}, {1699, 545}));
        EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {1702, 550}));
        EXPECT_EQ(read_level(file, 0).pixels, picture.pixels);
    }
}

TEST(ExrTileWriter, TheSameCallsGiveTheSameBytes) {
    const TemporaryFolder folder;
    Picture picture = noise(600, 300);
    ExrTileSpec spec;
    spec.mipmap = true;
    write(folder / "a.exr", picture, spec, 5);
    write(folder / "b.exr", picture, spec, 5);
    EXPECT_EQ(latent::testing::read_text(folder / "a.exr"), latent::testing::read_text(folder / "b.exr"));
}

TEST(ExrTileWriter, MipMapPixelsAreTheMeanOfThePixelsTheyCover) {
    const TemporaryFolder folder;
    Picture picture = noise(1111, 387);
    ExrTileSpec spec;
    spec.mipmap = true;
    write(folder / "mip.exr", picture, spec, 2);
    Imf::TiledInputFile file((folder / "mip.exr").c_str());
    ASSERT_EQ(file.numLevels(), 12);
    for (int level = 0; level < file.numLevels(); ++level) {
        SCOPED_TRACE(level);
        Picture got = read_level(file, level);
        const int span = 1 << level;
        ASSERT_EQ(got.width, (picture.width + span - 1) / span);
        ASSERT_EQ(got.height, (picture.height + span - 1) / span);
        for (int y = 0; y < got.height; ++y) {
            for (int x = 0; x < got.width; ++x) {
                double sum = 0;
                int count = 0;
                for (int v = y * span; v < std::min(picture.height, (y + 1) * span); ++v) {
                    for (int u = x * span; u < std::min(picture.width, (x + 1) * span); ++u, ++count) sum += picture.at(u, v, 1);
                }
                // one rounding to float32 per level, of positive values
                ASSERT_NEAR(got.at(x, y, 1), sum / count, level * 0x1p-24 * sum / count) << x << ' ' << y;
            }
        }
    }
}

TEST(ExrTileWriter, AnErrorOfTheDiskNamesTheFile) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.exr") << "";
    Result<File> file = File::open_read(folder / "a.exr");  // opened for reading: every write fails
    ASSERT_TRUE(file);
    ExrTileSpec spec;
    spec.display_width = spec.display_height = spec.x1 = spec.y1 = 256;
    spec.channels = {"R", "G", "B"};
    Status status;
    if (auto writer = ExrTileWriter::create(*file, spec, 0); !writer) {
        status = writer.error();
    } else {
        status = (*writer)->write(0, 0, std::vector<float>(256 * 256 * 3));
        if (status) status = (*writer)->finish();
    }
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("a.exr: cannot write"), std::string::npos) << status.error().message;
}

}  // namespace
}  // namespace latent::image
