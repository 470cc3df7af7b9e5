// render/scene/check.h: what a description may say and this renderer refuses, whichever format it came from.
#pragma once

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors: kUnsupported: the transformation skews or stretches; a lens on another camera than a perspective one.
Status check_camera(const CameraDescription& camera);

}  // namespace latent::render
