// tools/convert/white.h: what prints neutral, as people name it: a light, a chromaticity, a grey card in the picture.
#pragma once

#include <string>
#include <variant>

#include "base/result.h"
#include "color/tristimulus.h"
#include "image/rect.h"

namespace latent::convert {

struct Source;

// A chromaticity, or the pixels whose mean has it.
using White = std::variant<color::Chromaticity, image::Rect>;

// "D65", "D50", "A", "E", "F1" to "F12"; "5200K": daylight from 4000 K on, a blackbody below; "x,y"; "X,Y,WIDTH,HEIGHT", pixels in
// the coordinates of the display window. All but "x,y" under CIE 1931, rounded to 4 decimals. Errors: kUsage, with the choices.
Result<White> parse_white(const std::string& text);

// The chromaticity of `white`. That of pixels is taken from the mean of those that are finite, and rounded to 4 decimals: the
// number in the report is the number used. Errors: kUsage for pixels beyond the file's; kOutOfRange if they have no light;
// those of reading.
Result<color::Chromaticity> chromaticity_of(const White& white, const Source& source);

// "0.3127,0.3290": what --white accepts.
std::string text_of(color::Chromaticity white);

}  // namespace latent::convert
