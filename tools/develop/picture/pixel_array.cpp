#include "tools/develop/picture/pixel_array.h"

#include <algorithm>

namespace latent::develop {

Status PixelArray::begin(const image::ExrTileSpec& spec, std::uint64_t) {
    spec_ = spec;
    pixels_.assign(width() * height() * channels().size(), 0);
    return {};
}

Status PixelArray::write(int x, int y, std::span<const float> pixels) {
    const std::size_t first = static_cast<std::size_t>(x) * kTile, columns = std::min<std::size_t>(kTile, width() - first);
    const std::size_t stride = channels().size(), row = columns * stride;
    std::size_t at = (static_cast<std::size_t>(y) * kTile * width() + first) * stride;
    for (; !pixels.empty(); pixels = pixels.subspan(row), at += width() * stride)
        std::copy_n(pixels.begin(), row, pixels_.begin() + static_cast<std::ptrdiff_t>(at));
    return {};
}

}  // namespace latent::develop
