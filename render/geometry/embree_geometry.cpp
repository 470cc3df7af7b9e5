#include "render/geometry/embree_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "render/geometry/coordinates.h"
#include "render/geometry/embree_shapes.h"
#include "render/geometry/emitters.h"
#include "render/geometry/line.h"
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

// Embree says more about a fault here than rtcGetDeviceError does. Called by any thread.
void EmbreeGeometry::keep_fault(void* self, RTCError code, const char* message) {
    const Error error =
        code == RTC_ERROR_OUT_OF_MEMORY
            ? Error{ErrorCode::kNoMemory, "out of memory"}
            : Error{ErrorCode::kUnsupported, fmt::format("Embree cannot build this scene: {}", message ? message : "")};
    static_cast<EmbreeGeometry*>(self)->fault_.set(error);
}

SceneHandle EmbreeGeometry::new_scene(std::vector<PlacedShape>& shapes) const {
    SceneHandle scene(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
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
        // If a scene could not be built, for want of threads say, Embree may still have tasks at work on it, and ends the program
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
            // The object's place in the file: its shapes are no longer counted from there.
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
        has_interfaces_ = has_interfaces_ || (placed.parts_media() && (is_interface(placed.shape.material) || placed.has_holes()));
    });
    each([&](PlacedShape& placed) {
        placed.is_watched = has_interfaces_ || placed.has_holes() || placed.hollow || placed.shape.backdrop;
    });
}

Line EmbreeGeometry::trace(const Ray& ray, Stop stop) const {
    Line line;
    if (!is_traceable(ray.o, ray.d)) {
        if (stop == Stop::kAnySolid) line.passed = 0;
        return line;
    }
    if (stop == Stop::kNothing && !has_interfaces_) return line;
    TraceContext context{.embree = new_context(), .world = &world_, .stop = stop, .seen = ray.seen, .t_max = ray.t_max};
    if (stop == Stop::kFirstSolid) {
        if (has_interfaces_) context.behind = 0x1p-16f * radius_ / length(ray.d);
        RTCRayHit rayhit{embree_ray(ray), {}};
        rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree_intersect(scene_.get(), context.embree, rayhit);
        const RTCHit& found = rayhit.hit;
        if (found.geomID != RTC_INVALID_GEOMETRY_ID) {
            const float t = std::min(rayhit.ray.tfar, static_cast<float>(context.hit_t));
            line.hit = surface_on({found.instID[0], found.geomID, found.primID, {found.u, found.v}, ray.time}, ray, t);
        }
    } else {
        RTCRay shadow = embree_ray(ray);
        embree_occluded(scene_.get(), context.embree, shadow);
        line.passed = shadow.tfar < 0 ? 0 : context.passed;
    }
    if (!context.met.empty() && line.passed > 0) add_media(context, ray, line);
    if (line.hit && ray.may_start_on_surface && contains(*line.hit, {ray.o, 0, {}})) {
        // A lamp, a lens or a vertex in a medium may have been put on a surface, which then is not in the way.
        Ray rest = ray;
        rest.o = spawn_ray(line.hit->interaction(), ray.d).o;
        return trace(rest, stop);
    }
    return line;
}

void EmbreeGeometry::add_media(TraceContext& context, const Ray& ray, Line& line) const {
    std::erase_if(context.met, [&](const MetSurface& met) { return line.hit && met.t > line.hit->t + context.behind; });
    const auto order = [](const MetSurface& met) { return std::tuple(met.t, met.on.instance, met.on.shape, met.on.primitive); };
    std::ranges::sort(context.met, {}, order);
    std::vector<SurfaceHit> surfaces;
    surfaces.reserve(context.met.size());
    for (const MetSurface& met : context.met) {
        SurfaceHit surface = surface_on(met.on, ray, met.t);
        // On the edge of two primitives a ray may hit both: they are one surface.
        const auto is_same = [&](const SurfaceHit& other) {
            return met.on.instance == other.on.instance && met.on.shape == other.on.shape &&
                   leads_out(surface, ray.d) == leads_out(other, ray.d) && contains(other, surface.interaction());
        };
        if (std::ranges::any_of(surfaces, is_same)) continue;
        if (met.passed > 0) {
            surface.material = kNone;
            line.passed *= met.passed;
        }
        surfaces.push_back(surface);
    }
    render::add_media(std::move(surfaces), ray.d, line);
}

SurfaceHit EmbreeGeometry::surface_on(const PrimitivePoint& on, const Ray& ray, float t) const {
    const Vec3d p = Vec3d(ray.o) + Vec3d(ray.d) * t;
    std::optional<PlacedInstance> room;
    SurfaceHit hit = surface_at(world_, on, on.instance == kNone ? p : world_.instance(on, room).object_from_world.point(p));
    hit.t = t;
    return hit;
}

SurfaceCoordinates EmbreeGeometry::coordinates(const SurfaceHit& hit) const { return coordinates_at(world_, hit); }

}  // namespace latent::render
