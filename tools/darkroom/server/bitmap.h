// tools/darkroom/server/bitmap.h: code values as BMP, which browsers show at once and which costs nothing to make.
#pragma once

#include <string>

#include "tools/convert/options.h"

namespace latent::darkroom {

// 24 bits, with a BITMAPV5HEADER that names sRGB or holds the profile.
std::string bitmap_of(const convert::CodeValues& codes);

}  // namespace latent::darkroom
