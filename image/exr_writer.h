// image/exr_writer.h: a finished picture as scan line OpenEXR, zip compressed.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "image/rect.h"
#include "image/row_writer.h"

namespace latent::image {

struct ExrTags {
    std::optional<std::array<float, 8>> chromaticities;      // red, green, blue, white as x, y
    std::vector<std::pair<std::string, std::string>> texts;  // string attributes
    int pixels_per_inch = 0;                                 // 0: nothing is said of its size on paper
};

// Rows are interleaved RGB floats, stored as float or (rounded) as half. `threads`: how many compress. Errors: kExists, kIo.
Result<std::unique_ptr<RowWriter>> create_exr(OutputFile out, const Rect& data_window, const Rect& display_window, bool as_half,
                                              const ExrTags& tags, int threads);

}  // namespace latent::image
