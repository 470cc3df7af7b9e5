// tools/develop/picture/pixel_array.h: a picture in memory, for programs that go on with its pixels.
#pragma once

#include <string>
#include <vector>

#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

class PixelArray final : public PictureSink {
 public:
    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override;
    Status finish() override { return {}; }

    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    const std::vector<std::string>& channels() const { return channels_; }
    // Row after row from the top, all channels of a pixel together.
    const std::vector<float>& pixels() const { return pixels_; }

 private:
    std::size_t width_ = 0, height_ = 0;
    std::vector<std::string> channels_;
    std::vector<float> pixels_;
};

}  // namespace latent::develop
