// render/load/pbrt/subsurface.h: what lies below the surface of a "subsurface" material: a medium that light wanders through.
// docs/pbrt_differences.md.
#pragma once

#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/textures.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors go to the list's diagnostics; what is returned is then of no use, but valid.
MediumDescription read_subsurface(const ParameterList& list, SceneTextures& textures);

}  // namespace latent::render
