// render/geometry/embree_geometry.h: Geometry on Embree 3. Meshes are Embree's triangles, everything else is user geometry solved
// in double.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "base/first_error.h"
#include "render/geometry/exact_shapes.h"
#include "render/geometry/geometry.h"

namespace latent::render {

// One shape as geometry; Embree's user data points to it.
struct PlacedShape {
    ShapeDescription shape;
    Affined from_world{};                 // quadrics
    std::uint32_t first_emitter = kNone;  // of its primitives
};

struct PlacedInstance {
    const std::vector<PlacedShape>* shapes;
    Affined world_from_object, object_from_world;
    float error_factor;  // error of a point per its size, from Embree's float transformation of the ray
};

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;

class EmbreeGeometry final : public Geometry {
 public:
    static Result<std::unique_ptr<EmbreeGeometry>> build(const SceneDescription& scene, const std::string& simd);
    std::optional<SurfaceHit> intersect(const Ray& ray) const override;
    bool occluded(const Ray& ray) const override;
    SurfaceCoordinates coordinates(const SurfaceHit& hit) const override;

 private:
    Status add_emitters();
    static void keep_fault(void* self, RTCError code, const char* message);
    SceneHandle new_scene(std::vector<PlacedShape>& shapes) const;  // not committed
    void find_bounds();

    FirstError fault_;  // of Embree, while building
    DeviceHandle device_;
    std::vector<PlacedShape> shapes_;                // of the world; geomID is the index
    std::vector<std::vector<PlacedShape>> objects_;  // geomID within an object is the index
    std::vector<SceneHandle> object_scenes_;
    std::vector<PlacedInstance> instances_;  // geomID of the world less the number of shapes
    SceneHandle scene_;
};

PatchCorners patch_corners(const MeshDescription& mesh, std::uint32_t primitive);

// The surface at a hit on `placed`, in the space of its vertices: `uv` are Embree's of a triangle, or the patch's; `p` is near the
// point of a quadric.
SurfaceHit surface_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p);
// The same seen from the world.
SurfaceHit to_world(const SurfaceHit& hit, const PlacedInstance& instance);

// Texture coordinates there, in the space of the vertices; `ns` is in the hemisphere of the shading normal.
SurfaceCoordinates coordinates_at(const PlacedShape& placed, std::uint32_t primitive, Vec2f uv, const Vec3d& p, const Vec3f& ns);

}  // namespace latent::render
