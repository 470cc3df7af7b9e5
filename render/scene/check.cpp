#include "render/scene/check.h"

namespace latent::render {

Status check_camera(const CameraDescription& d) {
    const Affined& m = d.world_from_camera;
    const double scale = length(m.x);
    const Vec3d x = m.x / scale, y = m.y / scale, z = m.z / scale;
    const auto off = [](double a, double b) { return std::abs(a - b) > 1e-4; };
    if (!(scale > 0) || off(length(y), 1) || off(length(z), 1) || off(dot(x, y), 0) || off(dot(y, z), 0) || off(dot(z, x), 0)) {
        return Error{ErrorCode::kUnsupported,
                     "Camera: its transformation skews or stretches; use rotations, translations and mirrors"};
    }
    if (d.kind != CameraKind::kPerspective && d.lens_radius > 0) {
        return Error{ErrorCode::kUnsupported, "Camera: \"lensradius\" is supported with perspective cameras only"};
    }
    return {};
}

}  // namespace latent::render
