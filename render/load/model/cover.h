// render/load/model/cover.h: what hides an added sky from the camera: the walls of a room, or the box that shows the sky of a game.
// docs/models.md, "What a model lacks".
#pragma once

#include "render/load/model/model.h"

namespace latent::render {

// Makes backdrops of the outermost shapes about the camera, until it sees the sky behind the others: in more than 9 of 576
// directions that are spread evenly over the sphere, there is nothing opaque. False: it sees it anyway.
bool uncover_sky(Model& model);

}  // namespace latent::render
