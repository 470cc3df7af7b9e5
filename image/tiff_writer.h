// image/tiff_writer.h: TIFF and BigTIFF of any size: strips, tiles or a pyramid of tiles, deflated by all threads.
#pragma once

#include <memory>
#include <vector>

#include "base/file.h"
#include "image/row_writer.h"

namespace latent::image {

struct TiffOptions {
    bool tiles = false;      // 256 x 256; else strips near 1 MiB
    int level = 1;           // zlib's
    bool force_big = false;  // BigTIFF also where a classic file would do (it is used anyway where 4 GiB may not)
};

inline constexpr int kTiffTile = 256;

// Any number of images of shrinking size in one file: the first is the picture, the others, marked as reduced, its pyramid; readers
// find them as pages 2, 3, ... The rows of all of them may come interleaved: what must wait goes to one temporary file without a
// name. Deflate with horizontal (8 and 16 bits) or floating point (float) predictor [TIFF6], [TIFF-TN3].
class TiffWriter {
 public:
    // `formats`: of each image, the largest first. Errors: kExists, kIo.
    static Result<std::unique_ptr<TiffWriter>> create(OutputFile out, const std::vector<PixelFormat>& formats,
                                                      const ImageTags& tags, const TiffOptions& options);
    virtual ~TiffWriter() = default;
    // The next rows of image `index`.
    virtual Status write_rows(std::size_t index, ByteSpan rows) = 0;
    // As of RowWriter.
    virtual Status finish() = 0;
    virtual Status publish() = 0;
};

}  // namespace latent::image
