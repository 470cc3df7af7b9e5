#include "tests/image/decode.h"

#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>
#include <zlib.h>

#include <cstring>

#include "tests/faults/process.h"

// clang-format off: jpeglib.h needs what cstdio declares
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace latent::image {

namespace {

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

}  // namespace

// libpng reads; the list of chunks, their checksums and what it does not know are taken from the bytes.
Decoded decode_png(const std::filesystem::path& path) {
    Decoded d;
    const std::string bytes = testing::read_text(path);
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        const std::uint32_t size = big_endian(bytes, at);
        const std::string type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, size);
        const auto crc = static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(&bytes[at + 4]), 4 + data.size()));
        EXPECT_EQ(big_endian(bytes, at + 8 + size), crc) << path << " " << type;
        d.chunks.push_back(type);
        if (type == "cICP" && size == 4) std::memcpy(d.cicp.emplace().data(), data.data(), 4);
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
    if (png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY)
        d.format.channels = 1;
    else if (png_get_color_type(png, info) == PNG_COLOR_TYPE_RGB_ALPHA)
        png_set_strip_alpha(png);  // a browser's screenshot
    else
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
    png_uint_32 per_x = 0, per_y = 0;
    if (png_get_pHYs(png, info, &per_x, &per_y, &d.resolution_unit) != 0) d.x_resolution = per_x, d.y_resolution = per_y;
    png_textp texts;
    int count = 0;
    png_get_text(png, info, &texts, &count);
    for (int i = 0; i < count; ++i) d.texts.emplace_back(texts[i].key, texts[i].text);
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return d;
}

Decoded decode_jpeg(const std::filesystem::path& path) {
    const std::string bytes = testing::read_text(path);
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
        if (m->marker == JPEG_COM) d.texts.emplace_back("comment", std::string(reinterpret_cast<char*>(m->data), m->data_length));
    }
    d.x_resolution = jpeg.X_density;
    d.y_resolution = jpeg.Y_density;
    d.resolution_unit = jpeg.density_unit;
    d.luminance_sampling = jpeg.comp_info[0].h_samp_factor;
    jpeg_start_decompress(&jpeg);
    d.format = {static_cast<int>(jpeg.output_width), static_cast<int>(jpeg.output_height), SampleType::kU8, jpeg.output_components};
    d.pixels.resize(d.format.row_bytes() * static_cast<std::size_t>(d.format.height));
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = reinterpret_cast<JSAMPROW>(d.pixels.data() + jpeg.output_scanline * d.format.row_bytes());
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    if (d.format.channels == 4) {  // Adobe's marker: 255 is no ink
        EXPECT_TRUE(jpeg.saw_Adobe_marker);
        for (std::byte& sample : d.pixels) sample = ~sample;
    }
    jpeg_finish_decompress(&jpeg);
    jpeg_destroy_decompress(&jpeg);
    return d;
}

namespace {
// libtiff undoes predictor and compression; tiles are put together here.
Decoded decode_directory(TIFF* tiff) {
    Decoded d;
    std::uint32_t width = 0, height = 0, kind = 0, size = 0;
    std::uint16_t bits = 0;
    char* text = nullptr;
    void* icc = nullptr;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetField(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
    d.format = {static_cast<int>(width), static_cast<int>(height),
                bits == 8    ? SampleType::kU8
                : bits == 16 ? SampleType::kU16
                             : SampleType::kF32};
    std::uint16_t channels = 0, photometric = 0;
    TIFFGetField(tiff, TIFFTAG_SAMPLESPERPIXEL, &channels);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    d.format.channels = channels;
    EXPECT_EQ(photometric, channels == 4 ? PHOTOMETRIC_SEPARATED : channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    float x_resolution = 0, y_resolution = 0;
    std::uint16_t unit = 0;
    if (TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x_resolution) == 1) d.x_resolution = static_cast<double>(x_resolution);
    if (TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y_resolution) == 1) d.y_resolution = static_cast<double>(y_resolution);
    if (TIFFGetField(tiff, TIFFTAG_RESOLUTIONUNIT, &unit) == 1) d.resolution_unit = unit;
    d.tiled = TIFFIsTiled(tiff) != 0;
    d.big = TIFFIsBigTIFF(tiff) != 0;
    d.reduced = kind == FILETYPE_REDUCEDIMAGE;
    d.dated = TIFFGetField(tiff, TIFFTAG_DATETIME, &text) == 1 || TIFFGetField(tiff, TIFFTAG_HOSTCOMPUTER, &text) == 1;
    if (TIFFGetField(tiff, TIFFTAG_SOFTWARE, &text) == 1) d.texts.emplace_back("Software", text);
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text) == 1) d.texts.emplace_back("Description", text);
    if (TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &size, &icc) == 1) {
        d.icc.assign(static_cast<std::byte*>(icc), static_cast<std::byte*>(icc) + size);
    }
    const std::size_t row_bytes = d.format.row_bytes(), pixel = d.format.pixel_bytes();
    d.pixels.resize(row_bytes * height);
    if (!d.tiled) {
        for (std::uint32_t y = 0; y < height; ++y) EXPECT_EQ(TIFFReadScanline(tiff, d.pixels.data() + y * row_bytes, y), 1);
        return d;
    }
    constexpr std::uint32_t kTile = 256;
    Bytes tile(static_cast<std::size_t>(TIFFTileSize(tiff)));
    for (std::uint32_t y = 0; y < height; y += kTile) {
        for (std::uint32_t x = 0; x < width; x += kTile) {
            EXPECT_GT(TIFFReadTile(tiff, tile.data(), x, y, 0, 0), 0);
            for (std::uint32_t row = y; row < std::min(height, y + kTile); ++row) {
                std::memcpy(d.pixels.data() + row * row_bytes + x * pixel, tile.data() + (row - y) * kTile * pixel,
                            std::min<std::size_t>(kTile, width - x) * pixel);
            }
        }
    }
    return d;
}

}  // namespace

std::vector<Decoded> decode_tiff(const std::filesystem::path& path) {
    std::vector<Decoded> images;
    TIFF* tiff = TIFFOpen(path.c_str(), "r");
    if (tiff == nullptr) {
        ADD_FAILURE() << path << " is refused by libtiff";
        return images;
    }
    do images.push_back(decode_directory(tiff));
    while (TIFFReadDirectory(tiff) != 0);
    TIFFClose(tiff);
    return images;
}

}  // namespace latent::image
