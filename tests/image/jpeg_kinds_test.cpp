// The kinds of JPEG that cameras, scanners and printers write, as pictures of scenes: each has the colours that it was made of.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "image/pictures.h"
#include "tests/image/test_image.h"

// clang-format off: jpeglib.h needs what cstdio declares
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace latent::image {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 96, kHeight = 64, kBlock = 32;  // two rows of three blocks, whole ones of 4:1:1

// Of a block, as R, G, B, 0 to 255.
std::array<int, 3> color_of(int x, int y) {
    constexpr std::array<std::array<int, 3>, 6> kColors{
        {{200, 40, 60}, {30, 180, 90}, {50, 70, 220}, {255, 255, 255}, {128, 128, 128}, {240, 200, 20}}};
    return kColors[static_cast<std::size_t>(y / kBlock) * 3 + static_cast<std::size_t>(x / kBlock)];
}

struct Kind {
    J_COLOR_SPACE given = JCS_RGB, stored = JCS_YCbCr;
    int channels = 3;
    bool progressive = false;
    int across = 1, down = 1;  // pixels of luminance for one of chrominance
    std::string metadata{};    // of an APP1 segment
};

std::string jpeg_of(const Kind& kind) {
    jpeg_compress_struct jpeg;
    jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &data, &size);
    jpeg.image_width = kWidth;
    jpeg.image_height = kHeight;
    jpeg.input_components = kind.channels;
    jpeg.in_color_space = kind.given;
    jpeg_set_defaults(&jpeg);
    jpeg_set_colorspace(&jpeg, kind.stored);
    jpeg_set_quality(&jpeg, 98, TRUE);
    jpeg.comp_info[0].h_samp_factor = kind.across;
    jpeg.comp_info[0].v_samp_factor = kind.down;
    if (kind.stored == JCS_YCCK) jpeg.comp_info[3].h_samp_factor = kind.across, jpeg.comp_info[3].v_samp_factor = kind.down;
    if (kind.progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    if (!kind.metadata.empty())
        jpeg_write_marker(&jpeg, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(kind.metadata.data()),
                          static_cast<unsigned>(kind.metadata.size()));
    for (int y = 0; y < kHeight; ++y) {
        std::vector<unsigned char> row;
        for (int x = 0; x < kWidth; ++x) {
            const auto rgb = color_of(x, y);
            if (kind.channels == 1) row.push_back(static_cast<unsigned char>(rgb[0]));
            // Adobe's programs write ink inverted, as the share of light that it leaves: R = C K. Here, K leaves all or 4/5.
            const bool is_inked = kind.channels == 4 && std::ranges::max(rgb) <= 204;
            for (std::size_t c = 0; c < 3 && kind.channels > 1; ++c)
                row.push_back(static_cast<unsigned char>(is_inked ? std::lround(rgb[c] * 1.25) : rgb[c]));
            if (kind.channels == 4) row.push_back(is_inked ? 204 : 255);
        }
        JSAMPROW rows = row.data();
        jpeg_write_scanlines(&jpeg, &rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    std::string bytes(reinterpret_cast<const char*>(data), size);
    jpeg_destroy_compress(&jpeg);
    std::free(data);
    return bytes;
}

class JpegKinds : public FolderTest {
 protected:
    void SetUp() override { pictures_ = std::move(*Pictures::create(1 << 20)); }
    Result<WholePicture> read(const std::string& bytes) const {
        const std::filesystem::path path = folder_ / "a.jpg";
        std::ofstream(path, std::ios::binary) << bytes;
        return pictures_->read(path, "a.jpg", {.is_srgb = false});
    }
    void expect_colors(const std::string& what, const std::string& bytes, bool is_grey = false) const {
        SCOPED_TRACE(what);
        const Result<WholePicture> picture = read(bytes);
        ASSERT_TRUE(picture) << picture.error().message;
        ASSERT_EQ(picture->info.width, std::uint32_t{kWidth});
        ASSERT_EQ(picture->info.height, std::uint32_t{kHeight});
        const std::size_t channels = picture->info.channels;
        ASSERT_EQ(channels, is_grey ? 1u : 3u);
        for (int y = kBlock / 2; y < kHeight; y += kBlock) {
            for (int x = kBlock / 2; x < kWidth; x += kBlock) {
                const float* const seen =
                    &picture->values[channels * (static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x))];
                for (std::size_t c = 0; c < channels; ++c)
                    EXPECT_NEAR(static_cast<double>(seen[c]), color_of(x, y)[c] / 255.0, 3 / 255.0) << x << " " << y << " " << c;
            }
        }
    }
    std::unique_ptr<Pictures> pictures_;
};

TEST_F(JpegKinds, EachHasTheColoursThatItWasMadeOf) {
    expect_colors("baseline", jpeg_of({}));
    expect_colors("progressive", jpeg_of({.progressive = true}));
    expect_colors("RGB as it is", jpeg_of({.stored = JCS_RGB}));
    expect_colors("4:2:0", jpeg_of({.across = 2, .down = 2}));
    expect_colors("4:2:2", jpeg_of({.across = 2}));
    expect_colors("4:1:1", jpeg_of({.across = 4}));
    expect_colors("4:1:1, progressive", jpeg_of({.progressive = true, .across = 4}));
    expect_colors("grey", jpeg_of({.given = JCS_GRAYSCALE, .stored = JCS_GRAYSCALE, .channels = 1}), true);
    expect_colors("CMYK", jpeg_of({.given = JCS_CMYK, .stored = JCS_CMYK, .channels = 4}));
    expect_colors("YCCK", jpeg_of({.given = JCS_CMYK, .stored = JCS_YCCK, .channels = 4}));
    expect_colors("YCCK, 4:2:0, progressive",
                  jpeg_of({.given = JCS_CMYK, .stored = JCS_YCCK, .channels = 4, .progressive = true, .across = 2, .down = 2}));
}

// As by other readers of models: texture coordinates are those of the pixels as they are stored.
TEST_F(JpegKinds, AnOrientationIsIgnored) {
    std::string exif("Exif\0\0MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0", 25);
    exif += std::string("\6\0\0\0\0\0\0", 7);  // to be turned by 90 degrees
    expect_colors("turned", jpeg_of({.metadata = exif}));
}

TEST_F(JpegKinds, TruncatedAndDeeperOnesAreRefused) {
    for (const bool progressive : {false, true}) {
        const std::string whole = jpeg_of({.progressive = progressive});
        for (std::size_t size = whole.size() / 8; size < whole.size(); size += whole.size() / 8) {
            const Result<WholePicture> picture = read(whole.substr(0, size));
            ASSERT_FALSE(picture) << size;
            EXPECT_THAT(picture.error().message, HasSubstr("a.jpg: cannot be read as a picture: the file is cut off"));
        }
    }
    ::testing::internal::CaptureStderr();
    for (const char bits : {'\x0C', '\x10'}) {
        std::string deep = jpeg_of({});
        const std::size_t frame = deep.find("\xFF\xC0");
        ASSERT_NE(frame, std::string::npos);
        deep[frame + 4] = bits;
        const Result<WholePicture> picture = read(deep);
        ASSERT_FALSE(picture);
        EXPECT_THAT(picture.error().message,
                    HasSubstr(fmt::format("a.jpg: cannot be read as a picture: its samples have {} bits; convert it", int{bits})));
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace latent::image
