#include "render/program/make_integrator.h"

#include "render/transport/bidirectional/bdpt.h"
#include "render/transport/path.h"

namespace latent::render {

Result<std::unique_ptr<Integrator>> make_integrator(const SceneDescription& scene, const IntegratorSettings& settings) {
    if (settings.batch < 4 || settings.batch > kMaxWavelengths)
        return Error{ErrorCode::kOutOfRange, "--wavelengths: must be 4 to 32"};
    Result<std::unique_ptr<World>> world = World::build(scene, settings.simd, settings.textures);
    if (!world) return world.error();
    if (settings.kind == IntegratorKind::kBdpt) return make_bdpt_integrator(std::move(*world), settings);
    return make_path_integrator(std::move(*world), settings);
}

}  // namespace latent::render
