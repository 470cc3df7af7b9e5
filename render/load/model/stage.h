// render/load/model/stage.h: what a model that is nothing but a model is shown with: a camera, a sky with a key light, a ground.
// docs/models.md, "What a model lacks".
#pragma once

#include <span>

#include "render/load/mesh/placement.h"
#include "render/load/model/options.h"
#include "render/scene/description.h"

namespace latent::render {

// The turn from the stage, whose up is +y and whose front is +z, to the model's world.
Affined world_from_stage(const ModelOptions& options);

// A perspective camera that sees `points` from the side that `options` says, in the middle of the picture and across 80 % of its
// width or height, whichever is reached first.
CameraDescription framing(std::span<const Vec3d> points, const FilmDescription& film, const ModelOptions& options);

// A sky of this radiance, times that of `white`, in direction d of the stage:
//   0.4 - 0.32 max(d.z, 0)^2 + 0.3 max(d.y, 0) + 25 exp(25 (d . k - 1)),  k = (0.5, 0.8, 0.6) / |(0.5, 0.8, 0.6)|
// plus that of two soft boxes, to the left and to the right. Cameras of the stage see 0.4 below the horizon; behind them it is
// dark, so that mirrors show a gradient.
LightDescription studio_sky(const color::Spectrum& white, const ModelOptions& options);

// The sky for a camera that is closed in (cover.h). Its radiance in direction d of the stage, times that of `white`:
//   0.9 + 0.3 d.y + 0.15 d.z
// Even enough for a box that shows a sky, and uneven enough to tell the walls of a room apart.
LightDescription room_sky(const color::Spectrum& white, const ModelOptions& options);

// A disk below `box`, about eight times as wide, that fades towards its edge into the sky below the horizon: it has its 0.4
// wherever the sky shines on it unhindered. Its material and its fading are added to the scene.
LoadedShape studio_ground(const Box& box, const ModelOptions& options, SceneDescription& scene);

}  // namespace latent::render
