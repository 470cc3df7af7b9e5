#include "image/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <half.h>

#include <new>

#include "image/exr_stream.h"

namespace latent::image {

namespace {

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
        if (tags.pixels_per_inch > 0) Imf::addXDensity(header, static_cast<float>(tags.pixels_per_inch));
        for (const auto& [key, value] : tags.texts) header.insert(key, Imf::StringAttribute(value));
        return stream_.guard([&] {
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
        return stream_.guard([&] {
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
        return stream_.guard([&] {
            // Short of memory, OpenEXR may leave lines out without a word.
            if (file_->currentScanLine() != window_.y1) throw std::bad_alloc();
            file_.reset();  // writes the table of offsets
            stream_.flush();
        });
    }
    Status publish() override { return out_.publish(); }

 private:
    OutputFile out_;
    Rect window_;
    bool as_half_;
    ExrStream stream_;
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
