// render/load/model/append.h: one scene added to another. docs/models.md, "Add lamps, things or a camera".
#pragma once

#include "render/load/model/model.h"

namespace latent::render {

// Adds lights, media, shapes and all that they are made of; the camera with film and shutter, and the integrator, if `more` has
// them. Tables follow one another, and indices count on.
void append(Model more, Model& model);

}  // namespace latent::render
