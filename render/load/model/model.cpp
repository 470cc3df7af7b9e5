#include "render/load/model/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "render/math/elementary.h"
#include "render/math/equal_area.h"

namespace latent::render {

namespace {

constexpr double kTowards[] = {0.45, 0.35, 0.82};  // from the model to the camera
constexpr double kHalfHeight = 0.36397;            // of the window: tan 20 degrees
constexpr double kMargin = 1.05;

// A left-handed camera: x to the right in the picture where the world's is right-handed.
Affined looking_along(const Vec3d& forward, const Vec3d& from) {
    const Vec3d right = normalize(cross(forward, Vec3d(0, 1, 0)));
    return {right, cross(right, forward), forward, from};
}

CameraDescription framing(const Box& box, const FilmDescription& film) {
    CameraDescription camera;
    camera.y1 = kHalfHeight;
    camera.x1 = kHalfHeight * film.width / film.height;
    camera.y0 = -camera.y1;
    camera.x0 = -camera.x1;
    const Vec3d middle = box.is_empty() ? Vec3d() : box.middle();
    const Vec3d forward = -normalize(Vec3d(kTowards[0], kTowards[1], kTowards[2]));
    camera.world_from_camera = looking_along(forward, middle);
    const Affined& axes = camera.world_from_camera;
    double distance = 0;
    for (int corner = 0; corner < 8 && !box.is_empty(); ++corner) {
        const Vec3d p =
            Vec3d(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y, corner & 4 ? box.high.z : box.low.z) -
            middle;
        const double across = std::max(std::abs(dot(p, axes.x)) / camera.x1, std::abs(dot(p, axes.y)) / camera.y1);
        distance = std::max(distance, kMargin * across - dot(p, axes.z));
    }
    camera.world_from_camera.t = middle - forward * (distance > 0 ? distance : 1);
    return camera;
}

// From unit direction d, y up: docs/scenes.md, "Formats". Not uniform, so that white things and mirrors stand out.
float sky_radiance(const Vec3f& d) {
    static const Vec3f lamp = Vec3f(normalize(Vec3d(0.5, 0.8, 0.6)));
    return 0.6f + 0.4f * d.y + 4 * exp_nonpositive(std::min(20 * (dot(d, lamp) - 1), 0.0f));
}

LightDescription studio_sky(const color::Spectrum& white) {
    constexpr std::uint32_t kSide = 512;  // 0.4 degrees: no step is seen
    auto image = std::make_shared<ImageDescription>(ImageDescription{.width = kSide, .height = kSide});
    for (std::uint32_t y = 0; y < kSide; ++y) {
        for (std::uint32_t x = 0; x < kSide; ++x) {
            const Vec3f d = sphere_from_square({(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
            image->rgb.insert(image->rgb.end(), 3, sky_radiance(d));
        }
    }
    LightDescription sky;
    sky.kind = LightKind::kInfinite;
    sky.spectrum = white;
    sky.image = std::move(image);
    return sky;
}

}  // namespace

std::vector<std::string> complete(Model model, const color::Spectrum& white, SceneDescription& scene) {
    // Lit windows and displays: other viewers, too, show their model under a sky.
    const auto glows = [](const LoadedShape& loaded) { return loaded.shape.area_light != kNone; };
    const auto is_lamp = [&](const LoadedShape& loaded) { return glows(loaded) && model.radiances[loaded.shape.area_light] > 1; };
    std::vector<std::string> added;
    if (!model.has_camera && !model.has_idle_cameras) added.emplace_back("has no camera; one that shows the whole model is added");
    if (!model.has_camera)
        model.scene.camera = framing(box_of(model.shapes, model.objects, model.scene.instances), model.scene.film);
    if (model.scene.lights.empty() && std::ranges::none_of(model.shapes, is_lamp)) {
        added.emplace_back(fmt::format("has no light{}; a grey sky with a soft light from above is added",
                                       std::ranges::any_of(model.shapes, glows) ? " but surfaces of radiance 1 or less" : ""));
        model.scene.lights.push_back(studio_sky(white));
    }
    model.scene.files = std::move(scene.files);
    scene = std::move(model.scene);
    place(std::move(model.shapes), std::move(model.objects), scene);
    return added;
}

}  // namespace latent::render
