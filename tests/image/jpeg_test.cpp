

#include "image/jpeg_writer.h"
#include "tests/image/decode.h"
#include "tests/image/test_image.h"

namespace latent::image {
namespace {

using JpegTest = FolderTest;

// Coarse enough that JPEG keeps it: blocks of 16 x 16 pixels of one colour.
Bytes blocks(const PixelFormat& format) {
    Bytes rows(format.row_bytes() * static_cast<std::size_t>(format.height));
    for (int y = 0; y < format.height; ++y) {
        for (int i = 0; i < 3 * format.width; ++i) {
            rows[static_cast<std::size_t>(y) * format.row_bytes() + static_cast<std::size_t>(i)] =
                std::byte(test_value(i / 48, y / 16, i % 3) >> 4 & 0xff);
        }
    }
    return rows;
}

TEST_F(JpegTest, PixelsComeBackNearlyAndTagsExactly) {
    const PixelFormat format{320, 160, SampleType::kU8};
    const Bytes rows = blocks(format);
    ImageTags tags;
    tags.icc.resize(70000, std::byte{7});  // more than one marker
    tags.texts = {{"Sensitivity", "2"}};
    for (const std::size_t piece : {std::size_t{1}, std::size_t{160}}) {
        const std::string name = std::to_string(piece);
        auto writer = create_jpeg(output(name), format, tags, {95});
        ASSERT_TRUE(writer);
        ASSERT_TRUE(write_all(**writer, rows, format.row_bytes(), piece));
        const Decoded d = decode_jpeg(folder_ / name);
        EXPECT_EQ(d.icc, tags.icc);
        ASSERT_EQ(d.texts.size(), 1u);
        EXPECT_EQ(d.texts[0].second, "Sensitivity: 2");
        EXPECT_EQ(d.luminance_sampling, 1);
        ASSERT_EQ(d.pixels.size(), rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) ASSERT_NEAR(static_cast<int>(d.pixels[i]), static_cast<int>(rows[i]), 6) << i;
    }
    EXPECT_TRUE(testing::read_text(folder_ / "1") == testing::read_text(folder_ / "160"));
    auto coarse = create_jpeg(output("coarse"), format, {}, {75});
    ASSERT_TRUE(write_all(**coarse, rows, format.row_bytes(), 160));
    EXPECT_EQ(decode_jpeg(folder_ / "coarse").luminance_sampling, 2);
}

TEST_F(JpegTest, AboveTheLimitTheErrorSaysWhatToUse) {
    const auto writer = create_jpeg(output("a.jpg"), {65501, 10, SampleType::kU8}, {}, {});
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().code, ErrorCode::kOutOfRange);
    for (const char* part : {"a.jpg", "65500", "65501 x 10", ".tif"})
        EXPECT_NE(writer.error().message.find(part), std::string::npos) << part;
    EXPECT_TRUE(create_jpeg(output("b.jpg"), {65500, 10, SampleType::kU8}, {}, {}));
    EXPECT_EQ(folder_.names().size(), 0u);
}

}  // namespace
}  // namespace latent::image
