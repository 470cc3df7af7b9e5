// render/geometry/geometry.h: where rays meet surfaces. Embree underneath; spheres, disks and curved patches are solved in
// double.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/geometry/spawn_ray.h"
#include "render/math/vec.h"
#include "render/scene/among_vertices.h"
#include "render/scene/description.h"

namespace latent::render {

// Which primitive a ray hit, and where: numbers of Geometry's own.
struct PrimitivePoint {
    std::uint32_t instance, shape, primitive;
    Vec2f uv;        // of the primitive
    float time = 0;  // Ray's
};

// Everything about the surface at a hit; nothing depends on the side that the ray came from.
struct SurfaceHit {
    Vec3f p;
    float error;             // bound on the distance of each coordinate of p from the true surface
    float error_per_length;  // Interaction's
    float t;
    Vec3f ng;    // geometric normal, unit: outside is where it points (pbrt's orientation rules, ReverseOrientation included)
    Vec3f ns;    // shading normal, unit, in the hemisphere of ng
    Vec3f dpdu;  // never parallel to ng, of any length: orients anisotropic materials
    std::uint32_t material;                       // index into SceneDescription::materials; kNone: interface
    std::uint32_t emitter;                        // index into Geometry::emitters(), or kNone
    std::uint32_t inside_medium, outside_medium;  // equal: crossing changes nothing, the ray's medium goes on
    bool ribbon;                                  // ShapeDescription::ribbon
    float across;                                 // of it, if it was asked for: -1 to 1 along ns x dpdu
    PrimitivePoint on;

    Interaction interaction() const { return {p, error, ng, error_per_length}; }
};

// How the coordinates (u, v) of a scene's textures run over the surface about a hit.
struct SurfaceCoordinates {
    Vec2f uv;
    Vec3f dpdu, dpdv;  // not parallel
    Vec3f dndu, dndv;  // of the shading normal, turned as SurfaceHit::ns
    AmongVertices vertices;
};

// A primitive that emits: one triangle, one whole sphere or another quadric (of a uniform scale). What it emits is render/light's
// concern.
enum class EmitterKind : std::uint8_t { kTriangle, kSphere, kQuadric };
struct Emitter {
    std::uint32_t area_light = kNone;  // index into SceneDescription::area_lights
    std::uint32_t shape = kNone;       // index into SceneDescription::shapes
    std::uint32_t primitive = 0;       // of the shape
    EmitterKind kind = EmitterKind::kTriangle;
    Vec3f p{}, e1{}, e2{};  // triangle: a vertex and the edges from it; sphere: its centre in p
    Vec3f n{};              // triangle: unit normal as SurfaceHit::ng
    float radius = 0;       // sphere
    bool inward = false;    // sphere: ng points to the centre
    double area = 0;
    bool is_half = false;  // triangle: of a flat patch, whose other half is as large
    std::uint32_t inside_medium = kNone, outside_medium = kNone;
};

// Whether the surface, as a plane at the hit, contains a point to within what is known of both.
inline bool contains(const SurfaceHit& hit, const Interaction& at) {
    const Vec3f to = at.p - hit.p;
    const float size = std::abs(hit.ng.x) + std::abs(hit.ng.y) + std::abs(hit.ng.z);
    return std::abs(dot(hit.ng, to)) <= (hit.error + at.error) * size + kRayError * length(to);
}

class Opacity;

// A surface of alpha a is met with probability a, which a hash of the place and of the ray's direction decides. So light passes it
// as it passes fine holes: straight on, as it is. In a scene with interfaces, a ray that meets a hole hits an interface there, but
// not in a tube.
class Geometry {
 public:
    // `simd` is an Embree isa name (render/program/simd.h chooses). `opacity` outlives the geometry; null: surfaces whose alpha is
    // a texture are whole. Errors: kUnsupported: what render/scene/check.h refuses; kOutOfRange: the scene does not fit into
    // memory.
    static Result<std::unique_ptr<Geometry>> build(const SceneDescription& scene, const std::string& simd,
                                                   const Opacity* opacity = nullptr);
    virtual ~Geometry() = default;
    // Such as "4.3.3": of Embree, which records depend on.
    static std::string embree_version();

    // A ray whose numbers are not finite, or beyond 10^18, meets nothing, and no light passes along it.
    virtual std::optional<SurfaceHit> intersect(const Ray& ray) const = 0;
    // The first surface that is whole, or an interface; `passed` is multiplied by the share of the light that passes what is there
    // in part, as in `passed` below, on its way and at that surface.
    virtual std::optional<SurfaceHit> intersect_whole(const Ray& ray, float& passed) const = 0;
    // The share of the light that passes all surfaces, over all decisions; none passes an interface.
    virtual float passed(const Ray& ray) const = 0;
    // The surfaces that contain a point, but not that of `except`, where a line along unit d meets them; as if they had no holes.
    // None, if no surface is an interface or bounds a medium.
    virtual std::vector<SurfaceHit> surfaces_at(const Interaction& at, const Vec3f& d, float time,
                                                const PrimitivePoint* except = nullptr) const = 0;
    // Turns a hit on a surface with holes into one on an interface, if a ray in direction d passes it there: as the hash decides
    // or, if `passed` is given, wherever it is there in part; then `passed` is multiplied by the share that passes.
    virtual void open_hole(SurfaceHit& hit, const Vec3f& d, float* passed) const = 0;
    // At a hit that `intersect` returned.
    virtual SurfaceCoordinates coordinates(const SurfaceHit& hit) const = 0;

    // Whether rays meet any; holes between media count.
    bool has_interfaces() const { return has_interfaces_; }
    const std::vector<Emitter>& emitters() const { return emitters_; }
    // A ball about everything.
    const Vec3f& center() const { return center_; }
    float radius() const { return radius_; }

 protected:
    std::vector<Emitter> emitters_;
    Vec3f center_;
    float radius_ = 0;
    bool has_interfaces_ = false;
};

}  // namespace latent::render
