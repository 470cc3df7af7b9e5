// render/load/files/lat_long.h: pictures of the sky in longitude and latitude, as most are published.
#pragma once

#include "render/scene/description.h"

namespace latent::render {

// Twice as wide as high.
bool is_lat_long(const ImageDescription& image);

// The same sky in pbrt's equal-area octahedral mapping: every pixel is the mean of 16 places in it. In light space, the first row
// of `image` is about +z, and its first column begins at +x and goes towards +y, as for pbrt-v3 and imgtool's makeequiarea.
ImageDescription equal_area_from_lat_long(const ImageDescription& image);

}  // namespace latent::render
