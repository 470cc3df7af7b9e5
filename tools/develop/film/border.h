// tools/develop/film/border.h: what pixels near the film's border miss because no record lies outside. docs/developing.md,
// "Border".
#pragma once

#include <cstdint>
#include <vector>

#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/filter.h"

namespace latent::develop {

// For a filter w and a film of width x height pixels, with records spread evenly over the film at one per pixel:
//   light_share(x, y)    F(q), the expected sum of w(q - p) / sum over all lattice pixels q' of w(q' - p): 1 inside;
//   camera_share(x, y)   G(q), the expected sum of w(q - p): the integral of w inside.
// Both depend on the whole film and the filter alone, never on a crop.
class BorderShare {
 public:
    BorderShare(const Filter& filter, std::uint32_t width, std::uint32_t height);

    double light_share(std::uint32_t x, std::uint32_t y) const;
    double camera_share(std::uint32_t x, std::uint32_t y) const;
    // So far inside that both are those of all such pixels.
    bool inside(const PixelRect& pixels) const;

 private:
    double sum_on_film(const std::vector<double>& squares, std::uint32_t x, std::uint32_t y) const;

    int reach_;
    std::int64_t width_, height_;
    // What the pixel squares at offsets -reach .. reach give to a pixel: integrals of w / lattice sum and of w over each square.
    std::vector<double> light_squares_, camera_squares_;
    double integral_;
};

}  // namespace latent::develop
