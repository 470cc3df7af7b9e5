// render/load/pbrt/options.h: the directives before WorldBegin, which say how the world is looked at.
#pragma once

#include <cstdint>
#include <optional>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"
#include "render/load/pbrt/transforms.h"
#include "render/scene/description.h"

namespace latent::render {

class SceneOptions {
 public:
    // `replace_integrator` replaces the scene's.
    SceneOptions(SceneDescription& scene, Diagnostics& diagnostics, bool replace_integrator)
        : scene_(scene), diagnostics_(diagnostics), replace_integrator_(replace_integrator) {}

    // False, and nothing is done, unless `d` is such a directive. `ctm`: the current transformation.
    bool apply(const Directive& d, bool in_world, const CurrentTransform& ctm, std::uint32_t outside_medium);
    // At WorldBegin: the camera, which needs the film's aspect, and its shutter, which needs the times of motions.
    void place_camera(const CurrentTransform& ctm, std::uint32_t outside_medium);

 private:
    struct CameraDirective {
        Directive directive;
        CurrentTransform ctm;
        std::uint32_t outside_medium;
    };

    SceneDescription& scene_;
    Diagnostics& diagnostics_;
    const bool replace_integrator_;
    std::optional<CameraDirective> camera_;
    double start_time_ = 0, end_time_ = 1;  // of motions
};

}  // namespace latent::render
