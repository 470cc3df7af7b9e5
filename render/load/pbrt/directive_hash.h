// render/load/pbrt/directive_hash.h: what a directive adds to the hash of a scene.
#pragma once

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/directive.h"

namespace latent::render {

// A directive that shapes the picture. File names are left out: the files' content counts.
void count(const Directive& directive, SceneFiles& files);

}  // namespace latent::render
