#include "image/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <half.h>

#include <cstring>

namespace latent::image {

namespace {

// Carries our own error through OpenEXR.
struct WriteFailed : std::exception {
    explicit WriteFailed(Error e) : error(std::move(e)) {}
    const char* what() const noexcept override { return error.message.c_str(); }
    Error error;
};

// OpenEXR's stream on our file. It seeks back once, to fill in the table of offsets. Small writes are gathered.
class Stream final : public Imf::OStream {
 public:
    explicit Stream(File& file) : OStream(file.path().c_str()), file_(file) { pending_.reserve(kGather); }
    void write(const char* bytes, int size) override {
        const std::byte* first = reinterpret_cast<const std::byte*>(bytes);
        if (pending_.size() + static_cast<std::size_t>(size) > kGather) flush();
        pending_.insert(pending_.end(), first, first + size);
    }
    std::uint64_t tellp() override { return at_ + pending_.size(); }
    void seekp(std::uint64_t position) override {
        flush();
        at_ = position;
    }
    void flush() {
        if (status_) status_ = file_.write_all(at_, pending_);
        at_ += pending_.size();
        pending_.clear();
        if (!status_) throw WriteFailed(status_.error());
    }

 private:
    static constexpr std::size_t kGather = std::size_t{1} << 20;
    File& file_;
    std::uint64_t at_ = 0;
    Bytes pending_;
    Status status_;  // the first fault stays: OpenEXR's destructor swallows what it is thrown
};

Imath::Box2i box_of(const Rect& r) { return {{r.x0, r.y0}, {r.x1 - 1, r.y1 - 1}}; }

class ExrWriter final : public RowWriter {
 public:
    ExrWriter(OutputFile out, const Rect& data_window, bool as_half)
        : out_(std::move(out)), window_(data_window), as_half_(as_half), stream_(out_.file()) {}

    Status start(const Rect& display_window, const ExrTags& tags, int threads) {
        Imf::Header header(box_of(display_window), box_of(window_));
        header.compression() = Imf::ZIP_COMPRESSION;
        for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(as_half_ ? Imf::HALF : Imf::FLOAT));
        if (tags.chromaticities) {
            const auto& c = *tags.chromaticities;
            Imf::addChromaticities(header, Imf::Chromaticities({c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}));
        }
        for (const auto& [key, value] : tags.texts) header.insert(key, Imf::StringAttribute(value));
        return guarded([&] {
            if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
            file_ = std::make_unique<Imf::OutputFile>(stream_, header, threads);
        });
    }

    Status write_rows(ByteSpan rows) override {
        const std::size_t row_samples = 3 * static_cast<std::size_t>(window_.width());
        const int count = static_cast<int>(rows.size() / (row_samples * sizeof(float)));
        const char* first = reinterpret_cast<const char*>(rows.data());
        std::size_t sample = sizeof(float);
        if (as_half_) {
            const float* values = reinterpret_cast<const float*>(rows.data());
            halves_.assign(values, values + row_samples * static_cast<std::size_t>(count));
            first = reinterpret_cast<const char*>(halves_.data());
            sample = sizeof(Imath::half);
        }
        return guarded([&] {
            // A slice's base is where pixel (0, 0) of the display window would be.
            const std::ptrdiff_t origin = (static_cast<std::ptrdiff_t>(window_.x0) * 3 +
                                           static_cast<std::ptrdiff_t>(next_) * static_cast<std::ptrdiff_t>(row_samples)) *
                                          static_cast<std::ptrdiff_t>(sample);
            Imf::FrameBuffer frame;
            const char* names[] = {"R", "G", "B"};
            for (std::size_t c = 0; c < 3; ++c) {
                frame.insert(names[c], Imf::Slice(as_half_ ? Imf::HALF : Imf::FLOAT, const_cast<char*>(first) + c * sample - origin,
                                                  3 * sample, row_samples * sample));
            }
            file_->setFrameBuffer(frame);
            file_->writePixels(count);
            next_ += count;
        });
    }

    Status finish() override {
        return guarded([&] {
            file_.reset();  // writes the table of offsets
            stream_.flush();
        });
    }
    Status publish() override { return out_.publish(); }

 private:
    template <class Call>
    Status guarded(const Call& call) {
        try {
            call();
            return {};
        } catch (const WriteFailed& failed) {
            return failed.error;
        } catch (const std::exception& failed) {
            return Error{ErrorCode::kIo, fmt::format("{}: {}", out_.path().string(), failed.what())};
        }
    }

    OutputFile out_;
    Rect window_;
    bool as_half_;
    Stream stream_;
    std::unique_ptr<Imf::OutputFile> file_;
    std::vector<Imath::half> halves_;
    int next_ = window_.y0;
};

}  // namespace

Result<std::unique_ptr<RowWriter>> create_exr(OutputFile out, const Rect& data_window, const Rect& display_window, bool as_half,
                                              const ExrTags& tags, int threads) {
    auto writer = std::make_unique<ExrWriter>(std::move(out), data_window, as_half);
    if (Status s = writer->start(display_window, tags, threads); !s) return s.error();
    return writer;
}

}  // namespace latent::image
