// render/program/make_integrator.h: from settings to the integrator that they name.
#pragma once

#include <memory>

#include "base/result.h"
#include "render/scene/description.h"
#include "render/transport/integrator.h"

namespace latent::render {

// Both must outlive the integrator. Errors: kUnsupported, kOutOfRange (what the description says and transport refuses).
Result<std::unique_ptr<Integrator>> make_integrator(const SceneDescription& scene, const IntegratorSettings& settings);

}  // namespace latent::render
