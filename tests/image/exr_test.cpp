#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <tbb/parallel_for.h>

#include "image/exr_reader.h"
#include "image/exr_writer.h"
#include "tests/image/test_image.h"

namespace latent::image {
namespace {

const Rect kWindow{5, -3, 305, 197};  // 300 x 200
const Rect kDisplay{0, -10, 400, 300};

Imath::Box2i box(const Rect& r) { return {{r.x0, r.y0}, {r.x1 - 1, r.y1 - 1}}; }

float pixel(int x, int y, int c) { return static_cast<float>(Imath::half(test_float(x, y + 3, c))); }  // halves hold it too

struct Layout {
    std::string name;
    Imf::Compression compression = Imf::NO_COMPRESSION;
    int tile = 0;  // 0: scan lines
    Imf::PixelType type = Imf::FLOAT;
    std::array<const char*, 3> channels{"R", "G", "B"};
    Imf::LevelMode levels = Imf::ONE_LEVEL;
};

// A file by OpenEXR's C++ library, which shares no reading code with ours.
void write_exr(const std::filesystem::path& path, const Layout& layout) {
    Imf::Header header(box(kDisplay), box(kWindow));
    header.compression() = layout.compression;
    const bool as_half = layout.type == Imf::HALF;
    std::vector<float> floats[3];
    std::vector<Imath::half> halves[3];
    for (std::size_t c = 0; c < 3; ++c) {
        header.channels().insert(layout.channels[c], Imf::Channel(layout.type));
        for (int y = kWindow.y0; y < kWindow.y1; ++y) {
            for (int x = kWindow.x0; x < kWindow.x1; ++x) floats[c].push_back(pixel(x, y, static_cast<int>(c)));
        }
        halves[c].assign(floats[c].begin(), floats[c].end());
    }
    header.channels().insert("A", Imf::Channel(layout.type));  // a channel that nobody asked for
    const std::size_t sample = as_half ? 2 : 4, stride = static_cast<std::size_t>(kWindow.width()) * sample;
    const auto frame = [&](int x0, int y0) {
        Imf::FrameBuffer buffer;
        const auto slice = [&](std::size_t c) {
            char* base = as_half ? reinterpret_cast<char*>(halves[c].data()) : reinterpret_cast<char*>(floats[c].data());
            return Imf::Slice(layout.type,
                              base - x0 * static_cast<std::ptrdiff_t>(sample) - y0 * static_cast<std::ptrdiff_t>(stride), sample,
                              stride);
        };
        for (std::size_t c = 0; c < 3; ++c) buffer.insert(layout.channels[c], slice(c));
        buffer.insert("A", slice(1));
        return buffer;
    };
    if (layout.tile == 0) {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame(kWindow.x0, kWindow.y0));
        file.writePixels(kWindow.height());
        return;
    }
    const auto size = static_cast<unsigned>(layout.tile);
    header.setTileDescription({size, size, layout.levels, Imf::ROUND_DOWN});
    header.lineOrder() = Imf::RANDOM_Y;
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame(kWindow.x0, kWindow.y0));
    for (int level = 0; level < file.numLevels(); ++level) {    // smaller levels: the picture's upper left corner
        for (int y = file.numYTiles(level) - 1; y >= 0; --y) {  // not in reading order
            for (int x = 0; x < file.numXTiles(level); ++x) file.writeTile(x, y, level);
        }
    }
}

std::vector<Layout> layouts() {
    std::vector<Layout> all;
    for (const auto& [name, compression] : {std::pair{"none", Imf::NO_COMPRESSION},
                                            {"rle", Imf::RLE_COMPRESSION},
                                            {"zips", Imf::ZIPS_COMPRESSION},
                                            {"zip", Imf::ZIP_COMPRESSION},
                                            {"piz", Imf::PIZ_COMPRESSION}}) {
        for (const int tile : {0, 64, 256}) {
            for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
                all.push_back(
                    {std::string(name) + std::to_string(tile) + (type == Imf::HALF ? "h" : "f"), compression, tile, type});
            }
        }
    }
    return all;
}

void expect_area(const ExrReader& reader, const Rect& area, ExrReader::Scratch& scratch) {
    const std::size_t stride = static_cast<std::size_t>(area.width()) + 3;
    std::vector<float> planes[3];
    for (std::vector<float>& plane : planes) plane.assign(stride * static_cast<std::size_t>(area.height()), -7);
    const Status status = reader.read(area, {planes[0].data(), planes[1].data(), planes[2].data()}, stride, scratch);
    ASSERT_TRUE(status) << status.error().message;
    std::size_t wrong = 0;
    for (int y = area.y0; y < area.y1; ++y) {
        for (int x = area.x0; x < area.x0 + static_cast<int>(stride); ++x) {
            for (int c = 0; c < 3; ++c) {
                const float found =
                    planes[c][static_cast<std::size_t>(y - area.y0) * stride + static_cast<std::size_t>(x - area.x0)];
                wrong += found != (x < area.x1 ? pixel(x, y, c) : -7.0f);
            }
        }
    }
    EXPECT_EQ(wrong, 0u);
}

using ExrTest = FolderTest;

TEST_F(ExrTest, EveryRectangleOfEveryLayoutIsReadExactlyAndFromManyThreads) {
    for (const Layout& layout : layouts()) {
        SCOPED_TRACE(layout.name);
        write_exr(folder_ / layout.name, layout);
        const Result<ExrReader> reader = ExrReader::open(folder_ / layout.name);
        ASSERT_TRUE(reader) << reader.error().message;
        EXPECT_EQ(reader->image().data_window, kWindow);
        EXPECT_EQ(reader->image().display_window, kDisplay);
        EXPECT_FALSE(reader->image().xyz);
        const std::vector<Rect> areas{kWindow,           {5, -3, 6, -2},   {304, 196, 305, 197}, {69, 61, 133, 125},
                                      {70, 60, 300, 64}, {6, -2, 304, 196}};
        tbb::parallel_for(std::size_t{0}, areas.size(), [&](std::size_t i) {
            ExrReader::Scratch scratch;
            expect_area(*reader, areas[i], scratch);
            expect_area(*reader, areas[areas.size() - 1 - i], scratch);
        });
    }
}

TEST_F(ExrTest, LossyCompressionsAreReadAsOpenExrItselfReadsThem) {
    for (const Imf::Compression compression : {Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION}) {
        for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
            SCOPED_TRACE(::testing::Message() << "compression " << compression << ", pixel type " << type);
            const std::string path = (folder_ / (std::to_string(compression) + std::to_string(type))).string();
            write_exr(path, {"", compression, 0, type});
            std::vector<float> expected[3], found[3];
            Imf::FrameBuffer frame;
            const char* names[] = {"R", "G", "B"};
            for (std::size_t c = 0; c < 3; ++c) {
                expected[c].resize(kWindow.pixels());
                found[c].resize(kWindow.pixels());
                const std::ptrdiff_t origin = kWindow.x0 + kWindow.y0 * kWindow.width();
                frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(expected[c].data() - origin), 4,
                                                  4 * static_cast<std::size_t>(kWindow.width())));
            }
            Imf::InputFile file(path.c_str());
            file.setFrameBuffer(frame);
            file.readPixels(kWindow.y0, kWindow.y1 - 1);
            const Result<ExrReader> reader = ExrReader::open(path);
            ASSERT_TRUE(reader) << reader.error().message;
            ExrReader::Scratch scratch;
            const Status status = reader->read(kWindow, {found[0].data(), found[1].data(), found[2].data()},
                                               static_cast<std::size_t>(kWindow.width()), scratch);
            ASSERT_TRUE(status) << status.error().message;
            for (std::size_t c = 0; c < 3; ++c) {
                double worst = 0;
                for (std::size_t i = 0; i < expected[c].size(); ++i)
                    worst = std::max(worst, std::abs(static_cast<double>(expected[c][i]) - static_cast<double>(found[c][i])));
                EXPECT_EQ(worst, 0) << names[c];
            }
        }
    }
}

TEST_F(ExrTest, DwaIsRefusedWithAWayOut) {
    write_exr(folder_ / "dwa", {"", Imf::DWAA_COMPRESSION});
    const Result<ExrReader> reader = ExrReader::open(folder_ / "dwa");
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(reader.error().message.find("--compression zip"), std::string::npos) << reader.error().message;
}

TEST_F(ExrTest, MipLevelsAreRead) {
    Layout layout{"mip", Imf::ZIP_COMPRESSION, 64};
    layout.levels = Imf::MIPMAP_LEVELS;
    write_exr(folder_ / "mip", layout);
    const Result<ExrReader> reader = ExrReader::open(folder_ / "mip", {.level = 2});
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(reader->image().levels, 9);
    EXPECT_EQ(reader->image().data_window, (Rect{5, -3, 80, 47}));
    ExrReader::Scratch scratch;
    expect_area(*reader, reader->image().data_window, scratch);
    const Result<ExrReader> none = ExrReader::open(folder_ / "mip", {.level = 9});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::kUsage);
}

TEST_F(ExrTest, ChannelsAreFoundByTheirNames) {
    Layout layout{"xyz"};
    layout.channels = {"X", "Y", "Z"};
    write_exr(folder_ / "xyz", layout);
    const Result<ExrReader> reader = ExrReader::open(folder_ / "xyz");
    ASSERT_TRUE(reader);
    EXPECT_TRUE(reader->image().xyz);
    ExrReader::Scratch scratch;
    expect_area(*reader, kWindow, scratch);

    Layout foreign{"foreign"};
    foreign.channels = {"P", "Q", "S"};
    write_exr(folder_ / "foreign", foreign);
    const Result<ExrReader> refused = ExrReader::open(folder_ / "foreign");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(refused.error().message.find("A, P, Q, S"), std::string::npos) << refused.error().message;
}

TEST_F(ExrTest, GreyIsReadIntoAllThreePlanes) {
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION}) {
        const std::string path = (folder_ / ("grey" + std::to_string(compression))).string();
        Imf::Header header(20, 10);
        header.compression() = compression;
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        std::vector<float> values(200);
        for (std::size_t i = 0; i < 200; ++i) values[i] = static_cast<float>(i) * 0.25f;
        {
            Imf::FrameBuffer frame;
            frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 80));
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(frame);
            file.writePixels(10);
        }
        const Result<ExrReader> reader = ExrReader::open(path);
        ASSERT_TRUE(reader);
        std::vector<float> planes[3];
        for (std::vector<float>& plane : planes) plane.resize(200);
        ExrReader::Scratch scratch;
        ASSERT_TRUE(reader->read({0, 0, 20, 10}, {planes[0].data(), planes[1].data(), planes[2].data()}, 20, scratch));
        for (const std::vector<float>& plane : planes) EXPECT_EQ(plane, values);
    }
}

TEST_F(ExrTest, WhatIsNotAnExrOrEndsEarlyIsNamed) {
    const Result<ExrReader> missing = ExrReader::open(folder_ / "missing");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
    std::ofstream(folder_ / "text") << "This is a text of more than a few bytes, and no picture at all.";
    const Result<ExrReader> text = ExrReader::open(folder_ / "text");
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().code, ErrorCode::kForeign);
    for (const Layout& layout : {Layout{"none"}, Layout{"zip", Imf::ZIP_COMPRESSION}, Layout{"tiles", Imf::ZIP_COMPRESSION, 64}}) {
        SCOPED_TRACE(layout.name);
        write_exr(folder_ / layout.name, layout);
        std::filesystem::resize_file(folder_ / layout.name, std::filesystem::file_size(folder_ / layout.name) / 2);
        const Result<ExrReader> reader = ExrReader::open(folder_ / layout.name);
        if (!reader) continue;
        std::vector<float> plane(kWindow.pixels());
        ExrReader::Scratch scratch;
        const Status status =
            reader->read(kWindow, {plane.data(), plane.data(), plane.data()}, static_cast<std::size_t>(kWindow.width()), scratch);
        ASSERT_FALSE(status);
        EXPECT_NE(status.error().message.find(layout.name), std::string::npos) << status.error().message;
        std::filesystem::resize_file(folder_ / layout.name, 20);
        const Result<ExrReader> cut = ExrReader::open(folder_ / layout.name);
        ASSERT_FALSE(cut);
        EXPECT_EQ(cut.error().code, ErrorCode::kTruncated) << cut.error().message;
    }
}

TEST_F(ExrTest, AWrittenFileReadsBackExactlyWithItsWindowsAndAttributes) {
    const PixelFormat format{kWindow.width(), kWindow.height(), SampleType::kF32};
    const Bytes rows = test_rows(format);
    for (const bool as_half : {false, true}) {
        for (const std::size_t piece : {std::size_t{1}, std::size_t{37}, std::size_t{500}}) {
            const std::string name = std::to_string(piece) + (as_half ? "h" : "f");
            SCOPED_TRACE(name);
            ExrTags tags;
            tags.chromaticities = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
            tags.texts = {{"latent:sensitivity", "2"}};
            auto writer = create_exr(output(name), kWindow, kDisplay, as_half, tags, 2);
            ASSERT_TRUE(writer);
            const Status written = write_all(**writer, rows, format.row_bytes(), piece);
            ASSERT_TRUE(written) << written.error().message;
            EXPECT_TRUE(testing::read_text(folder_ / name) == testing::read_text(folder_ / (as_half ? "1h" : "1f")));
            Imf::InputFile file((folder_ / name).c_str());
            EXPECT_EQ(file.header().dataWindow(), box(kWindow));
            EXPECT_EQ(file.header().displayWindow(), box(kDisplay));
            EXPECT_EQ(Imf::chromaticities(file.header()).white.y, 0.329f);
            EXPECT_TRUE(file.header().find("latent:sensitivity") != file.header().end());
            EXPECT_TRUE(file.header().find("capDate") == file.header().end());
            std::vector<float> found(kWindow.pixels() * 3);
            Imf::FrameBuffer frame;
            const std::ptrdiff_t origin = (kWindow.x0 + kWindow.y0 * kWindow.width()) * 12;
            const char* names[] = {"R", "G", "B"};
            for (std::size_t c = 0; c < 3; ++c) {
                frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(found.data()) + c * 4 - origin, 12,
                                                  12 * static_cast<std::size_t>(kWindow.width())));
            }
            file.setFrameBuffer(frame);
            file.readPixels(kWindow.y0, kWindow.y1 - 1);
            const float* expected = reinterpret_cast<const float*>(rows.data());
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                wrong += found[i] != (as_half ? static_cast<float>(Imath::half(expected[i])) : expected[i]);
            }
            EXPECT_EQ(wrong, 0u);
        }
    }
}

}  // namespace
}  // namespace latent::image
