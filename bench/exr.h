// bench/exr.h: the pixels of an EXR of three channels, as they are.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/exr_reader.h"

namespace latent::bench {

struct Planes {
    image::ExrImage header;
    int width = 0, height = 0;
    std::array<std::vector<float>, 3> channels;

    std::size_t pixels() const { return channels[0].size(); }
};

// Throws std::runtime_error.
inline Planes read_planes(const std::string& path) {
    const auto fail = [&](const std::string& why) { throw std::runtime_error(path + ": " + why); };
    Result<image::ExrReader> reader = image::ExrReader::open(path);
    if (!reader) fail(reader.error().message);
    const image::Rect& window = reader->image().data_window;
    Planes planes{reader->image(), window.width(), window.height(), {}};
    for (auto& channel : planes.channels) channel.resize(window.pixels());
    image::ExrReader::Scratch scratch;
    auto& [r, g, b] = planes.channels;
    const Status read = reader->read(window, {r.data(), g.data(), b.data()}, static_cast<std::size_t>(window.width()), scratch);
    if (!read) fail(read.error().message);
    return planes;
}

}  // namespace latent::bench
