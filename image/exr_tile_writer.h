// image/exr_tile_writer.h: large float pictures as tiled OpenEXR, written tile by tile in bounded memory. docs/developing.md,
// "EXR".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/result.h"

namespace latent::image {

struct ExrTileSpec {
    int display_width = 0, display_height = 0;           // displayWindow: 0, 0 .. width-1, height-1
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;                  // dataWindow: pixels x0 .. x1-1, y0 .. y1-1 of it are in the file
    std::vector<std::string> channels;                   // float32, in the order in which pixels are given
    bool zip = false;                                    // else uncompressed
    bool mipmap = false;                                 // levels down to one pixel, sides rounded up
    std::optional<std::array<float, 8>> chromaticities;  // red, green, blue, white as x, y
    std::optional<std::array<float, 2>> adopted_neutral;
    std::optional<float> white_luminance;                      // cd/m^2 of (1, 1, 1)
    std::vector<std::pair<std::string, std::string>> strings;  // further attributes
};

// Tiles are kTile x kTile pixels (fewer at the right and lower border), counted from the corner of the data window. They are stored
// in the order in which they are written (RANDOM_Y), so the same calls give the same bytes. Pixels of level l of a mip map are the
// mean of the pixels of level 0 that they cover, each level computed in float64 from the float32 pixels of the one before it.
class ExrTileWriter {
 public:
    static constexpr int kTile = 256;

    // Writes to `file` from byte 0. Tiles of coarser levels that wait for others take `waiting_memory` bytes, then an unnamed file
    // beside `file`.
    static Result<std::unique_ptr<ExrTileWriter>> create(File& file, const ExrTileSpec& spec, std::uint64_t waiting_memory);
    virtual ~ExrTileWriter() = default;

    virtual int tiles_x() const = 0;
    virtual int tiles_y() const = 0;
    // Tile (x, y), once: its rows one after another, all channels of a pixel together.
    virtual Status write(int x, int y, std::span<const float> pixels) = 0;
    // After the last tile.
    virtual Status finish() = 0;
};

}  // namespace latent::image
