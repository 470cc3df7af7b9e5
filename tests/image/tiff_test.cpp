#include <tiffio.h>

#include "image/tiff_writer.h"
#include "tests/image/decode.h"
#include "tests/image/test_image.h"

namespace latent::image {
namespace {

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
                    const std::vector<Decoded> images = decode_tiff(folder_ / name);
                    ASSERT_EQ(images.size(), 1u);
                    EXPECT_TRUE(images[0].pixels == rows);
                    EXPECT_EQ(images[0].format.sample, sample);
                    EXPECT_EQ(images[0].tiled, tiles);
                    EXPECT_EQ(images[0].big, big);
                    EXPECT_EQ(images[0].resolution_unit, RESUNIT_NONE);  // the standard requires the three, known or not
                    EXPECT_EQ(images[0].x_resolution, 1);
                    EXPECT_EQ(images[0].y_resolution, 1);
                    const std::string text = testing::read_text(folder_ / name);
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
        EXPECT_EQ(testing::read_text(folder_ / "a").substr(2, 1), big ? "\x2b" : "\x2a");
        std::filesystem::remove(folder_ / "a");
    }
}

TEST_F(TiffTest, APyramidIsPagesOfShrinkingSizeMarkedAsReduced) {
    const std::vector<PixelFormat> formats{{700, 520, SampleType::kU8}, {350, 260, SampleType::kU8}, {175, 130, SampleType::kU8}};
    ImageTags tags;
    tags.icc.resize(300, std::byte{5});
    tags.texts = {{"Software", "latent-convert 1"}, {"Sensitivity", "2"}};
    tags.pixels_per_inch = 600;
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
    EXPECT_EQ(folder_.names().size(), 1u);
    const std::vector<Decoded> images = decode_tiff(folder_ / "a.tif");
    ASSERT_EQ(images.size(), formats.size());
    for (std::size_t i = 0; i < formats.size(); ++i) {
        EXPECT_TRUE(images[i].pixels == test_rows(formats[i])) << i;
        EXPECT_EQ(images[i].reduced, i > 0);
        EXPECT_EQ(images[i].icc, tags.icc);
        EXPECT_FALSE(images[i].dated);
        EXPECT_EQ(images[i].resolution_unit, RESUNIT_INCH);
        EXPECT_EQ(images[i].x_resolution, 600 >> i) << "each is 7/6 inch wide";
        EXPECT_EQ(images[i].y_resolution, 600 >> i);
    }
    EXPECT_EQ(images[0].texts, (std::vector<std::pair<std::string, std::string>>{{"Software", "latent-convert 1"},
                                                                                 {"Description", "Sensitivity: 2"}}));
}

}  // namespace
}  // namespace latent::image
