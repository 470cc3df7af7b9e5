// render/geometry/geometry.h: where rays hit surfaces. Embree underneath; spheres, disks and curved patches are solved in
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
    Vec2f uv;        // coordinates on the primitive
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
    Vec3f dpdu;  // or where the mesh says that u runs; never parallel to ng, of any length: orients anisotropic materials
    std::uint32_t material;                       // index into SceneDescription::materials; kNone: interface
    std::uint32_t emitter;                        // index into Geometry::emitters(), or kNone
    std::uint32_t inside_medium, outside_medium;  // equal: the surface does not change the ray's medium
    bool ribbon, backdrop;                        // ShapeDescription's
    float across;                                 // where it lies across, if that was asked for: -1 to 1 along ns x dpdu
    bool mirrored = false;                        // if it was asked for: dp/dv lies against ns x dpdu
    PrimitivePoint on;

    Interaction interaction() const { return {p, error, ng, error_per_length}; }
};

// How the coordinates (u, v) of a scene's textures run over the surface about a hit.
struct SurfaceCoordinates {
    Vec2f uv;
    Vec3f dpdu, dpdv;          // not parallel
    Vec3f tangent, bitangent;  // these, or where the mesh says that u and v run
    Vec3f dndu, dndv;          // derivatives of the shading normal, turned as SurfaceHit::ns
    AmongVertices vertices;
};

// A primitive that emits: one triangle, one whole sphere or another quadric (of a uniform scale). What it emits is render/light's
// concern.
enum class EmitterKind : std::uint8_t { kTriangle, kSphere, kQuadric };
struct Emitter {
    std::uint32_t area_light = kNone;  // index into SceneDescription::area_lights
    std::uint32_t shape = kNone;       // index into SceneDescription::shapes
    std::uint32_t primitive = 0;       // its number in the shape
    EmitterKind kind = EmitterKind::kTriangle;
    Vec3f p{}, e1{}, e2{};  // triangle: a vertex and the edges from it; sphere: its centre in p
    Vec3f n{};              // triangle: unit normal as SurfaceHit::ng
    float radius = 0;       // sphere
    bool inward = false;    // sphere: ng points to the centre
    double area = 0;
    bool is_half = false;  // triangle: of a flat patch, whose other half is as large
    std::uint32_t inside_medium = kNone, outside_medium = kNone;
};

// The material of surfaces that scatter nothing: where media meet.
inline bool is_interface(std::uint32_t material) { return material == kNone; }

// Whether a line along d passes the surface from inside.
inline bool leads_out(const SurfaceHit& hit, const Vec3f& d) { return dot(d, hit.ng) > 0; }

// Whether the surface, as a plane at the hit, contains a point to within what is known of both.
inline bool contains(const SurfaceHit& hit, const Interaction& at) {
    const Vec3f to = at.p - hit.p;
    const float size = std::abs(hit.ng.x) + std::abs(hit.ng.y) + std::abs(hit.ng.z);
    return std::abs(dot(hit.ng, to)) <= (hit.error + at.error) * size + kRayError * length(to);
}

// Where a line ends.
enum class Stop : std::uint8_t {
    kFirstSolid,  // on the first surface that scatters; if that is there in part, a hash of place and direction decides
    kAnySolid,    // on any surface that scatters and is whole: for shadow rays
    kNothing,     // nowhere: surfaces that scatter are not met
};

// Where a line leaves one medium and enters another.
struct Crossing {
    float t;
    std::uint32_t left, entered;
};

// What a ray hits. Surfaces that lie on one another are met as one: a count of the media entered less those left does not depend
// on their order.
struct Line {
    std::vector<Crossing> crossings;  // before the hit, in order of t; interfaces, and holes between media
    std::optional<SurfaceHit> hit;    // kFirstSolid alone; its media are those before and behind all surfaces that lie on it
    float passed = 1;                 // kAnySolid alone: the share of the light that passes; 0: something whole is in the way

    // The medium that a ray along d begins in, if the first surface that it hits parts media.
    std::optional<std::uint32_t> medium_before(const Vec3f& d) const;
};

class Opacity;

// A surface of alpha a is met with probability a. Light passes it as it passes fine holes: straight on, as it is.
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
    virtual Line trace(const Ray& ray, Stop stop) const = 0;
    // At a hit of `trace`.
    virtual SurfaceCoordinates coordinates(const SurfaceHit& hit) const = 0;

    const std::vector<Emitter>& emitters() const { return emitters_; }
    // A ball about everything.
    const Vec3f& center() const { return center_; }
    float radius() const { return radius_; }

 protected:
    std::vector<Emitter> emitters_;
    Vec3f center_;
    float radius_ = 0;
};

}  // namespace latent::render
