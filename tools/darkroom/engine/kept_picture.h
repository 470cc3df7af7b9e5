// tools/darkroom/engine/kept_picture.h: what is developed once and printed often.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "base/file.h"
#include "tools/develop/noise/noise.h"
#include "tools/develop/picture/pixel_array.h"

namespace latent::darkroom {

// One of these.
struct KeptPicture {
    std::shared_ptr<const File> file;  // an EXR file without a name
    develop::PixelArray linear;
    develop::NoiseMap noise{std::nullopt};

    std::uint64_t bytes() const {
        return (file ? file->size().value_or(0) : 0) + (linear.pixels().size() + noise.columns() * noise.rows()) * sizeof(float);
    }
};

}  // namespace latent::darkroom
