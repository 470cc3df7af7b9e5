#include <tiffio.h>

#include "image/tiff_writer.h"
#include "test_image.h"

namespace latent::image {
namespace {

// libtiff undoes predictor and compression; tiles are put together here.
Bytes decode(TIFF* tiff, PixelFormat& format) {
    std::uint32_t width = 0, height = 0;
    std::uint16_t bits = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    format = {static_cast<int>(width), static_cast<int>(height),
              bits == 8    ? SampleType::kU8
              : bits == 16 ? SampleType::kU16
                           : SampleType::kF32};
    const std::size_t row_bytes = format.row_bytes(), pixel = 3 * sample_bytes(format.sample);
    Bytes out(row_bytes * height);
    if (TIFFIsTiled(tiff) == 0) {
        for (std::uint32_t y = 0; y < height; ++y) EXPECT_EQ(TIFFReadScanline(tiff, out.data() + y * row_bytes, y), 1);
        return out;
    }
    Bytes tile(static_cast<std::size_t>(TIFFTileSize(tiff)));
    for (std::uint32_t y = 0; y < height; y += kTiffTile) {
        for (std::uint32_t x = 0; x < width; x += kTiffTile) {
            EXPECT_GT(TIFFReadTile(tiff, tile.data(), x, y, 0, 0), 0);
            for (std::uint32_t row = y; row < std::min(height, y + kTiffTile); ++row) {
                std::memcpy(out.data() + row * row_bytes + x * pixel, tile.data() + (row - y) * kTiffTile * pixel,
                            std::min<std::size_t>(kTiffTile, width - x) * pixel);
            }
        }
    }
    return out;
}

Status write_one(TiffWriter& writer, const Bytes& rows, std::size_t row_bytes, std::size_t piece) {
    if (Status s = feed(rows, row_bytes, piece, [&](ByteSpan some) { return writer.write_rows(0, some); }); !s) return s;
    if (Status s = writer.finish(); !s) return s;
    return writer.publish();
}

using TiffTest = FolderTest;

TEST_F(TiffTest, PixelsComeBackExactlyInStripsAndTilesOfEveryDepth) {
    for (const SampleType sample : {SampleType::kU8, SampleType::kU16, SampleType::kF32}) {
        for (const bool tiles : {false, true}) {
            for (const bool big : {false, true}) {
                const PixelFormat format{601, 700, sample};
                const Bytes rows = test_rows(format);
                std::string first;
                for (const std::size_t piece : {std::size_t{1}, std::size_t{300}, std::size_t{700}}) {
                    const std::string name =
                        std::to_string(sample_bytes(sample)) + (tiles ? "t" : "s") + (big ? "b" : "c") + std::to_string(piece);
                    SCOPED_TRACE(name);
                    auto writer = TiffWriter::create(output(name), {format}, {}, {tiles, 1, big});
                    ASSERT_TRUE(writer);
                    ASSERT_TRUE(write_one(**writer, rows, format.row_bytes(), piece));
                    TIFF* tiff = TIFFOpen((folder_ / name).c_str(), "r");
                    ASSERT_NE(tiff, nullptr);
                    PixelFormat found;
                    EXPECT_TRUE(decode(tiff, found) == rows);
                    EXPECT_EQ(found.sample, sample);
                    EXPECT_EQ(TIFFIsTiled(tiff) != 0, tiles);
                    EXPECT_EQ(TIFFIsBigTIFF(tiff) != 0, big);
                    TIFFClose(tiff);
                    const std::string text = file_text(folder_ / name);
                    if (first.empty()) first = text;
                    EXPECT_TRUE(text == first);
                }
            }
        }
    }
}

TEST_F(TiffTest, BigTiffIsChosenWhenFourGibibytesMayNotDo) {
    for (const auto& [height, big] : {std::pair{30000, false}, {40000, true}}) {  // x 40000 x 3 bytes: 3.4 and 4.5 GiB
        auto writer = TiffWriter::create(output("a"), {{40000, height, SampleType::kU8}}, {}, {});
        ASSERT_TRUE(writer);
        ASSERT_TRUE((*writer)->finish() && (*writer)->publish());
        EXPECT_EQ(file_text(folder_ / "a").substr(2, 1), big ? "\x2b" : "\x2a");
        std::filesystem::remove(folder_ / "a");
    }
}

TEST_F(TiffTest, APyramidIsPagesOfShrinkingSizeMarkedAsReduced) {
    const std::vector<PixelFormat> formats{{700, 520, SampleType::kU8}, {350, 260, SampleType::kU8}, {175, 130, SampleType::kU8}};
    ImageTags tags;
    tags.icc.resize(300, std::byte{5});
    tags.texts = {{"Software", "latent-convert 1"}, {"Sensitivity", "2"}};
    auto writer = TiffWriter::create(output("a.tif"), formats, tags, {true});
    ASSERT_TRUE(writer);
    for (int part = 0; part < 2; ++part) {  // interleaved: half of the rows of each, then the rest
        for (std::size_t i = 0; i < formats.size(); ++i) {
            const Bytes rows = test_rows(formats[i]);
            ASSERT_TRUE((*writer)->write_rows(i, ByteSpan(rows).subspan(part == 0 ? 0 : rows.size() / 2, rows.size() / 2)));
        }
    }
    ASSERT_TRUE((*writer)->finish());
    ASSERT_TRUE((*writer)->publish());
    EXPECT_EQ(names_in_folder(), 1u);
    TIFF* tiff = TIFFOpen((folder_ / "a.tif").c_str(), "r");
    ASSERT_NE(tiff, nullptr);
    for (std::size_t i = 0; i < formats.size(); ++i) {
        ASSERT_EQ(TIFFSetDirectory(tiff, static_cast<std::uint16_t>(i)), 1);
        PixelFormat found;
        EXPECT_TRUE(decode(tiff, found) == test_rows(formats[i])) << i;
        std::uint32_t kind = 0;
        TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
        EXPECT_EQ(kind, i == 0 ? 0u : static_cast<std::uint32_t>(FILETYPE_REDUCEDIMAGE));
        std::uint32_t size = 0;
        void* icc = nullptr;
        EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &size, &icc), 1);
        EXPECT_EQ(size, 300u);
    }
    EXPECT_EQ(TIFFSetDirectory(tiff, 3), 0);
    TIFFSetDirectory(tiff, 0);
    char *software = nullptr, *description = nullptr, *date = nullptr;
    EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_SOFTWARE, &software), 1);
    EXPECT_STREQ(software, "latent-convert 1");
    EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description), 1);
    EXPECT_STREQ(description, "Sensitivity: 2");
    EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_DATETIME, &date), 0);
    TIFFClose(tiff);
}

}  // namespace
}  // namespace latent::image
