// image/exr_stream.h: OpenEXR's output stream on our own file, and its faults as ours.
#pragma once

#include <ImfIO.h>

#include <exception>
#include <utility>

#include "base/file.h"

namespace latent::image {

// Small writes are gathered. OpenEXR seeks back to fill in its tables of offsets. Where OpenEXR must be told of a fault it gets an
// exception, which its destructors swallow: so the first fault stays.
class ExrStream final : public Imf::OStream {
 public:
    explicit ExrStream(File& file) : OStream(file.path().c_str()), file_(file) { pending_.reserve(kGather); }

    void write(const char* bytes, int size) override {
        const ByteSpan piece(reinterpret_cast<const std::byte*>(bytes), static_cast<std::size_t>(size));
        if (pending_.size() + piece.size() > kGather) flush();
        if (piece.size() > kGather) return put(piece);
        pending_.insert(pending_.end(), piece.begin(), piece.end());
    }
    std::uint64_t tellp() override { return at_ + pending_.size(); }
    void seekp(std::uint64_t position) override {
        flush();
        at_ = position;
    }
    void flush() {
        put(pending_);
        pending_.clear();
    }

    // What `call` to OpenEXR came to: the file's fault if that was the reason, else OpenEXR's own.
    template <class Call>
    Status guard(const Call& call) {
        try {
            call();
        } catch (...) {
            if (status_) return current_error().at(file_.path().string());
        }
        return status_;
    }

 private:
    static constexpr std::size_t kGather = std::size_t{1} << 16;

    struct WriteFailed : std::exception {};

    void put(ByteSpan bytes) {
        if (status_) status_ = file_.write_all(at_, bytes);
        if (!status_) throw WriteFailed();
        at_ += bytes.size();
    }

    File& file_;
    std::uint64_t at_ = 0;
    Bytes pending_;
    Status status_;
};

}  // namespace latent::image
