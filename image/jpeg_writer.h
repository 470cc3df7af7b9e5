// image/jpeg_writer.h: JPEG (8 bits, libjpeg-turbo), with the colour profile in APP2.
#pragma once

#include <memory>
#include <span>

#include "base/file.h"
#include "image/row_writer.h"

namespace latent::image {

struct JpegOptions {
    int quality = 90;  // 1..100; from 90 on colour is stored as finely as luminance (4:4:4), below at half the resolution (4:2:0)
};

// Errors: kExists; kOutOfRange above 65,500 pixels a side, saying what to use instead; kUsage for anything but 8 bits.
Result<std::unique_ptr<RowWriter>> create_jpeg(OutputFile out, const PixelFormat& format, const ImageTags& tags,
                                               const JpegOptions& options);

// A whole small image in memory; `rows` are format.height pointers to rows.
Result<Bytes> encode_jpeg(std::span<const std::byte* const> rows, const PixelFormat& format, const ImageTags& tags,
                          const JpegOptions& options);

}  // namespace latent::image
