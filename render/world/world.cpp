#include "render/world/world.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/light/scene_ball.h"
#include "render/medium/make_medium.h"
#include "render/sampling/random.h"
#include "render/sampling/warp.h"
#include "render/world/texture_point.h"

namespace latent::render {

namespace {

constexpr double kFarthest = 1e12;    // [m]: of a medium about the scene; beyond it, directions have too few digits
constexpr float kDeepestCell = 1e5f;  // mean free paths: a ray may take as many steps in vain

Error refused(const SceneDescription& scene, const MediumDescription& medium, const std::string& why) {
    const SourceLocation& at = medium.location;
    return Error{ErrorCode::kOutOfRange,
                 fmt::format("{}:{}:{}: medium \"{}\": {}", scene.files[at.file], at.line, at.column, medium.name, why)};
}

}  // namespace

Result<std::unique_ptr<World>> World::build(const SceneDescription& scene, const std::string& simd,
                                            const TextureSettings& settings) {
    const Result<Camera> camera = Camera::make(scene.camera);
    if (!camera) return camera.error();
    std::unique_ptr<World> world(new World(*camera, Footprint(scene.camera, settings.width > 0 ? settings.width : scene.film.width,
                                                              settings.height > 0 ? settings.height : scene.film.height)));

    if (scene.camera.end) world->camera_motion_.emplace(scene.camera.world_from_camera, *scene.camera.end);
    world->has_backdrops_ = render::has_backdrops(scene);
    if (has_motion(scene)) {
        world->shutter_open_ = static_cast<float>(scene.shutter.open);
        world->shutter_close_ = static_cast<float>(scene.shutter.close);
    }
    world->origin_ = scene.origin;
    Result<Textures> textures = Textures::build(scene, settings.cache_bytes, world->library_);
    if (!textures) return textures.error();
    world->textures_ = std::move(*textures);
    Result<std::unique_ptr<Geometry>> built = Geometry::build(scene, simd, &world->opacity_);
    if (!built) return built.error();
    world->geometry_ = std::move(*built);
    const Geometry& geometry = *world->geometry_;
    for (const MaterialDescription& d : scene.materials) {
        world->materials_.emplace_back(d, world->textures_, world->library_);
        world->has_dispersion_ |= world->materials_.back().disperses();
    }
    for (std::uint32_t i = 0; i < scene.media.size(); ++i) {
        world->media_.push_back(make_medium(scene.media, i, world->library_));
        const float depth = world->media_.back()->deepest_cell(world->library_);
        if (!(depth <= kDeepestCell))
            return refused(
                scene, scene.media[i],
                fmt::format("a cell of its grid is {:.2g} mean free paths wide, more than {:.0f}; lower its scale or its "
                            "density",
                            depth, kDeepestCell));
    }
    if (world->has_media()) world->medium_at_infinity_ = world->find_medium_at_infinity();

    // The disks of infinite lights also cover the camera, so that light can fall on its lens, and the outermost medium.
    float radius = geometry.radius();
    if (world->medium_at_infinity_ != kNone) {
        const std::optional<Box> box = world->medium(world->medium_at_infinity_).box();
        const double reach = box ? box->reach(Vec3d(geometry.center())) : 0;
        if (reach > kFarthest)
            return refused(
                scene, scene.media[world->medium_at_infinity_],
                fmt::format("reaches {:.2g} m from the centre of the shapes, more than {:.0g}; make it smaller", reach, kFarthest));
        radius = std::max(radius, static_cast<float>(reach) * (1 + 1e-3f));
    }
    for (const float time : {0.0f, 1.0f}) {
        const Camera camera_then = world->camera_at(time).value_or(world->camera_);
        radius = std::max(radius, length(camera_then.center() - geometry.center()) + 1e-3f * geometry.radius());
    }
    const SceneBall ball{geometry.center(), std::max(radius, 1e-6f)};
    world->lights_ = std::make_unique<LightSet>(scene, geometry, world->textures_, ball, world->library_);
    const bool glows =
        std::any_of(world->media_.begin(), world->media_.end(), [](const auto& medium) { return medium->is_emissive(); });
    if (world->lights_->size() == 0 && !glows)
        return Error{ErrorCode::kOutOfRange, "the scene has no light, so every picture would be black"};
    return world;
}

std::optional<Camera> World::camera_at(float time) const {
    if (!camera_motion_) return std::nullopt;
    return camera_.moved_to(camera_motion_->at(static_cast<double>(time)));
}

Bsdf World::textured_bsdf(SurfaceHit hit, TexturePoint& point, std::uint32_t kept) const {
    const SurfaceCoordinates coordinates = geometry_->coordinates(hit);
    fill_in(hit, coordinates, footprint_, point);
    hit.mirrored = dot(cross(hit.ns, coordinates.tangent), coordinates.bitangent) < 0;
    if (hit.ribbon) hit.across = (hit.mirrored ? -1.0f : 1.0f) * (2 * coordinates.uv.y - 1);
    const Material* material = &materials_[hit.material];
    const SampledSpectrum* weight = nullptr;
    for (std::uint32_t depth = 0; material->is_mixture(); ++depth) material = &materials_[material->chosen(point, depth, weight)];
    SurfaceHit coat = hit;
    material->coat_relief().tilt(point, coordinates, coat);
    material->relief().tilt(point, coordinates, hit);
    Bsdf bsdf = material->bsdf(hit, point, kept);
    bsdf.lay_coat(coat.ns);
    if (weight != nullptr) bsdf.weigh(*weight);
    return bsdf;
}

// What the first surfaces that are met from outside have on that side: preferably a medium that light comes through. If they say
// nothing, for their sides are equal: where a straight line from the camera, through all interfaces, ends.
std::uint32_t World::find_medium_at_infinity() const {
    constexpr int kLines = 4096;
    const SceneBall ball{geometry_->center(), 1.001f * geometry_->radius()};
    std::optional<std::uint32_t> endless;
    Random random(0);
    for (int i = 0; i < kLines && ball.radius > 0; ++i) {
        const Uniform u = random(), v = random(), x = random(), y = random();
        const LightRay line = ball.sample_ray(sample_sphere(u, v), 1, x, y);
        const std::optional<std::uint32_t> outside = geometry_->trace({line.at.p, line.d}, Stop::kFirstSolid).medium_before(line.d);
        if (outside && !is_endless(*outside)) return *outside;
        if (outside) endless = outside;
    }
    if (endless) return *endless;
    const Ray ray{camera_.center(), camera_.axis()};
    const Line line = geometry_->trace(ray, Stop::kNothing);
    return line.crossings.empty() ? camera_.medium() : line.crossings.back().entered;
}

bool World::connect(const Interaction& from, const Interaction& to, std::uint32_t medium, SampleState& sample,
                    SampledSpectrum& value, LineOfSight& line, bool seen) const {
    return connect(spawn_ray(from, to).at_time(sample.time, seen), length(to.p - from.p), medium, sample, value, line);
}

bool World::connect_infinite(const Interaction& from, const Vec3f& w, std::uint32_t medium, SampleState& sample,
                             SampledSpectrum& value, LineOfSight& line) const {
    return connect(spawn_ray(from, w).at_time(sample.time), kFar, medium, sample, value, line);
}

bool World::connect(const Ray& ray, float length, std::uint32_t medium, SampleState& sample, SampledSpectrum& value,
                    LineOfSight& line) const {
    ++sample.shadow_rays;
    const Line sight = geometry_->trace(ray, Stop::kAnySolid);
    if (sight.passed == 0) return false;
    if (sight.passed < 1) value *= sight.passed;
    if (medium == kNone && sight.crossings.empty()) return true;  // no medium on the way
    March march(sight, ray, length, medium);
    do {
        const Segment& segment = march.segment();
        if (segment.medium == kNone) {
            line.add(segment, 1, segment.length);
        } else {
            const MediumStep step = media_[segment.medium]->multiply_transmittance(segment, sample, value);
            line.add(segment, step.transmittance, step.column);
        }
    } while (march.next());
    return true;
}

}  // namespace latent::render
