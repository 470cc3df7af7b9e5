// image/png_writer.h: PNG of any size, compressed by all threads; the bytes do not depend on how many there are.
#pragma once

#include <memory>
#include <span>

#include "base/file.h"
#include "image/row_writer.h"

namespace latent::image {

struct PngOptions {
    int level = 1;  // zlib's: 1 is five times faster than 6 and some percent larger
};

// 8 or 16 bits. The rows are cut into strips near 1 MiB (by the width alone); each is filtered and deflated by itself and ends on a
// byte boundary, so that together they are one stream [RFC1950]. Errors: kExists; kUsage for floats.
Result<std::unique_ptr<RowWriter>> create_png(OutputFile out, const PixelFormat& format, const ImageTags& tags,
                                              const PngOptions& options);

// A whole small image in memory; `rows` are format.height pointers to rows.
Result<Bytes> encode_png(std::span<const std::byte* const> rows, const PixelFormat& format, const ImageTags& tags,
                         const PngOptions& options);

}  // namespace latent::image
