// tools/convert/encoder.h: from linear light to the samples of a file.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "color/quantise.h"
#include "image/row_writer.h"
#include "tools/convert/device.h"

namespace latent::convert {

// `level` of a pyramid: each gets its own dither.
struct Encoder {
    image::SampleType sample = image::SampleType::kU8;
    color::Transfer transfer;
    color::Dither dither = color::Dither::kRandom;
    std::shared_ptr<const DeviceTransform> device{};  // instead of `transfer`
    std::optional<std::array<float, 3>> grey{};       // one channel: the sum of red, green and blue, each times one of these

    int channels() const { return grey ? 1 : device ? device->channels() : 3; }
    std::size_t pixel_bytes() const { return static_cast<std::size_t>(channels()) * image::sample_bytes(sample); }
    image::PixelFormat format(int width, int height) const { return {width, height, sample, channels()}; }

    // One row of pixels, the first of which is (x0, y) of its level.
    void encode(std::size_t level, const std::array<std::span<const float>, 3>& rgb, int x0, int y, std::byte* out) const;

 private:
    void encode_grey(std::uint32_t seed, const std::array<std::span<const float>, 3>& rgb, int x0, int y, std::byte* out) const;
    void quantise(std::uint32_t seed, const std::array<std::span<const float>, 3>& planes, int x0, int y, std::byte* out) const;
};

}  // namespace latent::convert
