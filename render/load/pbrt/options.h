// render/load/pbrt/options.h: the directives before WorldBegin, which say how the world is looked at.
#pragma once

#include <cstdint>
#include <optional>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"
#include "render/load/pbrt/transforms.h"
#include "render/scene/description.h"

namespace latent::render {

// How a scene is read that is not one by itself.
struct PbrtUse {
    bool replaces_integrator = false;  // whatever the scene's is: the job says which
    bool is_addition = false;          // to another scene: it may lack WorldBegin, and then is a world alone
    bool is_right_handed = false;      // its world: a camera that would show that mirrored is turned left for right
};

class SceneOptions {
 public:
    SceneOptions(SceneDescription& scene, Diagnostics& diagnostics, const PbrtUse& use)
        : scene_(scene), diagnostics_(diagnostics), use_(use) {}

    // False, and nothing is done, unless `d` is such a directive. `ctm`: the current transformation.
    bool apply(const Directive& d, bool in_world, const CurrentTransform& ctm, std::uint32_t outside_medium);
    // At WorldBegin: the camera, which needs the film's aspect, and its shutter, which needs the times of motions.
    void place_camera(const CurrentTransform& ctm, std::uint32_t outside_medium);

    bool has_camera() const { return camera_.has_value(); }
    bool has_integrator() const { return has_integrator_; }

 private:
    struct CameraDirective {
        Directive directive;
        CurrentTransform ctm;
        std::uint32_t outside_medium;
    };

    SceneDescription& scene_;
    Diagnostics& diagnostics_;
    const PbrtUse use_;
    bool has_integrator_ = false;
    std::optional<CameraDirective> camera_;
    double start_time_ = 0, end_time_ = 1;  // when motions begin and end
};

}  // namespace latent::render
