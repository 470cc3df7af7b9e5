#include "render/geometry/embree_geometry.h"

#include <fmt/format.h>

#include "render/geometry/coordinates.h"
#include "render/geometry/emitters.h"
#include "render/geometry/surface.h"
#include "render/scene/bounds.h"

namespace latent::render {

namespace {

// The box of a primitive of user geometry, in floats that contain it.
void bounds_of(const RTCBoundsFunctionArguments* args) {
    const PlacedShape& placed = *static_cast<const PlacedShape*>(args->geometryUserPtr);
    const ShapeDescription& shape = placed.shape;
    Box box;
    if (shape.kind == ShapeKind::kBilinear) {
        for (const Vec3d& c : patch_corners(*shape.mesh, args->primID)) box.add(c);
    } else {
        box = quadric_box(shape);
    }
    const auto down = [](double x) { return std::nextafter(static_cast<float>(x), -kInfinity); };
    const auto up = [](double x) { return std::nextafter(static_cast<float>(x), kInfinity); };
    *args->bounds_o = {down(box.low.x), down(box.low.y), down(box.low.z), 0, up(box.high.x), up(box.high.y), up(box.high.z), 0};
}

std::optional<ExactHit> intersect_exact(const PlacedShape& placed, std::uint32_t primitive, const RTCRay& ray) {
    const ShapeDescription& shape = placed.shape;
    const Vec3d o(ray.org_x, ray.org_y, ray.org_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
    if (shape.kind == ShapeKind::kBilinear)
        return intersect_patch(o, d, patch_corners(*shape.mesh, primitive), ray.tnear, ray.tfar);
    const Vec3d local_o = placed.from_world.point(o), local_d = placed.from_world.vector(d);
    if (shape.kind == ShapeKind::kSphere) return intersect_sphere(local_o, local_d, shape.radius, ray.tnear, ray.tfar);
    return intersect_disk(local_o, local_d, shape.height, shape.inner_radius, shape.radius, ray.tnear, ray.tfar);
}

void intersect_user(const RTCIntersectFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;  // only single rays are ever traced
    RTCRayHit& rayhit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const std::optional<ExactHit> hit =
        intersect_exact(*static_cast<const PlacedShape*>(args->geometryUserPtr), args->primID, rayhit.ray);
    if (!hit) return;
    rayhit.ray.tfar = static_cast<float>(hit->t);
    rayhit.hit.u = static_cast<float>(hit->u);
    rayhit.hit.v = static_cast<float>(hit->v);
    rayhit.hit.primID = args->primID;
    rayhit.hit.geomID = args->geomID;
    rayhit.hit.instID[0] = args->context->instID[0];
}

void occluded_user(const RTCOccludedFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    RTCRay& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (intersect_exact(*static_cast<const PlacedShape*>(args->geometryUserPtr), args->primID, ray)) ray.tfar = -kInfinity;
}

RTCGeometry new_mesh(RTCDevice device, const MeshDescription& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    if (p != nullptr) {
        for (const Vec3f& v : mesh.positions) *p++ = v.x, *p++ = v.y, *p++ = v.z;
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0,
                               3 * sizeof(std::uint32_t), mesh.indices.size() / 3);
    return geometry;
}

RTCGeometry new_user_geometry(RTCDevice device, PlacedShape& placed) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    const bool patches = placed.shape.kind == ShapeKind::kBilinear;
    rtcSetGeometryUserPrimitiveCount(geometry, patches ? static_cast<unsigned>(placed.shape.mesh->indices.size() / 4) : 1);
    rtcSetGeometryUserData(geometry, &placed);
    rtcSetGeometryBoundsFunction(geometry, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_user);
    rtcSetGeometryOccludedFunction(geometry, occluded_user);
    return geometry;
}

PlacedShape place(const ShapeDescription& shape) { return {.shape = shape, .from_world = shape.to_world.inverse().value()}; }

// Embree takes the ray into the object with a float matrix: 8 half ulps of what is added up there, seen from the world.
float instance_error_factor(const Affined& m) {
    const auto norm = [](const Affined& a) { return max_abs(a.x) + max_abs(a.y) + max_abs(a.z); };
    return static_cast<float>(0x1p-21 * norm(m) * norm(m.inverse().value()));
}

// Embree's own bound, 1.844e18, beyond which Debian's ends the program, as it does for what is not a number.
bool is_traceable(const Ray& ray) {
    const auto size = [](const Vec3f& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    return size(ray.o) + size(ray.d) < 1.8e18f;
}

RTCRay embree_ray(const Ray& ray) {
    return {ray.o.x, ray.o.y, ray.o.z, 0, ray.d.x, ray.d.y, ray.d.z, 0, ray.t_max, 0xFFFFFFFFu, 0, 0};
}

}  // namespace

Result<std::unique_ptr<Geometry>> Geometry::build(const SceneDescription& scene, const std::string& simd) {
    Result<std::unique_ptr<EmbreeGeometry>> geometry = EmbreeGeometry::build(scene, simd);
    if (!geometry) return geometry.error();
    return std::unique_ptr<Geometry>(std::move(*geometry));
}

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
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const bool mesh = shapes[i].shape.kind == ShapeKind::kTriangles;
        RTCGeometry geometry = mesh ? new_mesh(device_.get(), *shapes[i].shape.mesh) : new_user_geometry(device_.get(), shapes[i]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene.get(), geometry, static_cast<unsigned>(i));
        rtcReleaseGeometry(geometry);
    }
    return scene;
}

Result<std::unique_ptr<EmbreeGeometry>> EmbreeGeometry::build(const SceneDescription& description, const std::string& simd) {
    auto self = std::make_unique<EmbreeGeometry>();
    self->device_.reset(rtcNewDevice(fmt::format("isa={}", simd).c_str()));
    if (!self->device_ && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY)
        return Error{ErrorCode::kNoMemory, "out of memory"};
    if (!self->device_) return Error{ErrorCode::kUnsupported, fmt::format("Embree does not run with isa={}", simd)};
    rtcSetDeviceErrorFunction(self->device_.get(), keep_fault, self.get());
    for (const ShapeDescription& shape : description.shapes) self->shapes_.push_back(place(shape));
    Result<std::vector<Emitter>> emitters = find_emitters(self->shapes_);
    if (!emitters) return emitters.error();
    self->emitters_ = std::move(*emitters);

    for (const ObjectDescription& object : description.objects) {
        std::vector<PlacedShape>& shapes = self->objects_.emplace_back();
        for (const ShapeDescription& shape : object.shapes) shapes.push_back(place(shape));
    }
    for (std::vector<PlacedShape>& shapes : self->objects_) {
        self->object_scenes_.push_back(self->new_scene(shapes));
        rtcCommitScene(self->object_scenes_.back().get());
    }
    self->scene_ = self->new_scene(self->shapes_);
    for (const InstanceDescription& instance : description.instances) {
        const Affined& m = instance.world_from_object;
        const auto id = static_cast<unsigned>(self->shapes_.size() + self->instances_.size());
        self->instances_.push_back({&self->objects_[instance.object], m, m.inverse().value(), instance_error_factor(m)});
        RTCGeometry geometry = rtcNewGeometry(self->device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, self->object_scenes_[instance.object].get());
        const Affinef f(m);
        const float columns[12] = {f.x.x, f.x.y, f.x.z, f.y.x, f.y.y, f.y.z, f.z.x, f.z.y, f.z.z, f.t.x, f.t.y, f.t.z};
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(self->scene_.get(), geometry, id);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(self->scene_.get());
    if (self->fault_) {
        // Of a scene that it could not build, for want of threads say, Embree may still have tasks at work, and ends the program
        // when it is released: so all of it stays.
        return self.release()->fault_.status().error();
    }
    self->find_bounds();
    return self;
}

void EmbreeGeometry::find_bounds() {
    RTCBounds b;
    rtcGetSceneBounds(scene_.get(), &b);
    if (!(b.lower_x <= b.upper_x)) return;  // nothing there
    const Vec3f low(b.lower_x, b.lower_y, b.lower_z), high(b.upper_x, b.upper_y, b.upper_z);
    center_ = (low + high) * 0.5f;
    radius_ = length(high - low) * 0.5f * 1.00001f;
}

std::optional<SurfaceHit> EmbreeGeometry::intersect(const Ray& ray) const {
    if (!is_traceable(ray)) return std::nullopt;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit rayhit{embree_ray(ray), {}};
    rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &rayhit);
    const RTCHit& found = rayhit.hit;
    if (found.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    const Vec3d p = Vec3d(ray.o) + Vec3d(ray.d) * rayhit.ray.tfar;
    SurfaceHit hit;
    if (found.instID[0] == RTC_INVALID_GEOMETRY_ID) {
        hit = surface_at(shapes_[found.geomID], found.primID, {found.u, found.v}, p);
    } else {
        const PlacedInstance& instance = instances_[found.instID[0] - shapes_.size()];
        hit = to_world(
            surface_at((*instance.shapes)[found.geomID], found.primID, {found.u, found.v}, instance.object_from_world.point(p)),
            instance);
    }
    hit.t = rayhit.ray.tfar;
    hit.on = {found.instID[0], found.geomID, found.primID, {found.u, found.v}};
    return hit;
}

SurfaceCoordinates EmbreeGeometry::coordinates(const SurfaceHit& hit) const {
    const auto& [id, shape, primitive, uv] = hit.on;
    if (id == RTC_INVALID_GEOMETRY_ID) return coordinates_at(shapes_[shape], primitive, uv, Vec3d(hit.p), hit.ns);
    const PlacedInstance& instance = instances_[id - shapes_.size()];
    const Vec3f ns(instance.object_from_world.normal(Vec3d(hit.ns)));
    return to_world(coordinates_at((*instance.shapes)[shape], primitive, uv, instance.object_from_world.point(Vec3d(hit.p)), ns),
                    ns, instance);
}

bool EmbreeGeometry::occluded(const Ray& ray) const {
    if (!is_traceable(ray)) return true;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay shadow = embree_ray(ray);
    rtcOccluded1(scene_.get(), &context, &shadow);
    return shadow.tfar < 0;
}

}  // namespace latent::render
