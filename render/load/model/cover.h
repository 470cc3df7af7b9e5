// render/load/model/cover.h: surfaces that hide a sky: the box that shows the sky of a game, the walls of a room without windows.
// docs/models.md, "What a model lacks".
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/load/model/model.h"

namespace latent::render {

// What a camera at `from` sees above its horizon, in ascending order, if it meets a surface in each of 576 directions that are
// spread evenly over the sphere; else nothing. Of shapes that are also the outermost in a direction, where there are any, these
// alone: the box around a city, but not its houses. Instances are left out, as they cannot emit.
std::vector<std::uint32_t> covers_of_sky(std::span<const LoadedShape> shapes, const Vec3d& from, const Vec3d& up);

// Both sides of those that do not emit by themselves emit the radiance of `white` times the colour of their material.
void let_shine(const std::vector<std::uint32_t>& covers, const color::Spectrum& white, Model& model);

}  // namespace latent::render
