#include "image/png_writer.h"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>

#include "base/in_order.h"
#include "image/deflate.h"
#include "image/png_filter.h"
#include "image/row_blocks.h"

namespace latent::image {

namespace {

void append(png_structp png, png_bytep data, png_size_t size) {
    Bytes& out = *static_cast<Bytes*>(png_get_io_ptr(png));
    const std::byte* first = reinterpret_cast<const std::byte*>(data);
    out.insert(out.end(), first, first + size);
}
void nothing_to_flush(png_structp) {}
void refuse(png_structp png, png_const_charp message) {
    *static_cast<std::string*>(png_get_error_ptr(png)) = message;
    png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

// Everything between setjmp and longjmp lives in the caller: nothing here needs a destructor.
bool describe(png_structp png, png_infop info, const PixelFormat& format, const ImageTags& tags, png_text* texts, int text_count) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
    png_set_IHDR(png, info, static_cast<png_uint_32>(format.width), static_cast<png_uint_32>(format.height),
                 static_cast<int>(8 * sample_bytes(format.sample)), format.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (tags.srgb) {
        png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_RELATIVE);
    } else if (!tags.icc.empty()) {
        png_set_iCCP(png, info, "ICC", PNG_COMPRESSION_TYPE_BASE, reinterpret_cast<png_const_bytep>(tags.icc.data()),
                     static_cast<png_uint_32>(tags.icc.size()));
    }
    if (tags.cicp && !tags.srgb) {  // libpng 1.6.39 has no call for it
        png_unknown_chunk cicp{{'c', 'I', 'C', 'P'}, const_cast<png_bytep>(tags.cicp->data()), tags.cicp->size(), PNG_HAVE_IHDR};
        png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_ALWAYS, cicp.name, 1);
        png_set_unknown_chunks(png, info, &cicp, 1);
    }
    if (tags.pixels_per_inch > 0) {
        const auto per_metre = static_cast<png_uint_32>(std::lround(tags.pixels_per_inch / 0.0254));
        png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
    }
    png_set_text(png, info, texts, text_count);
    png_write_info(png, info);
    return true;
}

void append_chunk(Bytes& out, const char* type, ByteSpan data) {
    const auto put = [&](std::uint32_t value) {
        for (int shift = 24; shift >= 0; shift -= 8) out.push_back(std::byte(value >> shift & 0xff));
    };
    put(static_cast<std::uint32_t>(data.size()));
    const std::size_t start = out.size();
    for (int i = 0; i < 4; ++i) out.push_back(std::byte(type[i]));
    out.insert(out.end(), data.begin(), data.end());
    put(static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(out.data() + start), out.size() - start)));
}

// The signature and all chunks before the pixels.
Result<Bytes> head(const PixelFormat& format, const ImageTags& tags) {
    if (format.sample == SampleType::kF32) return usage_error("PNG has 8 or 16 bits, not floats");
    Bytes out;
    std::string fault;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &fault, refuse, ignore_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
        png_destroy_write_struct(&png, nullptr);
        return Error{ErrorCode::kNoMemory, "out of memory"};
    }
    png_set_write_fn(png, &out, append, nothing_to_flush);
    std::vector<png_text> texts;
    for (const auto& [key, value] : tags.texts) {
        png_text text{};
        text.compression = PNG_TEXT_COMPRESSION_NONE;
        text.key = const_cast<png_charp>(key.c_str());
        text.text = const_cast<png_charp>(value.c_str());
        texts.push_back(text);
    }
    const bool good = describe(png, info, format, tags, texts.data(), static_cast<int>(texts.size()));
    png_destroy_write_struct(&png, &info);
    if (!good) {
        // libpng says so in text alone: "too many text chunks", too, is an array that could not grow.
        const bool no_memory = fault.find("memory") != std::string::npos || fault.find("too many") != std::string::npos;
        return Error{no_memory ? ErrorCode::kNoMemory : ErrorCode::kUsage, "PNG: " + fault};
    }
    return out;
}

// Filters rows (with the row above the first, or null) and joins them. PNG's 16 bits are big-endian.
Bytes filtered(std::span<const std::byte* const> rows, const std::byte* above, const PixelFormat& format) {
    const std::size_t row_bytes = format.row_bytes(), pixel_bytes = format.pixel_bytes();
    Bytes out(rows.size() * (row_bytes + 1));
    const bool swap = format.sample == SampleType::kU16 && std::endian::native == std::endian::little;
    Bytes swapped[2];
    const auto big_endian = [&](const std::byte* row, Bytes& buffer) {
        if (row == nullptr) return ByteSpan{};
        if (!swap) return ByteSpan{row, row_bytes};
        buffer.resize(row_bytes);
        for (std::size_t i = 0; i < row_bytes; i += 2) {
            buffer[i] = row[i + 1];
            buffer[i + 1] = row[i];
        }
        return ByteSpan{buffer};
    };
    ByteSpan previous = big_endian(above, swapped[1]);
    for (std::size_t y = 0; y < rows.size(); ++y) {
        const ByteSpan row = big_endian(rows[y], swapped[y % 2]);
        filter_row(row, previous, pixel_bytes, out.data() + y * (row_bytes + 1));
        previous = row;
    }
    return out;
}

class PngWriter final : public RowWriter {
 public:
    PngWriter(OutputFile out, const PixelFormat& format, const PngOptions& options)
        : out_(std::move(out)),
          format_(format),
          options_(options),
          strips_(format.height, format.row_bytes(), rows_per_strip(format), 1) {}

    Status start(const ImageTags& tags) {
        Result<Bytes> first = head(format_, tags);
        if (!first) return first.error().at(out_.path().string());
        return write(*first);
    }

    Status write_rows(ByteSpan rows) override {
        const std::vector<RowBlock> strips = strips_.take(rows);
        const Status status = make_in_order(
            strips.size(),
            [&](std::size_t i) -> Result<DeflatePiece> {
                const RowBlock& strip = strips[i];
                const std::span<const std::byte* const> own = std::span(strip.rows).subspan(static_cast<std::size_t>(strip.above));
                const Bytes raw = filtered(own, strip.above > 0 ? strip.rows[0] : nullptr, format_);
                return deflate_piece(raw, options_.level, strip.first + strip.count == format_.height);
            },
            [&](std::size_t i, const DeflatePiece& piece) { return write_piece(strips[i], piece); });
        strips_.settle();
        return status;
    }

    Status finish() override {
        Bytes end;
        append_chunk(end, "IEND", {});
        return write(end);
    }
    Status publish() override { return out_.publish(); }

 private:
    static int rows_per_strip(const PixelFormat& format) {
        return static_cast<int>(std::max<std::size_t>(1, (std::size_t{1} << 20) / format.row_bytes()));
    }

    Status write_piece(const RowBlock& strip, const DeflatePiece& piece) {
        Bytes data;
        if (strip.first == 0) data = zlib_header();
        data.insert(data.end(), piece.bytes.begin(), piece.bytes.end());
        adler_ = strip.first == 0 ? piece.adler : joined_adler(adler_, piece);
        if (strip.first + strip.count == format_.height) {
            const Bytes trailer = zlib_trailer(adler_);
            data.insert(data.end(), trailer.begin(), trailer.end());
        }
        Bytes chunk;
        append_chunk(chunk, "IDAT", data);
        return write(chunk);
    }

    Status write(ByteSpan bytes) {
        if (Status s = out_.file().write_all(at_, bytes); !s) return s;
        at_ += bytes.size();
        return {};
    }

    OutputFile out_;
    PixelFormat format_;
    PngOptions options_;
    RowBlocks strips_;
    std::uint64_t at_ = 0;
    std::uint32_t adler_ = 1;
};

}  // namespace

Result<std::unique_ptr<RowWriter>> create_png(OutputFile out, const PixelFormat& format, const ImageTags& tags,
                                              const PngOptions& options) {
    auto writer = std::make_unique<PngWriter>(std::move(out), format, options);
    if (Status s = writer->start(tags); !s) return s.error();
    return writer;
}

Result<Bytes> encode_png(std::span<const std::byte* const> rows, const PixelFormat& format, const ImageTags& tags,
                         const PngOptions& options) {
    Result<Bytes> out = head(format, tags);
    if (!out) return out.error();
    append_chunk(*out, "IDAT", zlib_stream(filtered(rows, nullptr, format), options.level));
    append_chunk(*out, "IEND", {});
    return out;
}

}  // namespace latent::image
