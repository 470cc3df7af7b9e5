#include "render/scene/check.h"

namespace latent::render {
namespace {

// Whether the images of the axes are as long as the first and square to each other, to `tolerance` of that length.
bool is_even(const Affined& m, double tolerance) {
    const double scale = length(m.x);
    const Vec3d x = m.x / scale, y = m.y / scale, z = m.z / scale;
    const auto near = [&](double a, double b) { return std::abs(a - b) <= tolerance; };
    return scale > 0 && near(length(y), 1) && near(length(z), 1) && near(dot(x, y), 0) && near(dot(y, z), 0) && near(dot(z, x), 0);
}

}  // namespace

Refusals check_camera(const CameraDescription& d) {
    Refusals refusals;
    if (!is_even(d.world_from_camera, 1e-4))
        refusals.push_back("Camera: its transformation skews or stretches; use rotations, translations and mirrors");
    if (d.kind != CameraKind::kPerspective && d.lens_radius > 0)
        refusals.push_back("Camera: \"lensradius\" is supported with perspective cameras only");
    return refusals;
}

Refusals check_area_light(const ShapeDescription& shape) {
    const auto refuse = [](const std::string& what) { return Refusals{"an area light on " + what + " is not supported"}; };
    switch (shape.kind) {
        case ShapeKind::kTriangles:
            return {};
        case ShapeKind::kSphere:
            return is_even(shape.to_world, 1e-5) ? Refusals{} : refuse("a sphere that is stretched");
        case ShapeKind::kDisk:
            return refuse("a disk");
        case ShapeKind::kBilinear:
            break;
    }
    return refuse("a patch that is no parallelogram");
}

}  // namespace latent::render
