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

    const image::ExrTileSpec& spec() const { return spec_; }
    std::size_t width() const { return static_cast<std::size_t>(spec_.x1 - spec_.x0); }
    std::size_t height() const { return static_cast<std::size_t>(spec_.y1 - spec_.y0); }
    const std::vector<std::string>& channels() const { return spec_.channels; }
    // Row after row from the top, all channels of a pixel together.
    const std::vector<float>& pixels() const { return pixels_; }

 private:
    image::ExrTileSpec spec_;
    std::vector<float> pixels_;
};

}  // namespace latent::develop
