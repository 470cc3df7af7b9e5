// image/deep_zoom_writer.h: a Deep Zoom pyramid of tiles: NAME.dzi, NAME_files/LEVEL/COLUMN_ROW.jpg and a page NAME.html.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "image/jpeg_writer.h"
#include "image/png_writer.h"
#include "image/row_writer.h"

namespace latent::image {

struct DeepZoomOptions {
    int tile = 256;    // pixels a side
    int overlap = 1;   // pixels of its neighbours around each tile
    bool png = false;  // lossless tiles; else JPEG
    JpegOptions jpeg;
    PngOptions png_options;
    bool replace = false;  // --force
    std::string recipe;    // base/recipe.h, a comment of NAME.dzi; "": none
};

// Sizes of the pyramid: the picture, then halved (rounding up) until both sides are 1.
std::vector<PixelFormat> deep_zoom_levels(int width, int height);

// Tiles, page and descriptor are an OutputSet: gathered in a hidden folder beside the result and named together.
class DeepZoomWriter {
 public:
    // `path` ends in .dzi; `page` is the text of NAME.html, or empty for none. Errors: kExists (naming which of the three), kIo.
    static Result<std::unique_ptr<DeepZoomWriter>> create(const std::filesystem::path& path, int width, int height,
                                                          const ImageTags& tags, const std::string& page,
                                                          const DeepZoomOptions& options);
    virtual ~DeepZoomWriter() = default;
    // The next rows, 8 bits, of the picture after `halvings` halvings. Tiles are encoded and written by all threads.
    virtual Status write_rows(std::size_t halvings, ByteSpan rows) = 0;
    // As of RowWriter. The folder gets its name first, the descriptor last.
    virtual Status finish() = 0;
    virtual Status publish() = 0;
};

}  // namespace latent::image
