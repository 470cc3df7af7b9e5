#include "image/jpeg_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <csetjmp>

// clang-format off: jpeglib.h needs what cstdio declares
#include <jpeglib.h>

#include <cstdio>
// clang-format on

namespace latent::image {

namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 16;

// libjpeg compressing into `out`, which is emptied into a file, if there is one, whenever it has filled up. libjpeg reports a fault
// by calling error_exit, which must not return: it jumps back into `guarded`, across frames of C only.
class Compressor {
 public:
    Compressor(const PixelFormat& format, const ImageTags& tags, const JpegOptions& options)
        : format_(format), tags_(tags), options_(options) {
        jpeg_.err = jpeg_std_error(&errors_);
        errors_.error_exit = [](j_common_ptr jpeg) {
            Compressor& self = *static_cast<Compressor*>(jpeg->client_data);
            jpeg->err->format_message(jpeg, self.message_);
            std::longjmp(self.back_, 1);
        };
        errors_.output_message = [](j_common_ptr) {};
        jpeg_.client_data = this;
        destination_.init_destination = [](j_compress_ptr jpeg) { self_of(jpeg).new_buffer(); };
        destination_.empty_output_buffer = [](j_compress_ptr jpeg) -> boolean {
            Compressor& self = self_of(jpeg);
            self.drain(kBufferSize);
            self.new_buffer();
            return TRUE;
        };
        destination_.term_destination = [](j_compress_ptr jpeg) {
            Compressor& self = self_of(jpeg);
            self.drain(kBufferSize - self.destination_.free_in_buffer);
        };
    }
    ~Compressor() { jpeg_destroy_compress(&jpeg_); }
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;

    void write_to(File* file) { file_ = file; }

    Status start() {
        if (format_.sample != SampleType::kU8) return usage_error("JPEG holds 8 bits (--bits 8)");
        if (format_.width > JPEG_MAX_DIMENSION || format_.height > JPEG_MAX_DIMENSION) {
            return Error{ErrorCode::kOutOfRange,
                         fmt::format("a JPEG has at most {} pixels a side, and this picture has {} x {}; use .tif, .png or .dzi",
                                     JPEG_MAX_DIMENSION, format_.width, format_.height)};
        }
        return guarded([this] {
            jpeg_create_compress(&jpeg_);  // which keeps err and client_data alone
            jpeg_.dest = &destination_;
            jpeg_.image_width = static_cast<JDIMENSION>(format_.width);
            jpeg_.image_height = static_cast<JDIMENSION>(format_.height);
            jpeg_.input_components = format_.channels;
            jpeg_.in_color_space = format_.channels == 4 ? JCS_CMYK : format_.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
            jpeg_set_defaults(&jpeg_);  // for CMYK: no conversion, full size, and Adobe's marker
            jpeg_set_quality(&jpeg_, options_.quality, TRUE);
            if (options_.quality >= 90 && format_.channels == 3)
                jpeg_.comp_info[0].h_samp_factor = jpeg_.comp_info[0].v_samp_factor = 1;
            if (tags_.pixels_per_inch > 0) {
                jpeg_.density_unit = 1;  // inch
                jpeg_.X_density = jpeg_.Y_density = static_cast<UINT16>(std::min(tags_.pixels_per_inch, 0xffff));
            }
            jpeg_start_compress(&jpeg_, TRUE);
            for (const auto& [key, value] : tags_.texts) {
                const auto put = [this](char c) { jpeg_write_m_byte(&jpeg_, static_cast<unsigned char>(c)); };
                jpeg_write_m_header(&jpeg_, JPEG_COM, static_cast<unsigned>(key.size() + 2 + value.size()));
                for (const char c : key) put(c);
                put(':');
                put(' ');
                for (const char c : value) put(c);
            }
            if (!tags_.icc.empty()) {
                jpeg_write_icc_profile(&jpeg_, reinterpret_cast<const JOCTET*>(tags_.icc.data()),
                                       static_cast<unsigned>(tags_.icc.size()));
            }
        });
    }

    Status write(const std::byte* const* rows, std::size_t count) {
        if (format_.channels == 4) inverted_.resize(format_.row_bytes());
        return guarded([this, rows, count] {
            for (std::size_t y = 0; y < count; ++y) {
                JSAMPROW row = const_cast<JSAMPROW>(reinterpret_cast<const JSAMPLE*>(rows[y]));
                if (format_.channels == 4) row = inverted(row);
                jpeg_write_scanlines(&jpeg_, &row, 1);
            }
        });
    }

    Status finish() {
        return guarded([this] { jpeg_finish_compress(&jpeg_); });
    }
    Bytes take() { return std::move(done_); }

 private:
    static Compressor& self_of(j_compress_ptr jpeg) { return *static_cast<Compressor*>(jpeg->client_data); }

    // `call` holds nothing with a destructor, nor do libjpeg's callbacks at the moment of the jump.
    template <class Call>
    Status guarded(const Call& call) {
        if (setjmp(back_) != 0) return Error{ErrorCode::kIo, std::string("JPEG: ") + message_};
        call();
        return written_;
    }

    // Files with Adobe's marker hold 255 for no ink.
    JSAMPROW inverted(const JSAMPLE* row) {
        std::transform(row, row + inverted_.size(), inverted_.begin(), [](JSAMPLE v) { return static_cast<JSAMPLE>(255 - v); });
        return inverted_.data();
    }

    void new_buffer() {
        destination_.next_output_byte = buffer_;
        destination_.free_in_buffer = kBufferSize;
    }
    // After a failed write the rest is dropped; `guarded` tells.
    void drain(std::size_t size) {
        const ByteSpan bytes = std::as_bytes(std::span(buffer_, size));
        if (file_ == nullptr) {
            done_.insert(done_.end(), bytes.begin(), bytes.end());
        } else if (written_) {
            written_ = file_->write_all(at_, bytes);
            at_ += size;
        }
    }

    const PixelFormat format_;
    const ImageTags& tags_;
    const JpegOptions options_;
    jpeg_compress_struct jpeg_{};
    jpeg_error_mgr errors_{};
    jpeg_destination_mgr destination_{};
    std::jmp_buf back_{};
    char message_[JMSG_LENGTH_MAX] = {};
    JOCTET buffer_[kBufferSize];
    std::vector<JSAMPLE> inverted_;
    File* file_ = nullptr;
    std::uint64_t at_ = 0;
    Status written_;
    Bytes done_;
};

class JpegWriter final : public RowWriter {
 public:
    JpegWriter(OutputFile out, const PixelFormat& format, const ImageTags& tags, const JpegOptions& options)
        : out_(std::move(out)), tags_(tags), row_bytes_(format.row_bytes()), compressor_(format, tags_, options) {
        compressor_.write_to(&out_.file());
    }
    Status start() {
        if (Status s = compressor_.start(); !s) return s.error().at(out_.path().string());
        return {};
    }
    Status write_rows(ByteSpan rows) override {
        std::vector<const std::byte*> pointers;
        for (std::size_t at = 0; at < rows.size(); at += row_bytes_) pointers.push_back(rows.data() + at);
        return compressor_.write(pointers.data(), pointers.size());
    }
    Status finish() override { return compressor_.finish(); }
    Status publish() override { return out_.publish(); }

 private:
    OutputFile out_;
    ImageTags tags_;
    std::size_t row_bytes_;
    Compressor compressor_;
};

}  // namespace

Result<std::unique_ptr<RowWriter>> create_jpeg(OutputFile out, const PixelFormat& format, const ImageTags& tags,
                                               const JpegOptions& options) {
    auto writer = std::make_unique<JpegWriter>(std::move(out), format, tags, options);
    if (Status s = writer->start(); !s) return s.error();
    return writer;
}

Result<Bytes> encode_jpeg(std::span<const std::byte* const> rows, const PixelFormat& format, const ImageTags& tags,
                          const JpegOptions& options) {
    auto compressor = std::make_unique<Compressor>(format, tags, options);
    if (Status s = compressor->start(); !s) return s.error();
    if (Status s = compressor->write(rows.data(), rows.size()); !s) return s.error();
    if (Status s = compressor->finish(); !s) return s.error();
    return compressor->take();
}

}  // namespace latent::image
