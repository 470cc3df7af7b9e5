#include "render/load/model/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "render/load/files/lat_long.h"
#include "render/load/files/pictures.h"
#include "render/load/model/append.h"
#include "render/load/model/cover.h"
#include "render/load/model/stage.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

constexpr long kMaxSide = 1 << 24;  // along a side of a film, in pixels

// The vertices of the world, and the corners of boxes about instances, while they move.
std::vector<Vec3d> points_of(const Model& model) {
    std::vector<Vec3d> points;
    for (const LoadedShape& shape : model.shapes)
        points.insert(points.end(), shape.mesh->positions.begin(), shape.mesh->positions.end());
    std::vector<Box> boxes(model.objects.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (const LoadedShape& shape : model.objects[i]) {
            for (const Vec3d& p : shape.mesh->positions) boxes[i].add(p);
        }
    }
    for (const InstanceDescription& instance : model.scene.instances) {
        const Box& box = boxes[instance.object];
        const std::vector<Affined> moments = moments_of(instance);
        for (int corner = 0; corner < 8 && !box.is_empty(); ++corner) {
            const Vec3d p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                          corner & 4 ? box.high.z : box.low.z);
            for (const Affined& map : moments) points.push_back(map.point(p));
        }
    }
    return points;
}

// In longitude and latitude, or square; its +z is up.
Result<LightDescription> sky_of(const std::filesystem::path& path, const color::Spectrum& white, const ModelOptions& options) {
    Result<LoadedPicture> picture = read_picture(path, "--sky " + path.string());
    if (!picture) return picture.error();
    ImageDescription& image = picture->image;
    if (is_lat_long(image)) {
        image = equal_area_from_lat_long(image);
    } else if (image.width == 0 || image.width != image.height) {
        return usage_error(fmt::format("--sky {}: {} x {} is neither twice as wide as high (longitude and latitude) nor square",
                                       path.string(), image.width, image.height));
    }
    LightDescription sky;
    sky.kind = LightKind::kInfinite;
    sky.spectrum = white;
    sky.image = std::make_shared<const ImageDescription>(std::move(image));
    if (!options.is_z_up) sky.world_from_light = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}};
    return sky;
}

// Focused on the middle of the model, unless it is said where.
Status set_lens(const ModelOptions& options, const Box& box, CameraDescription& camera) {
    if (options.lens_radius > 0) camera.lens_radius = options.lens_radius;
    const double middle = box.is_empty() ? 1 : dot(box.middle() - camera.world_from_camera.t, camera.world_from_camera.z);
    if (options.focus > 0) {
        camera.focal_distance = options.focus;
    } else if (options.lens_radius > 0) {
        camera.focal_distance = middle > 0 ? middle : 1;
    }
    for (const std::string& refusal : check_camera(camera)) return usage_error("--lens-radius: " + refusal);
    return {};
}

}  // namespace

Result<std::vector<std::string>> complete(Model& model, std::vector<Model> additions, const ModelOptions& options,
                                          const color::Spectrum& white) {
    const Box box = box_of(model.shapes, model.objects, model.scene.instances);
    const std::vector<Vec3d> points = points_of(model);
    for (Model& more : additions) append(std::move(more), model);
    // Lit windows and displays: other viewers, too, show their model under a sky. An object they show under a sky even if it has
    // lamps.
    const auto glows = [](const LoadedShape& loaded) { return loaded.shape.area_light != kNone; };
    const auto is_lamp = [&](const LoadedShape& loaded) { return glows(loaded) && model.radiances[loaded.shape.area_light] > 1; };
    const bool has_light = !model.scene.lights.empty() || std::ranges::any_of(model.shapes, is_lamp);
    const bool is_shown = model.is_object && additions.empty() && options.stage;
    std::vector<std::string> notes = std::move(model.notes);
    if (!model.has_camera && !model.has_idle_cameras) notes.emplace_back("has no camera; one that shows the whole model is added");
    if (model.has_camera && options.view != ModelView::kThreeQuarter) notes.emplace_back("has a camera: --view changes nothing");
    if (model.has_camera && !options.stage) notes.emplace_back("has a camera, and so no ground: --no-stage changes nothing");
    if (!model.has_camera) {
        FilmDescription& film = model.scene.film;
        if (options.aspect)
            film.height = static_cast<std::uint32_t>(std::clamp(std::lround(film.width / *options.aspect), 1L, kMaxSide));
        model.scene.camera = framing(points, film, options);
    }
    if (const Status set = set_lens(options, box, model.scene.camera); !set) return set.error();
    const bool is_closed = !has_light && uncover_sky(model);
    if (!options.sky.empty()) {
        Result<LightDescription> sky = sky_of(options.sky, white, options);
        if (!sky) return sky.error();
        sky->scale = model.sky_scale;
        if (model.sky_scale != 1)
            notes.emplace_back(
                fmt::format("has lamps in lumens, as Blender writes them: the sky is multiplied by {:.0f}", model.sky_scale));
        if (is_closed) notes.emplace_back("has its camera in a closed space: the sky shines through what encloses it");
        model.scene.lights.push_back(std::move(*sky));
    } else if (!has_light || is_shown) {
        const char* const why = has_light                                  ? "is an object with lights of its own"
                                : std::ranges::any_of(model.shapes, glows) ? "has no light but surfaces of radiance 1 or less"
                                                                           : "has no light";
        const bool has_ground = options.stage && !model.has_camera && !box.is_empty();
        notes.emplace_back(is_closed ? fmt::format("{}; a soft sky is added, which shines through what encloses the camera", why)
                                     : fmt::format("{}; a soft sky with a key light{} added{}", why,
                                                   has_ground ? " and a ground are" : " is",
                                                   has_light ? " (--no-stage leaves it without)" : ""));
        LightDescription sky = is_closed ? room_sky(white, options) : studio_sky(white, options);
        sky.scale = model.sky_scale;
        model.scene.lights.push_back(std::move(sky));
        if (has_ground) model.shapes.push_back(studio_ground(box, options, model.scene));
    } else if (additions.empty()) {
        notes.emplace_back("is lit by its own lights alone; --sky FILE adds a sky");
    }
    return notes;
}

}  // namespace latent::render
