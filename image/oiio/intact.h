// image/oiio/intact.h: PNG, JPEG, TIFF, WebP, PFM, PGM and PPM files that were cut off, PNG files of which a byte has changed, and
// headers that cannot be. OpenImageIO lets libpng write about these to standard error, makes the missing part of a JPEG grey, and
// that of a TIFF black, and of the others says little.
#pragma once

#include <string>

#include "base/result.h"

namespace latent::image {

// Reads the whole file. False: it is of another format, or cannot be read, and was not checked. Errors: kCorrupt, without the path.
Result<bool> check_intact(const std::string& path);

}  // namespace latent::image
