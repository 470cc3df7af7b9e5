#include "tools/convert/encoder.h"

#include <cstring>

namespace latent::convert {

using image::SampleType;

namespace {

using Planes = std::array<std::span<const float>, 3>;

// r g b, r g b, ... and k, k, ... (the first of three equal ones) become c m y k, c m y k, ...
void interleave_fourth(const Bytes& three, const Bytes& fourth, std::size_t sample_bytes, std::byte* out) {
    for (std::size_t at = 0; at < three.size(); at += 3 * sample_bytes) {
        std::memcpy(out, &three[at], 3 * sample_bytes);
        std::memcpy(out + 3 * sample_bytes, &fourth[at], sample_bytes);
        out += 4 * sample_bytes;
    }
}

}  // namespace

void Encoder::encode(std::size_t level, const Planes& rgb, int x0, int y, std::byte* out) const {
    const auto seed = static_cast<std::uint32_t>(level);
    if (grey) return encode_grey(seed, rgb, x0, y, out);
    if (!device) return quantise(seed, rgb, x0, y, out);
    thread_local std::array<std::vector<float>, 4> inks;
    for (std::size_t c = 0; c < 3; ++c) inks[c].assign(rgb[c].begin(), rgb[c].end());
    inks[3].resize(rgb[0].size());
    device->apply({inks[0], inks[1], inks[2]}, inks[3]);
    const Planes first{inks[0], inks[1], inks[2]};
    if (channels() == 3) return quantise(seed, first, x0, y, out);
    thread_local Bytes three, fourth;
    three.resize(3 * inks[3].size() * image::sample_bytes(sample));
    fourth.resize(three.size());
    constexpr std::uint32_t kOfTheFourth = 0x80000000;  // its dither is none of the others'
    quantise(seed, first, x0, y, three.data());
    quantise(seed | kOfTheFourth, {inks[3], inks[3], inks[3]}, x0, y, fourth.data());
    interleave_fourth(three, fourth, image::sample_bytes(sample), out);
}

void Encoder::encode_grey(std::uint32_t seed, const Planes& rgb, int x0, int y, std::byte* out) const {
    thread_local std::vector<float> light;
    thread_local Bytes three;
    const auto& m = *grey;
    const std::size_t bytes = image::sample_bytes(sample);
    light.resize(rgb[0].size());
    three.resize(3 * light.size() * bytes);
    for (std::size_t i = 0; i < light.size(); ++i) light[i] = m[0] * rgb[0][i] + m[1] * rgb[1][i] + m[2] * rgb[2][i];
    if (device) device->apply({light, light, light}, {});
    quantise(seed, {light, light, light}, x0, y, three.data());
    for (std::size_t i = 0; i < light.size(); ++i) std::memcpy(out + i * bytes, &three[3 * i * bytes], bytes);
}

void Encoder::quantise(std::uint32_t seed, const Planes& planes, int x0, int y, std::byte* out) const {
    const color::Quantiser quantiser{transfer, sample == SampleType::kU8 ? dither : color::Dither::kNone, seed};
    const std::size_t samples = 3 * planes[0].size();
    const auto column = static_cast<std::uint32_t>(x0), row = static_cast<std::uint32_t>(y);
    if (sample == SampleType::kU8) {
        quantiser.to_8_bits(planes[0], planes[1], planes[2], column, row, {reinterpret_cast<std::uint8_t*>(out), samples});
    } else if (sample == SampleType::kU16) {
        quantiser.to_16_bits(planes[0], planes[1], planes[2], column, row, {reinterpret_cast<std::uint16_t*>(out), samples});
    } else {
        float* values = reinterpret_cast<float*>(out);
        for (std::size_t i = 0; i < samples; ++i) {
            const float light = planes[i % 3][i / 3];
            values[i] = transfer.is_linear() ? light : static_cast<float>(transfer.encode(static_cast<double>(light)));
        }
    }
}

}  // namespace latent::convert
