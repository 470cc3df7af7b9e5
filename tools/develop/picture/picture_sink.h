// tools/develop/picture/picture_sink.h: where a picture goes: a file (exr_picture.h) or memory (pixel_array.h).
#pragma once

#include <cstdint>

#include "base/result.h"
#include "image/exr_tile_writer.h"
#include "tools/develop/engine/assembly.h"

namespace latent::develop {

class PictureSink : public TileSink {
 public:
    // Before the first tile: the size, the crop, the channels, and what is to be known of them. What was begun before is forgotten.
    // Tiles that wait for others take `waiting_memory`.
    virtual Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) = 0;
    // After the last tile.
    virtual Status finish() = 0;
};

}  // namespace latent::develop
