#include "image/tiff_writer.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "base/in_order.h"
#include "image/deflate.h"
#include "image/row_blocks.h"

namespace latent::image {

namespace {

// Row by row, each sample becomes its difference from the pixel before; done from the right, in place.
template <class T>
void difference(std::byte* row, std::size_t samples, std::size_t channels) {
    T* values = reinterpret_cast<T*>(row);
    for (std::size_t i = samples; i-- > channels;) values[i] = static_cast<T>(values[i] - values[i - channels]);
}

// The bytes of a row of floats by significance, the most significant of all first, then differences of the pixel before [TIFF-TN3].
void difference_floats(std::byte* row, std::size_t samples, std::size_t channels, Bytes& planes) {
    planes.resize(4 * samples);
    for (std::size_t i = 0; i < samples; ++i) {
        for (std::size_t byte = 0; byte < 4; ++byte) {
            const std::size_t significance = std::endian::native == std::endian::little ? 3 - byte : byte;
            planes[significance * samples + i] = row[4 * i + byte];
        }
    }
    difference<std::uint8_t>(planes.data(), planes.size(), channels);
    std::memcpy(row, planes.data(), planes.size());
}

// One strip or tile, `width` pixels wide, its first pixel `x` pixels into the rows; missing pixels are filled with the last ones,
// which deflate well.
Bytes packed(std::span<const std::byte* const> rows, const PixelFormat& format, int x, int width, int height, int level) {
    const std::size_t pixel = format.pixel_bytes(), channels = static_cast<std::size_t>(format.channels),
                      row_bytes = static_cast<std::size_t>(width) * pixel;
    const int present = std::min(width, format.width - x);
    Bytes raw(row_bytes * static_cast<std::size_t>(height));
    Bytes planes;
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
        std::byte* row = raw.data() + y * row_bytes;
        std::memcpy(row, rows[std::min(y, rows.size() - 1)] + static_cast<std::size_t>(x) * pixel,
                    static_cast<std::size_t>(present) * pixel);
        for (int i = present; i < width; ++i)
            std::memcpy(row + static_cast<std::size_t>(i) * pixel, row + static_cast<std::size_t>(present - 1) * pixel, pixel);
        const std::size_t samples = channels * static_cast<std::size_t>(width);
        if (format.sample == SampleType::kU8) difference<std::uint8_t>(row, samples, channels);
        if (format.sample == SampleType::kU16) difference<std::uint16_t>(row, samples, channels);
        if (format.sample == SampleType::kF32) difference_floats(row, samples, channels, planes);
    }
    return zlib_stream(raw, level);
}

// What libtiff knows of our file.
struct Stream {
    File* file = nullptr;
    std::uint64_t at = 0, end = 0;
    std::string fault;  // libtiff's words
    Status status;      // ours, when the file failed; says more
};

tmsize_t stream_read(thandle_t handle, void* into, tmsize_t size) {
    Stream& s = *static_cast<Stream*>(handle);
    const Result<std::size_t> got = s.file->read_some(s.at, {static_cast<std::byte*>(into), static_cast<std::size_t>(size)});
    if (!got) {
        s.status = got.error();
        return -1;
    }
    s.at += *got;
    return static_cast<tmsize_t>(*got);
}
tmsize_t stream_write(thandle_t handle, void* from, tmsize_t size) {
    Stream& s = *static_cast<Stream*>(handle);
    if (Status status = s.file->write_all(s.at, {static_cast<const std::byte*>(from), static_cast<std::size_t>(size)}); !status) {
        if (s.status) s.status = status;
        return -1;
    }
    s.at += static_cast<std::uint64_t>(size);
    s.end = std::max(s.end, s.at);
    return size;
}
toff_t stream_seek(thandle_t handle, toff_t offset, int whence) {
    Stream& s = *static_cast<Stream*>(handle);
    s.at = whence == SEEK_SET ? offset : (whence == SEEK_CUR ? s.at : s.end) + offset;
    return s.at;
}
int stream_close(thandle_t) { return 0; }
toff_t stream_size(thandle_t handle) { return static_cast<Stream*>(handle)->end; }
int keep_fault(TIFF*, void* stream, const char*, const char* format, va_list arguments) {
    char text[256];
    std::vsnprintf(text, sizeof text, format, arguments);
    std::string& fault = static_cast<Stream*>(stream)->fault;
    if (fault.empty()) fault = text;
    return 1;
}

class DirectoryWriter final : public TiffWriter {
 public:
    DirectoryWriter(OutputFile out, const std::vector<PixelFormat>& formats, const ImageTags& tags, const TiffOptions& options)
        : out_(std::move(out)), formats_(formats), tags_(tags), options_(options), spooled_(formats.size(), 0) {}
    ~DirectoryWriter() override {
        if (tiff_ != nullptr) TIFFCleanup(tiff_);
    }

    Status start() {
        std::uint64_t raw = 0;
        for (const PixelFormat& format : formats_) raw += format.row_bytes() * static_cast<std::uint64_t>(format.height);
        // Deflate's worst case adds less than a thousandth; tables and padded tiles get 64 MiB.
        const bool big = options_.force_big || raw + raw / 1000 + (std::uint64_t{64} << 20) > (std::uint64_t{1} << 32);
        stream_.file = &out_.file();
        TIFFOpenOptions* setup = TIFFOpenOptionsAlloc();
        TIFFOpenOptionsSetErrorHandlerExtR(setup, keep_fault, &stream_);
        TIFFOpenOptionsSetWarningHandlerExtR(setup, keep_fault, &ignored_);
        tiff_ = TIFFClientOpenExt(out_.path().c_str(), big ? "w8" : "w", &stream_, stream_read, stream_write, stream_seek,
                                  stream_close, stream_size, nullptr, nullptr, setup);
        TIFFOpenOptionsFree(setup);
        if (tiff_ == nullptr) return failed();
        return begin_image(0);
    }

    Status write_rows(std::size_t index, ByteSpan rows) override {
        if (index == 0) return write_blocks(rows);
        if (!spool_.is_open()) {
            Result<File> spool = File::create_unnamed(folder_of(out_.path()));
            if (!spool) return spool.error().at(out_.path().string());
            spool_ = std::move(*spool);
        }
        if (Status s = spool_.write_all(spool_offset(index) + spooled_[index], rows); !s) return s;
        spooled_[index] += rows.size();
        return {};
    }

    Status finish() override {
        for (std::size_t i = 1; i < formats_.size(); ++i) {
            if (TIFFWriteDirectory(tiff_) == 0) return failed();
            if (Status s = begin_image(i); !s) return s;
            const std::size_t row_bytes = formats_[i].row_bytes();
            Bytes rows(row_bytes * static_cast<std::size_t>(kTiffTile));
            for (int y = 0; y < formats_[i].height; y += kTiffTile) {
                rows.resize(row_bytes * static_cast<std::size_t>(std::min(kTiffTile, formats_[i].height - y)));
                if (Status s = spool_.read_exact(spool_offset(i) + row_bytes * static_cast<std::uint64_t>(y), rows); !s) return s;
                if (Status s = write_blocks(rows); !s) return s;
            }
        }
        const int written = TIFFWriteDirectory(tiff_);
        TIFFCleanup(std::exchange(tiff_, nullptr));
        return written == 0 || !stream_.status ? failed() : Status{};
    }
    Status publish() override { return out_.publish(); }

 private:
    Error failed() const {
        if (!stream_.status) return stream_.status.error();
        return Error{ErrorCode::kIo,
                     fmt::format("{}: {}", out_.path().string(), stream_.fault.empty() ? "cannot write TIFF" : stream_.fault)};
    }

    // In the spool, the rows of each image stand together.
    std::uint64_t spool_offset(std::size_t index) const {
        std::uint64_t at = 0;
        for (std::size_t i = 1; i < index; ++i) at += formats_[i].row_bytes() * static_cast<std::uint64_t>(formats_[i].height);
        return at;
    }

    Status begin_image(std::size_t index) {
        format_ = formats_[index];
        const bool floats = format_.sample == SampleType::kF32;
        bool good = true;
        const auto set = [&](std::uint32_t tag, auto... values) { good = TIFFSetField(tiff_, tag, values...) == 1 && good; };
        if (index > 0) set(TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE);
        set(TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(format_.width));
        set(TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(format_.height));
        set(TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sample_bytes(format_.sample)));
        set(TIFFTAG_SAMPLEFORMAT, floats ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
        set(TIFFTAG_SAMPLESPERPIXEL, format_.channels);
        set(TIFFTAG_PHOTOMETRIC, format_.channels == 4   ? PHOTOMETRIC_SEPARATED
                                 : format_.channels == 1 ? PHOTOMETRIC_MINISBLACK
                                                         : PHOTOMETRIC_RGB);
        if (format_.channels == 4) set(TIFFTAG_INKSET, INKSET_CMYK);
        set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        set(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
        // Required [TIFF6, section 6]. All images of a pyramid have the same size on paper.
        const double inch = tags_.pixels_per_inch, width = formats_[0].width, height = formats_[0].height;
        set(TIFFTAG_RESOLUTIONUNIT, inch > 0 ? RESUNIT_INCH : RESUNIT_NONE);
        set(TIFFTAG_XRESOLUTION, inch > 0 ? inch * format_.width / width : 1.0);
        set(TIFFTAG_YRESOLUTION, inch > 0 ? inch * format_.height / height : 1.0);
        set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        set(TIFFTAG_PREDICTOR, floats ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
        if (options_.tiles) {
            block_height_ = kTiffTile;
            set(TIFFTAG_TILEWIDTH, static_cast<std::uint32_t>(kTiffTile));
            set(TIFFTAG_TILELENGTH, static_cast<std::uint32_t>(kTiffTile));
        } else {
            block_height_ = static_cast<int>(
                std::clamp<std::size_t>((std::size_t{1} << 20) / format_.row_bytes(), 1, static_cast<std::size_t>(format_.height)));
            set(TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(block_height_));
        }
        if (!tags_.icc.empty())
            set(TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(tags_.icc.size()), static_cast<const void*>(tags_.icc.data()));
        if (!tags_.texts.empty() && index == 0) {
            std::string description;
            for (const auto& [key, value] : tags_.texts) {
                if (key == "Software")
                    set(TIFFTAG_SOFTWARE, value.c_str());
                else
                    description += fmt::format("{}{}: {}", description.empty() ? "" : "\n", key, value);
            }
            set(TIFFTAG_IMAGEDESCRIPTION, description.c_str());
        }
        blocks_.emplace(format_.height, format_.row_bytes(), block_height_);
        return good ? Status{} : Status{failed()};
    }

    Status write_blocks(ByteSpan rows) {
        const std::vector<RowBlock> bands = blocks_->take(rows);
        const int width = options_.tiles ? kTiffTile : format_.width;
        const std::size_t across = static_cast<std::size_t>((format_.width + width - 1) / width);
        const Status status = make_in_order(
            bands.size() * across,
            [&](std::size_t i) -> Result<Bytes> {
                const RowBlock& band = bands[i / across];
                return packed(band.rows, format_, static_cast<int>(i % across) * width, width,
                              options_.tiles ? kTiffTile : band.count, options_.level);
            },
            [&](std::size_t i, Bytes bytes) -> Status {
                const auto index = static_cast<std::uint32_t>(
                    static_cast<std::size_t>(bands[i / across].first / block_height_) * across + i % across);
                const auto size = static_cast<tmsize_t>(bytes.size());
                const tmsize_t written = options_.tiles ? TIFFWriteRawTile(tiff_, index, bytes.data(), size)
                                                        : TIFFWriteRawStrip(tiff_, index, bytes.data(), size);
                return written == size && stream_.status ? Status{} : Status{failed()};
            });
        blocks_->settle();
        return status;
    }

    OutputFile out_;
    std::vector<PixelFormat> formats_;
    ImageTags tags_;
    TiffOptions options_;
    TIFF* tiff_ = nullptr;
    Stream stream_, ignored_;
    PixelFormat format_;  // the format of the image being written
    int block_height_ = 0;
    std::optional<RowBlocks> blocks_;
    File spool_;
    std::vector<std::uint64_t> spooled_;  // bytes so far, by image
};

}  // namespace

Result<std::unique_ptr<TiffWriter>> TiffWriter::create(OutputFile out, const std::vector<PixelFormat>& formats,
                                                       const ImageTags& tags, const TiffOptions& options) {
    auto writer = std::make_unique<DirectoryWriter>(std::move(out), formats, tags, options);
    if (Status s = writer->start(); !s) return s.error();
    return writer;
}

}  // namespace latent::image
