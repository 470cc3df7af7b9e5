#include <png.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "image/png_filter.h"
#include "image/png_writer.h"
#include "test_image.h"

namespace latent::image {
namespace {

struct Decoded {
    PixelFormat format;
    Bytes pixels;  // host byte order
    bool srgb = false;
    Bytes icc;
    std::vector<std::pair<std::string, std::string>> texts;
    std::vector<std::string> chunks;  // types in order
};

// libpng reads; the list of chunks is taken from the bytes.
Decoded decode(const std::filesystem::path& path) {
    Decoded d;
    const std::string bytes = file_text(path);
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        std::uint32_t size = 0;
        for (std::size_t i = 0; i < 4; ++i) size = size << 8 | static_cast<unsigned char>(bytes[at + i]);
        d.chunks.push_back(bytes.substr(at + 4, 4));
        at += 12 + size;
    }
    std::FILE* file = std::fopen(path.c_str(), "rb");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    if (setjmp(png_jmpbuf(png)) != 0) {
        ADD_FAILURE() << path << " is refused by libpng";
        return d;
    }
    png_init_io(png, file);
    png_read_info(png, info);
    d.format = {static_cast<int>(png_get_image_width(png, info)), static_cast<int>(png_get_image_height(png, info)),
                png_get_bit_depth(png, info) == 16 ? SampleType::kU16 : SampleType::kU8};
    EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB);
    if (d.format.sample == SampleType::kU16) png_set_swap(png);
    d.pixels.resize(d.format.row_bytes() * static_cast<std::size_t>(d.format.height));
    std::vector<png_bytep> rows;
    for (std::size_t at = 0; at < d.pixels.size(); at += d.format.row_bytes())
        rows.push_back(reinterpret_cast<png_bytep>(d.pixels.data() + at));
    png_read_image(png, rows.data());
    png_read_end(png, info);
    int intent = -1;
    d.srgb = png_get_sRGB(png, info, &intent) != 0;
    png_charp name;
    int compression;
    png_bytep profile;
    png_uint_32 size;
    if (png_get_iCCP(png, info, &name, &compression, &profile, &size) != 0) {
        d.icc.assign(reinterpret_cast<std::byte*>(profile), reinterpret_cast<std::byte*>(profile) + size);
    }
    png_textp texts;
    int count = 0;
    png_get_text(png, info, &texts, &count);
    for (int i = 0; i < count; ++i) d.texts.emplace_back(texts[i].key, texts[i].text);
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return d;
}

using PngTest = FolderTest;

TEST_F(PngTest, PixelsComeBackExactlyHoweverTheRowsArrive) {
    for (const SampleType sample : {SampleType::kU8, SampleType::kU16}) {
        for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {301, 2500}}) {
            const PixelFormat format{width, height, sample};
            const Bytes rows = test_rows(format);
            std::string first;
            for (const std::size_t piece : {std::size_t{1}, std::size_t{64}, std::size_t{5000}}) {
                const std::string name =
                    "a" + std::to_string(piece) + std::to_string(width) + std::to_string(sample_bytes(sample)) + ".png";
                auto writer = create_png(output(name), format, {}, {});
                ASSERT_TRUE(writer);
                ASSERT_TRUE(write_all(**writer, rows, format.row_bytes(), piece));
                const Decoded d = decode(folder_ / name);
                EXPECT_TRUE(d.pixels == rows) << name;
                if (first.empty()) first = file_text(folder_ / name);
                EXPECT_TRUE(file_text(folder_ / name) == first) << name;
            }
        }
    }
}

TEST_F(PngTest, TheBytesDoNotDependOnTheThreads) {
    const PixelFormat format{900, 3000, SampleType::kU8};
    const Bytes rows = test_rows(format);
    for (const int threads : {1, 4}) {
        const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 4);
        tbb::task_arena arena(threads);
        arena.execute([&] {
            auto writer = create_png(output(std::to_string(threads)), format, {}, {});
            EXPECT_TRUE(write_all(**writer, rows, format.row_bytes(), 700));
        });
    }
    EXPECT_TRUE(file_text(folder_ / "1") == file_text(folder_ / "4"));
}

TEST_F(PngTest, ColourIsTaggedAsAsked) {
    const PixelFormat format{4, 4, SampleType::kU8};
    ImageTags srgb;
    srgb.srgb = true;
    srgb.texts = {{"Software", "latent-convert"}, {"Sensitivity", "1.5"}};
    auto a = create_png(output("a.png"), format, srgb, {});
    ASSERT_TRUE(write_all(**a, test_rows(format), format.row_bytes(), 4));
    const Decoded plain = decode(folder_ / "a.png");
    EXPECT_TRUE(plain.srgb);
    EXPECT_TRUE(plain.icc.empty());
    EXPECT_EQ(plain.texts, srgb.texts);
    EXPECT_EQ(plain.chunks, (std::vector<std::string>{"IHDR", "gAMA", "sRGB", "cHRM", "tEXt", "tEXt", "IDAT", "IEND"}));

    ImageTags wide;
    wide.cicp = {12, 13, 0, 1};
    auto b = create_png(output("b.png"), format, wide, {});
    ASSERT_TRUE(write_all(**b, test_rows(format), format.row_bytes(), 4));
    EXPECT_NE(file_text(folder_ / "b.png").find(std::string("cICP\x0c\x0d\x00\x01", 8)), std::string::npos);
    EXPECT_TRUE(decode(folder_ / "b.png").pixels == test_rows(format));
}

TEST_F(PngTest, ASmallImageInMemoryIsTheSamePicture) {
    const PixelFormat format{33, 21, SampleType::kU8};
    const Bytes rows = test_rows(format);
    std::vector<const std::byte*> pointers;
    for (std::size_t at = 0; at < rows.size(); at += format.row_bytes()) pointers.push_back(rows.data() + at);
    const Result<Bytes> png = encode_png(pointers, format, {}, {});
    ASSERT_TRUE(png);
    std::ofstream(folder_ / "a.png", std::ios::binary)
        .write(reinterpret_cast<const char*>(png->data()), static_cast<std::streamsize>(png->size()));
    EXPECT_TRUE(decode(folder_ / "a.png").pixels == rows);
}

TEST_F(PngTest, FloatsAreRefused) {
    EXPECT_EQ(create_png(output("a.png"), {4, 4, SampleType::kF32}, {}, {}).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace latent::image
