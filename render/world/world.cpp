#include "render/world/world.h"

#include <algorithm>

namespace latent::render {

Result<std::unique_ptr<World>> World::build(const SceneDescription& scene, const Geometry& geometry) {
    const Result<Camera> camera = Camera::make(scene.camera);
    if (!camera) return camera.error();
    std::unique_ptr<World> world(new World(geometry, *camera));

    for (const MaterialDescription& d : scene.materials) {
        world->materials_.emplace_back(d, world->library_);
        world->has_dispersion_ |= d.dispersive;
    }
    for (const MediumDescription& d : scene.media) {
        Medium m;
        const auto add = [&](const std::function<double(double)>& sigma) {
            return world->library_.add(color::Spectrum::from_function(sigma, color::Outside::kZero), Lookup::kNearestNm);
        };
        m.sigma_t = add([&](double nm) { return d.scale * (d.sigma_a(nm) + d.sigma_s(nm)); });
        m.sigma_s = add([&](double nm) { return d.scale * d.sigma_s(nm); });
        m.phase.g = static_cast<float>(d.g);
        world->media_.push_back(m);
    }
    const auto has_interface = [](const std::vector<ShapeDescription>& shapes) {
        return std::any_of(shapes.begin(), shapes.end(), [](const ShapeDescription& s) { return is_interface(s.material); });
    };
    world->has_interfaces_ =
        has_interface(scene.shapes) || std::any_of(scene.objects.begin(), scene.objects.end(),
                                                   [&](const ObjectDescription& o) { return has_interface(o.shapes); });

    if (world->has_media()) world->medium_at_infinity_ = world->find_medium_at_infinity();

    // The sky's disk covers the camera too, so that its light can fall on a lens.
    const float radius =
        std::max(geometry.radius(), length(world->camera_.center() - geometry.center()) + 1e-3f * geometry.radius());
    world->lights_ =
        std::make_unique<Lights>(Lights::build(scene, geometry, geometry.center(), std::max(radius, 1e-6f), world->library_));
    if (world->lights_->size() == 0)
        return Error{ErrorCode::kOutOfRange, "the scene has no light, so every picture would be black"};
    return world;
}

// Where a straight line from the camera, through everything, ends.
std::uint32_t World::find_medium_at_infinity() const {
    std::uint32_t medium = camera_.medium();
    Ray ray{camera_.center(), camera_.axis()};
    while (const std::optional<SurfaceHit> hit = geometry_->intersect(ray)) {
        medium = medium_beyond(*hit, ray.d, medium);
        ray = spawn_ray(hit->anchor(), ray.d);
    }
    return medium;
}

bool World::connect(const Anchor& from, const Anchor& to, std::uint32_t medium, SampledSpectra& spectra, Batch& value,
                    Line& line) const {
    const Ray ray = spawn_ray(from, to);
    if (medium == kNone && !has_interfaces_) return !geometry_->occluded(ray);
    return walk(ray, length(to.p - from.p), medium, spectra, value, line);
}

bool World::connect_sky(const Anchor& from, const Vec3f& w, std::uint32_t medium, SampledSpectra& spectra, Batch& value,
                        Line& line) const {
    const Ray ray = spawn_ray(from, w);
    if (medium == kNone && !has_interfaces_) return !geometry_->occluded(ray);
    return walk(ray, kFar, medium, spectra, value, line);
}

bool World::walk(Ray ray, float length_left, std::uint32_t medium, SampledSpectra& spectra, Batch& value, Line& line) const {
    const auto pass = [&](float stretch) {
        if (medium != kNone) line.passing *= multiply_transmittance(media_[medium], stretch, spectra, value);
        if (line.first_length == 0) line.first_length = stretch;
        line.last_medium = medium;
        line.last_length = stretch;
    };
    line.first_medium = medium;
    if (has_interfaces_) {
        const bool ends = ray.t_max < kInfinity;
        const Vec3f end = ray.o + ray.d;
        while (const std::optional<SurfaceHit> hit = geometry_->intersect(ray)) {
            if (!is_interface(hit->material)) return false;
            const float stretch = hit->t * length(ray.d);
            pass(stretch);
            length_left -= stretch;
            medium = medium_beyond(*hit, ray.d, medium);
            ray.o = spawn_ray(hit->anchor(), ray.d).o;
            if (!ends) continue;
            // Aimed anew, so that steps off the interfaces on the way do not carry the end into the far surface.
            if (!(dot(end - ray.o, ray.d) > 0)) break;
            ray.d = end - ray.o;
        }
    } else if (geometry_->occluded(ray)) {
        return false;
    }
    pass(std::max(length_left, 0.0f));
    return true;
}

}  // namespace latent::render
