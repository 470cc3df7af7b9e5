// image/oiio/intact.h: PNG, JPEG and TIFF files that were cut off, and PNG files of which a byte has changed. OpenImageIO lets
// libpng write about these to standard error, and makes the missing part of a JPEG grey, and that of a TIFF black.
#pragma once

#include <string>

#include "base/result.h"

namespace latent::image {

// Reads the whole file. Errors: kCorrupt, without the path. Files of other formats, and those that cannot be read, are not checked.
Status check_intact(const std::string& path);

}  // namespace latent::image
