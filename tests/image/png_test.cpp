#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "image/png_writer.h"
#include "tests/image/decode.h"
#include "tests/image/test_image.h"

namespace latent::image {
namespace {

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
                const Decoded d = decode_png(folder_ / name);
                EXPECT_TRUE(d.pixels == rows) << name;
                if (first.empty()) first = testing::read_text(folder_ / name);
                EXPECT_TRUE(testing::read_text(folder_ / name) == first) << name;
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
    EXPECT_TRUE(testing::read_text(folder_ / "1") == testing::read_text(folder_ / "4"));
}

TEST_F(PngTest, ColourIsTaggedAsAsked) {
    const PixelFormat format{4, 4, SampleType::kU8};
    ImageTags srgb;
    srgb.srgb = true;
    srgb.texts = {{"Software", "latent-convert"}, {"Sensitivity", "1.5"}};
    auto a = create_png(output("a.png"), format, srgb, {});
    ASSERT_TRUE(write_all(**a, test_rows(format), format.row_bytes(), 4));
    const Decoded plain = decode_png(folder_ / "a.png");
    EXPECT_TRUE(plain.srgb);
    EXPECT_TRUE(plain.icc.empty());
    EXPECT_EQ(plain.texts, srgb.texts);
    std::vector<std::string> chunks = plain.chunks;
    std::sort(chunks.begin() + 1, chunks.begin() + 4);  // releases of libpng order these differently
    EXPECT_EQ(chunks, (std::vector<std::string>{"IHDR", "cHRM", "gAMA", "sRGB", "tEXt", "tEXt", "IDAT", "IEND"}));

    ImageTags wide = srgb;
    wide.srgb = false;
    wide.cicp = {12, 13, 0, 1};
    auto b = create_png(output("b.png"), format, wide, {});
    ASSERT_TRUE(write_all(**b, test_rows(format), format.row_bytes(), 4));
    const Decoded coded = decode_png(folder_ / "b.png");
    EXPECT_EQ(coded.cicp, wide.cicp);
    EXPECT_EQ(coded.chunks, (std::vector<std::string>{"IHDR", "cICP", "tEXt", "tEXt", "IDAT", "IEND"}));
    EXPECT_TRUE(coded.pixels == test_rows(format));
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
    EXPECT_TRUE(decode_png(folder_ / "a.png").pixels == rows);
}

TEST_F(PngTest, FloatsAreRefused) {
    EXPECT_EQ(create_png(output("a.png"), {4, 4, SampleType::kF32}, {}, {}).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace latent::image
