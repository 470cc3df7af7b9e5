// tools/convert/convert.h: prints a developed picture: light to display pixels, in memory that does not depend on its size.
#pragma once

#include "base/progress.h"
#include "tools/convert/options.h"

namespace latent::convert {

// All outputs in one pass (two with automatic exposure); each appears under its name when all are complete. The bytes do not depend
// on threads or memory. Errors: kUsage, kOutOfRange, kExists and those of reading and writing, naming the file.
// The picture is `options.picture`, if there is one, else the file `options.input`.
Result<ConvertReport> convert(const ConvertOptions& options, const Progress& progress);

// Whether that can succeed, as far as is known before there is a picture. Errors: kUsage, kExists.
Status check(const ConvertOptions& options);

}  // namespace latent::convert
