// tools/darkroom/engine/kept_picture.h: what is developed once and printed often.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/file.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::darkroom {

// A picture as it comes, all layers of a pixel together, for sums of them.
class LinearPicture final : public develop::PictureSink {
 public:
    Status begin(const image::ExrTileSpec& spec, std::uint64_t) override {
        spec_ = spec;
        tiles_.clear();
        return {};
    }
    Status write(int x, int y, std::span<const float> pixels) override {
        tiles_[{x, y}] = {pixels.begin(), pixels.end()};
        return {};
    }
    Status finish() override { return {}; }

    const image::ExrTileSpec& spec() const { return spec_; }
    const std::map<std::pair<int, int>, std::vector<float>>& tiles() const { return tiles_; }  // by x and y
    std::uint64_t bytes() const {
        std::uint64_t floats = 0;
        for (const auto& [place, pixels] : tiles_) floats += pixels.size();
        return floats * sizeof(float);
    }

 private:
    image::ExrTileSpec spec_;
    std::map<std::pair<int, int>, std::vector<float>> tiles_;
};

// Either of these.
struct KeptPicture {
    std::shared_ptr<const File> file;  // an EXR file without a name
    LinearPicture linear;

    std::uint64_t bytes() const { return (file ? file->size().value_or(0) : 0) + linear.bytes(); }
};

}  // namespace latent::darkroom
