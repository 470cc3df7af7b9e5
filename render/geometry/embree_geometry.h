// render/geometry/embree_geometry.h: Geometry on Embree.
#pragma once

#include <memory>
#include <vector>

#include "base/first_error.h"
#include "render/geometry/embree.h"
#include "render/geometry/embree_motion.h"
#include "render/geometry/geometry.h"
#include "render/geometry/placed_shape.h"

namespace latent::render {

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;

struct TraceContext;

class EmbreeGeometry final : public Geometry {
 public:
    static Result<std::unique_ptr<EmbreeGeometry>> build(const SceneDescription& scene, const std::string& simd,
                                                         const Opacity* opacity);
    Line trace(const Ray& ray, Stop stop) const override;
    SurfaceCoordinates coordinates(const SurfaceHit& hit) const override;

 private:
    void add_media(TraceContext& context, const Ray& ray, Line& line) const;
    SurfaceHit surface_on(const PrimitivePoint& on, const Ray& ray, float t) const;
    static void keep_fault(void* self, RTCError code, const char* message);
    SceneHandle new_scene(std::vector<PlacedShape>& shapes) const;  // not committed
    // All of them; those that move come last.
    void add_instances(const SceneDescription& scene);
    void find_interfaces();
    void find_bounds();

    FirstError fault_;  // what went wrong in Embree while building
    DeviceHandle device_;
    PlacedWorld world_;  // Embree's geomIDs are the indices of shapes in it
    std::vector<SceneHandle> object_scenes_;
    std::vector<MovingGeometry> moving_;  // Embree points to them
    SceneHandle scene_;
    bool has_interfaces_ = false;  // whether light passes from medium to medium somewhere, also through a hole
};

}  // namespace latent::render
