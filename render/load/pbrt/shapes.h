// render/load/pbrt/shapes.h: shapes: meshes are brought into the space of `ctm` here, quadrics keep their transformation.
#pragma once

#include <string>
#include <vector>

#include "render/load/files/scene_files.h"
#include "render/load/mesh/placement.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/textures.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

// The shapes of one Shape directive (a mesh of triangles and quads is two), in the space that `ctm` maps to. Orientation is
// resolved; material, light and media are the caller's. `emits`: an area light is one of them.
std::vector<LoadedShape> read_shape(const std::string& type, const ParameterList& list, const Affined& ctm,
                                    bool reverse_orientation, bool emits, SceneTextures& textures, SceneFiles& files);

}  // namespace latent::render
