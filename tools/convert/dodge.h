// tools/convert/dodge.h: parts of a print get more light or less, as under the hands of a printer. docs/converting.md, "Dodge and
// burn".
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "image/rect.h"

namespace latent::convert {

// A place of the picture: parts of its width and of its height, from the upper left corner.
struct Place {
    double x = 0, y = 0;
};

// Light in stops, along a line or across the whole picture.
struct Dodge {
    std::string text;  // as it was asked for
    double stops = 0;
    double radius = 0;          // the brush's, in parts of the picture's longer side; 0: a gradient
    std::vector<Place> line{};  // that the brush follows; of a gradient: where it has all of its stops, and where none
};
// "brush:EV,RADIUS,X,Y,...", "gradient:EV,X0,Y0,X1,Y1". Errors: kUsage.
Result<Dodge> parse_dodge(std::string_view text);

// The light of pixels x0, x0 + 1, ... of row y, times 2 to the sum of all stops there. A brush has (1 - d^2)^2 of its stops at
// d radii from its line; a gradient 1 - t^2 (3 - 2 t) at the part t of its way.
class Dodging {
 public:
    Dodging(std::span<const Dodge> all, const image::Rect& whole);
    // False if no pixel of that row is changed.
    bool reaches(int y) const;
    void apply(int x0, int y, const std::array<std::span<float>, 3>& rows) const;

 private:
    struct Stroke {
        double stops, radius;                       // in pixels
        std::vector<std::array<double, 2>> line{};  // pixels, from the centre of the first
        double first = 0, last = 0;                 // rows that it reaches
    };
    static double share(const Stroke& stroke, double x, double y);

    std::vector<Stroke> strokes_;
};

}  // namespace latent::convert
