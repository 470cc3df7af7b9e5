

#include "image/jpeg_writer.h"
#include "test_image.h"

// clang-format off: jpeglib.h needs what cstdio declares
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace latent::image {
namespace {

struct Decoded {
    PixelFormat format;
    Bytes pixels;
    Bytes icc;
    std::vector<std::string> comments;
    int luminance_sampling = 0;
};

Decoded decode(const std::string& bytes) {
    Decoded d;
    jpeg_decompress_struct jpeg;
    jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);  // ends the process on a damaged file
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_save_markers(&jpeg, JPEG_APP0 + 2, 0xffff);
    jpeg_save_markers(&jpeg, JPEG_COM, 0xffff);
    jpeg_read_header(&jpeg, TRUE);
    JOCTET* icc = nullptr;
    unsigned size = 0;
    if (jpeg_read_icc_profile(&jpeg, &icc, &size))
        d.icc.assign(reinterpret_cast<std::byte*>(icc), reinterpret_cast<std::byte*>(icc) + size);
    std::free(icc);
    for (jpeg_saved_marker_ptr m = jpeg.marker_list; m != nullptr; m = m->next) {
        if (m->marker == JPEG_COM) d.comments.emplace_back(reinterpret_cast<char*>(m->data), m->data_length);
    }
    d.luminance_sampling = jpeg.comp_info[0].h_samp_factor;
    jpeg_start_decompress(&jpeg);
    d.format = {static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height), SampleType::kU8};
    d.pixels.resize(d.format.row_bytes() * static_cast<std::size_t>(d.format.height));
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = reinterpret_cast<JSAMPROW>(d.pixels.data() + jpeg.output_scanline * d.format.row_bytes());
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
    jpeg_destroy_decompress(&jpeg);
    return d;
}

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
        const Decoded d = decode(file_text(folder_ / name));
        EXPECT_EQ(d.icc, tags.icc);
        EXPECT_EQ(d.comments, std::vector<std::string>{"Sensitivity: 2"});
        EXPECT_EQ(d.luminance_sampling, 1);
        ASSERT_EQ(d.pixels.size(), rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) ASSERT_NEAR(static_cast<int>(d.pixels[i]), static_cast<int>(rows[i]), 6) << i;
    }
    EXPECT_TRUE(file_text(folder_ / "1") == file_text(folder_ / "160"));
    auto coarse = create_jpeg(output("coarse"), format, {}, {75});
    ASSERT_TRUE(write_all(**coarse, rows, format.row_bytes(), 160));
    EXPECT_EQ(decode(file_text(folder_ / "coarse")).luminance_sampling, 2);
}

TEST_F(JpegTest, AboveTheLimitTheErrorSaysWhatToUse) {
    const auto writer = create_jpeg(output("a.jpg"), {65501, 10, SampleType::kU8}, {}, {});
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().code, ErrorCode::kOutOfRange);
    for (const char* part : {"a.jpg", "65500", "65501 x 10", ".tif"})
        EXPECT_NE(writer.error().message.find(part), std::string::npos) << part;
    EXPECT_TRUE(create_jpeg(output("b.jpg"), {65500, 10, SampleType::kU8}, {}, {}));
    EXPECT_EQ(names_in_folder(), 0u);
}

}  // namespace
}  // namespace latent::image
