// tools/develop/picture/unnamed_picture.h: a picture that becomes an EXR file without a name, for what reads it next.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "base/file.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

class UnnamedPicture final : public PictureSink {
 public:
    using MakeFile = std::function<Result<File>()>;
    explicit UnnamedPicture(MakeFile make_file) : make_file_(std::move(make_file)) {}

    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override {
        Result<File> file = make_file_();
        if (!file) return file.error();
        file_ = std::make_shared<File>(std::move(*file));
        Result<std::unique_ptr<image::ExrTileWriter>> writer = image::ExrTileWriter::create(*file_, spec, waiting_memory);
        if (!writer) return writer.error();
        writer_ = std::move(*writer);
        return {};
    }
    Status write(int x, int y, std::span<const float> pixels) override { return writer_->write(x, y, pixels); }
    Status finish() override { return writer_->finish(); }

    std::shared_ptr<const File> file() const { return file_; }

 private:
    const MakeFile make_file_;
    std::shared_ptr<File> file_;
    std::unique_ptr<image::ExrTileWriter> writer_;  // to file_
};

}  // namespace latent::develop
