#include "render/load/gltf/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/scene/check.h"

namespace latent::render {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::uint32_t kWidth = 1280;

}  // namespace

void read_camera(const GltfValue& value, const Affined& m, SceneDescription& scene) {
    CameraDescription camera;
    // Looks along -z of its node; a scale is no part of it.
    camera.world_from_camera = {normalize(m.x), normalize(m.y), -normalize(m.z), m.t};
    const std::string type = value["type"].text();
    double aspect = static_cast<double>(scene.film.width) / scene.film.height;
    if (type == "perspective") {
        const GltfValue perspective = value["perspective"];
        aspect = perspective["aspectRatio"].number(aspect, 1e-3, 1e3);
        camera.y1 = std::tan(perspective["yfov"].number(1, 1e-4, 3.14) / 2);
        camera.x1 = camera.y1 * aspect;
    } else if (type == "orthographic") {
        const GltfValue orthographic = value["orthographic"];
        camera.kind = CameraKind::kOrthographic;
        camera.x1 = std::abs(orthographic["xmag"].number(1));
        camera.y1 = std::abs(orthographic["ymag"].number(1));
        aspect = camera.x1 / camera.y1;
        if (!(aspect >= 1e-3 && aspect <= 1e3)) {
            orthographic.error("xmag and ymag: must not be zero, nor differ by more than a factor of 1000");
            aspect = 1;
        }
    } else {
        value["type"].error("must be \"perspective\" or \"orthographic\"");
    }
    camera.x0 = -camera.x1;
    camera.y0 = -camera.y1;
    scene.film.width = kWidth;
    scene.film.height = static_cast<std::uint32_t>(std::max(std::lround(kWidth / aspect), 1L));
    for (const std::string& refusal : check_camera(camera)) value.error(refusal);
    scene.camera = camera;
}

LightDescription read_light(const GltfValue& value, const Affined& m, const ModelColors& colors) {
    LightDescription light;
    light.spectrum = colors.emission(value["color"].factors(LinearRgb{1, 1, 1}, 0, 1));
    light.scale = value["intensity"].factor(1, 0, GltfValue::kNoLimit);
    light.name = value["name"].text();
    const Vec3d towards = -normalize(m.z);
    const std::string type = value["type"].text();
    if (type == "directional") {
        light.kind = LightKind::kDistant;
        light.to = towards;
        return light;
    }
    light.world_from_light.t = m.t;
    if (type == "point") return light;
    light.to = towards;
    if (type != "spot") value["type"].error("must be \"directional\", \"point\" or \"spot\"");
    light.kind = LightKind::kSpot;
    const GltfValue spot = value["spot"];
    const double inner = spot["innerConeAngle"].factor(0, 0, std::numbers::pi / 2),
                 outer = spot["outerConeAngle"].factor(std::numbers::pi / 4, 0, std::numbers::pi / 2);
    if (!(inner <= outer) || outer == 0) spot.error("innerConeAngle must be less than outerConeAngle");
    light.cone_degrees = outer * kDegrees;
    light.cone_delta_degrees = (outer - inner) * kDegrees;
    return light;
}

}  // namespace latent::render
