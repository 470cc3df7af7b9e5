// render/transport/bidirectional/bdpt.h: bidirectional path tracing. docs/rendering.md, "Bidirectional path tracing".
#pragma once

#include <memory>

#include "render/transport/integrator.h"
#include "render/world/world.h"

namespace latent::render {

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings);

}  // namespace latent::render
