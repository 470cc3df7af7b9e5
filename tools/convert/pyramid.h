// tools/convert/pyramid.h: a picture seen from farther and farther away: means of 2 x 2 pixels in linear display light.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/result.h"

namespace latent::convert {

// Rows of a level, planar: each row is `width` reds, then greens, then blues.
struct PlanarRows {
    int width = 0, height = 0;
    std::vector<float> values;

    PlanarRows() = default;
    PlanarRows(int w, int h) : width(w), height(h), values(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    float* plane(int y, std::size_t c) {
        return values.data() + (3 * static_cast<std::size_t>(y) + c) * static_cast<std::size_t>(width);
    }
    const float* plane(int y, std::size_t c) const { return const_cast<PlanarRows*>(this)->plane(y, c); }
};

// out[i] = mean of the 2 x 2 pixels i of two rows; a lone last column, or a lone row (`below` null), is averaged over what there
// is.
void halve(const float* row, const float* below, std::size_t width, float* out);

// Takes level 1 from the top, row by row, and makes the rows of the levels below it as soon as they are complete. A level has half
// the sides of the one above it, rounded up. Holds one row per level between calls.
class Pyramid {
 public:
    // `height`: of level 1. Levels 1 .. levels - 1 are made.
    Pyramid(int height, std::size_t levels);

    // Gets the rows of a level, the first of which is row `y` of that level.
    using Emit = std::function<Status(std::size_t level, int y, const PlanarRows& rows)>;
    // The next rows of level 1, at least one.
    Status add(PlanarRows rows, const Emit& emit);

 private:
    struct Level {
        int height = 0;   // in all
        int done = 0;     // rows emitted
        PlanarRows kept;  // the last row, where its partner is still to come
    };
    std::vector<Level> levels_;
};

}  // namespace latent::convert
