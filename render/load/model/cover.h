// render/load/model/cover.h: light for a camera in a closed space: in the box that shows the sky of a game, in a room without
// windows. docs/models.md, "What a model lacks".
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/load/model/model.h"

namespace latent::render {

struct Cover {
    // What shows a sky: the outermost shapes that the camera sees above its horizon, if they are 25 m away or more, and at least
    // twice as far as what else it sees (medians). In ascending order, without instances, which cannot emit.
    std::vector<std::uint32_t> skies{};
    double distance = 0;  // median, to all that it sees
};

// What hides the sky from the camera: nothing unless a ray in each of 576 directions, spread evenly over the sphere, hits something
// opaque. `up`: unit.
std::optional<Cover> cover_of_sky(const Model& model, const Vec3d& up);

// Skies, unless they emit by themselves, emit the radiance of `white` times the colour of their material, to both sides, and
// reflect nothing. If there are none, a lamp at the camera gives matt surfaces at the distance the radiance of `white` times their
// reflectance.
void light_up(const Cover& cover, const color::Spectrum& white, Model& model);

}  // namespace latent::render
