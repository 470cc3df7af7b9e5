// tools/convert/viewer_page.h: the page beside a Deep Zoom pyramid, which shows it with OpenSeadragon from a disk or a server.
#pragma once

#include <string>

#include "image/deep_zoom_writer.h"

namespace latent::convert {

// web/page.html with OpenSeadragon and its licence inside; "@TITLE@" stands for the picture's name, "@PICTURE@" for the description
// of the pyramid.
extern const char* const kViewerPage;

// The page of the pyramid "NAME.dzi", whose tiles are in "NAME_files/" beside the page.
std::string viewer_page(const std::string& name, int width, int height, const image::DeepZoomOptions& options);

}  // namespace latent::convert
