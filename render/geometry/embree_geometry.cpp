#include "render/geometry/embree_geometry.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/geometry/coordinates.h"
#include "render/geometry/embree_shapes.h"
#include "render/geometry/emitters.h"
#include "render/geometry/holes.h"
#include "render/geometry/surface.h"
#include "render/scene/hair.h"
#include "render/scene/quadric.h"

namespace latent::render {

namespace {

PlacedShape place(const ShapeDescription& shape, const std::vector<MaterialDescription>& materials) {
    PlacedShape placed{.shape = shape, .from_world = shape.to_world.inverse().value()};
    placed.hollow = !shape.ribbon && is_hair(materials, shape.material);
    placed.part.phi_max = phi_max(shape);
    const bool ball = shape.kind == ShapeKind::kSphere, tube = shape.kind == ShapeKind::kCylinder;
    if (tube || (ball && shape.z_min > -shape.radius)) placed.part.z_min = shape.z_min;
    if (tube || (ball && shape.z_max < shape.radius)) placed.part.z_max = shape.z_max;
    return placed;
}

RTCRay embree_ray(const Ray& ray) {
    return {ray.o.x, ray.o.y, ray.o.z, 0, ray.d.x, ray.d.y, ray.d.z, ray.time, ray.t_max, 0xFFFFFFFFu, 0, 0};
}

}  // namespace

Result<std::unique_ptr<Geometry>> Geometry::build(const SceneDescription& scene, const std::string& simd, const Opacity* opacity) {
    Result<std::unique_ptr<EmbreeGeometry>> geometry = EmbreeGeometry::build(scene, simd, opacity);
    if (!geometry) return geometry.error();
    return std::unique_ptr<Geometry>(std::move(*geometry));
}

std::string Geometry::embree_version() { return RTC_VERSION_STRING; }

// Of what went wrong, Embree says more here than by rtcGetDeviceError. Any thread.
void EmbreeGeometry::keep_fault(void* self, RTCError code, const char* message) {
    const Error error =
        code == RTC_ERROR_OUT_OF_MEMORY
            ? Error{ErrorCode::kNoMemory, "out of memory"}
            : Error{ErrorCode::kUnsupported, fmt::format("Embree cannot build this scene: {}", message ? message : "")};
    static_cast<EmbreeGeometry*>(self)->fault_.set(error);
}

SceneHandle EmbreeGeometry::new_scene(std::vector<PlacedShape>& shapes) const {
    SceneHandle scene(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene.get(), bounds_media_ ? RTC_SCENE_FLAG_ROBUST | kRayFilter : RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (shapes[i].is_invisible()) continue;
        RTCGeometry geometry = new_geometry(device_.get(), shapes[i]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene.get(), geometry, static_cast<unsigned>(i));
        rtcReleaseGeometry(geometry);
    }
    return scene;
}

Result<std::unique_ptr<EmbreeGeometry>> EmbreeGeometry::build(const SceneDescription& description, const std::string& simd,
                                                              const Opacity* opacity) {
    auto self = std::make_unique<EmbreeGeometry>();
    self->world_.opacity = opacity;
    self->device_.reset(rtcNewDevice(fmt::format("isa={}", simd).c_str()));
    if (!self->device_ && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY)
        return Error{ErrorCode::kNoMemory, "out of memory"};
    if (!self->device_) return Error{ErrorCode::kUnsupported, fmt::format("Embree does not run with isa={}", simd)};
    rtcSetDeviceErrorFunction(self->device_.get(), keep_fault, self.get());
    for (const ShapeDescription& shape : description.shapes) self->world_.shapes.push_back(place(shape, description.materials));
    Result<std::vector<Emitter>> emitters = find_emitters(self->world_.shapes);
    if (!emitters) return emitters.error();
    self->emitters_ = std::move(*emitters);

    for (const ObjectDescription& object : description.objects) {
        std::vector<PlacedShape>& shapes = self->world_.objects.emplace_back();
        for (const ShapeDescription& shape : object.shapes) shapes.push_back(place(shape, description.materials));
    }
    self->find_interfaces();
    for (std::vector<PlacedShape>& shapes : self->world_.objects) {
        self->object_scenes_.push_back(self->new_scene(shapes));
        rtcCommitScene(self->object_scenes_.back().get());
    }
    self->scene_ = self->new_scene(self->world_.shapes);
    self->add_instances(description);
    rtcCommitScene(self->scene_.get());
    if (self->fault_) {
        // Of a scene that it could not build, for want of threads say, Embree may still have tasks at work, and ends the program
        // when it is released: so all of it stays.
        return self.release()->fault_.status().error();
    }
    self->find_bounds();
    return self;
}

void EmbreeGeometry::add_instances(const SceneDescription& description) {
    const auto attach = [&](RTCGeometry geometry, std::size_t number) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_.get(), geometry, static_cast<unsigned>(world_.shapes.size() + number));
        rtcReleaseGeometry(geometry);
    };
    for (const InstanceDescription& instance : description.instances) {
        const std::vector<PlacedShape>& shapes = world_.objects[instance.object];
        const Affined& m = instance.world_from_object;
        if (instance.end) {
            // Of its own place in the file, which the object's shapes are no longer counted from.
            const Vec3d center = -description.objects[instance.object].origin;
            world_.moving.push_back({&shapes, Motion(m, *instance.end, center)});
            moving_.push_back({object_scenes_[instance.object].get()});
            continue;
        }
        world_.instances.emplace_back(shapes, m);
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, object_scenes_[instance.object].get());
        const Affinef f(m);
        const float columns[12] = {f.x.x, f.x.y, f.x.z, f.y.x, f.y.y, f.y.z, f.z.x, f.z.y, f.z.z, f.t.x, f.t.y, f.t.z};
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        attach(geometry, world_.instances.size() - 1);
    }
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        moving_[i].instance = &world_.moving[i];
        attach(new_geometry(device_.get(), moving_[i]), world_.instances.size() + i);
    }
}

void EmbreeGeometry::find_bounds() {
    RTCBounds b;
    rtcGetSceneBounds(scene_.get(), &b);
    if (!(b.lower_x <= b.upper_x)) return;  // nothing there
    const Vec3f low(b.lower_x, b.lower_y, b.lower_z), high(b.upper_x, b.upper_y, b.upper_z);
    center_ = (low + high) * 0.5f;
    radius_ = length(high - low) * 0.5f * 1.00001f;
}

// Before Embree's scenes are made, which depend on it.
void EmbreeGeometry::find_interfaces() {
    const auto each = [&](const auto& f) {
        for (PlacedShape& placed : world_.shapes) f(placed);
        for (std::vector<PlacedShape>& shapes : world_.objects) std::ranges::for_each(shapes, f);
    };
    each([&](const PlacedShape& placed) {
        const bool is_interface = placed.shape.material == kNone;
        has_interfaces_ = has_interfaces_ || is_interface || (placed.has_holes() && placed.parts_media());
        bounds_media_ = bounds_media_ || is_interface || placed.parts_media();
    });
    each([&](PlacedShape& placed) {
        // Embree may find a crossing of a tube more than once, which is noticed only while rays pass its holes (settle_hit).
        const bool can_pass = placed.shape.kind == ShapeKind::kTube && !placed.parts_media() && placed.shape.material != kNone;
        placed.meets_holes = has_interfaces_ && placed.has_holes() && !can_pass;
    });
}

std::optional<SurfaceHit> EmbreeGeometry::intersect(const Ray& ray) const {
    std::optional<SurfaceHit> hit = intersect_any(ray, nullptr);
    if (hit) open_hole(*hit, ray.d, nullptr);
    return hit;
}

std::optional<SurfaceHit> EmbreeGeometry::intersect_whole(const Ray& ray, float& passed) const {
    std::vector<PassedSurface> each;
    std::optional<SurfaceHit> hit = intersect_any(ray, &each);
    for (const PassedSurface& surface : each) {
        if (!hit || surface.t < hit->t) passed *= surface.share;
    }
    if (hit) open_hole(*hit, ray.d, &passed);
    return hit;
}

void EmbreeGeometry::open_hole(SurfaceHit& hit, const Vec3f& d, float* passed) const {
    if (!world_.shape(hit.on).meets_holes || hit.material == kNone) return;
    const float opacity = opacity_at(world_, hit);
    if (passed == nullptr ? !is_hole_at(hit.on, hit.p, d, opacity) : opacity >= 1) return;
    if (passed != nullptr) *passed *= 1 - std::max(0.0f, opacity);
    hit.material = hit.emitter = kNone;
}

std::optional<SurfaceHit> EmbreeGeometry::intersect_any(const Ray& ray, std::vector<PassedSurface>* passed) const {
    if (!is_traceable(ray.o, ray.d)) return std::nullopt;
    TraceContext context{.embree = new_context(), .world = &world_, .t_max = ray.t_max, .passed_each = passed};
    RTCRayHit rayhit{embree_ray(ray), {}};
    rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(scene_.get(), context.embree, rayhit);
    const RTCHit& found = rayhit.hit;
    if (found.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    return surface_on({found.instID[0], found.geomID, found.primID, {found.u, found.v}, ray.time}, ray, rayhit.ray.tfar);
}

SurfaceHit EmbreeGeometry::surface_on(const PrimitivePoint& on, const Ray& ray, float t) const {
    const Vec3d p = Vec3d(ray.o) + Vec3d(ray.d) * t;
    std::optional<PlacedInstance> room;
    SurfaceHit hit = surface_at(world_, on, on.instance == kNone ? p : world_.instance(on, room).object_from_world.point(p));
    hit.t = t;
    return hit;
}

std::vector<SurfaceHit> EmbreeGeometry::surfaces_at(const Interaction& at, const Vec3f& d, float time,
                                                    const PrimitivePoint* except) const {
    std::vector<SurfaceHit> surfaces;
    // From a little before the point to a little behind: from the point itself a ray meets a surface or not, as it rounds.
    const float reach = 0x1p-18f * radius_;
    const Ray around{at.p - d * reach, d, 2 * reach, time};
    if (!bounds_media_ || !(reach > 0) || !is_traceable(around.o, around.d)) return surfaces;
    std::vector<MetSurface> met;
    TraceContext context{.embree = new_context(), .world = &world_, .t_max = around.t_max, .met = &met, .met_but = except};
    RTCRay shadow = embree_ray(around);
    embree_occluded(scene_.get(), context.embree, shadow, context.filter());
    for (const MetSurface& surface : met) {
        const SurfaceHit hit = surface_on(surface.on, around, surface.t);
        if (contains(hit, at)) surfaces.push_back(hit);
    }
    return surfaces;
}

SurfaceCoordinates EmbreeGeometry::coordinates(const SurfaceHit& hit) const { return coordinates_at(world_, hit); }

float EmbreeGeometry::passed(const Ray& ray) const {
    if (!is_traceable(ray.o, ray.d)) return 0;
    float passed = 1;
    TraceContext context{.embree = new_context(), .world = &world_, .t_max = ray.t_max, .passed = &passed};
    RTCRay shadow = embree_ray(ray);
    embree_occluded(scene_.get(), context.embree, shadow, context.filter());
    return shadow.tfar < 0 ? 0 : passed;
}

}  // namespace latent::render
