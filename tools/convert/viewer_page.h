// tools/convert/viewer_page.h: the page beside a Deep Zoom pyramid, which shows it with OpenSeadragon from a disk or a server.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "image/deep_zoom_writer.h"

namespace latent::convert {

// web/page.html with OpenSeadragon and its licence inside; "@TITLE@" stands for the picture's name, "@PICTURE@" for the description
// of the pyramid.
extern const char* const kViewerPage;

// A pyramid that another print left.
struct OtherPyramid {
    std::string name;    // "NAME" of NAME.dzi
    std::string folder;  // where its tiles are, as seen from the page
    std::string format;
    int tile = 0, overlap = 0;
};
// Reads a descriptor that is to be compared with a picture of this size, for a page beside `page_of`. Errors: of reading; kForeign;
// kUsage if it has another size.
Result<OtherPyramid> read_pyramid(const std::filesystem::path& descriptor, const std::filesystem::path& page_of, int width,
                                  int height);

// The page of the pyramid "NAME.dzi", whose tiles are in "NAME_files/" beside the page; with a divider between it and `other`.
std::string viewer_page(const std::string& name, int width, int height, const image::DeepZoomOptions& options,
                        const std::optional<OtherPyramid>& other = std::nullopt);

}  // namespace latent::convert
