// tools/convert/icc.h: profiles through Little CMS [ICC]: written for our spaces, read from files.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "color/rgb_space.h"
#include "tools/convert/display.h"

namespace latent::convert {

// The profile of a space with primaries; always the same bytes for the same space.
Bytes icc_of(const color::RgbSpace& space);
// The profile of one channel of this transfer, whose white is the display's.
Bytes grey_icc_of(const color::RgbSpace& space);
// `luminance_row` and errors as of display_from.
Result<Display> display_from_icc(const std::string& path, const std::optional<std::array<double, 3>>& luminance_row,
                                 const Rendering& rendering);

}  // namespace latent::convert
