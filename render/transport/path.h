// render/transport/path.h: path tracing: from the camera, with a light sampled at every vertex, and what the path runs into by
// itself; the two weighed by the power heuristic. In a medium the light of points is sampled along the ray too.
// docs/rendering.md, "Path tracing" and "Media".
#pragma once

#include <memory>

#include "render/transport/integrator.h"
#include "render/world/world.h"

namespace latent::render {

std::unique_ptr<Integrator> make_path_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings);

}  // namespace latent::render
