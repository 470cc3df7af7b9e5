// tools/develop/picture/exr_picture.h: a picture that becomes an EXR file, under its name once it is complete.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "base/file.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

class ExrPicture final : public PictureSink {
 public:
    // `replace`: an existing file.
    ExrPicture(std::filesystem::path output, bool replace) : output_(std::move(output)), replace_(replace) {}

    // Errors of all three: kExists, kIo, kNoSpace.
    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override { return writer_->write(x, y, pixels); }
    Status finish() override;

 private:
    const std::filesystem::path output_;
    const bool replace_;
    std::optional<OutputFile> file_;
    std::unique_ptr<image::ExrTileWriter> writer_;  // to file_
};

}  // namespace latent::develop
