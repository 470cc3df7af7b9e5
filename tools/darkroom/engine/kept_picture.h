// tools/darkroom/engine/kept_picture.h: what is developed once and printed often.
#pragma once

#include <cstdint>
#include <memory>

#include "base/file.h"
#include "tools/develop/picture/pixel_array.h"

namespace latent::darkroom {

// Either of these.
struct KeptPicture {
    std::shared_ptr<const File> file;  // an EXR file without a name
    develop::PixelArray linear;

    std::uint64_t bytes() const { return (file ? file->size().value_or(0) : 0) + linear.pixels().size() * sizeof(float); }
};

}  // namespace latent::darkroom
