// render/light/lights.h: the lights of a scene, one by one: what they send where, and how to draw points, directions and lights
// themselves. docs/rendering.md, "Lights".
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/bsdf/receiver.h"
#include "render/geometry/geometry.h"
#include "render/sampling/sampling.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"
#include "render/spectral/wavelength_density.h"

namespace latent::render {

class Environment;

// A triangle or sphere of an area light, a point, or a part of the sky. Emission is `scale` times a spectrum of the library (times
// colours, for an image): radiance, or intensity of points.
struct Light {
    enum class Kind : std::uint8_t { kTriangle, kSphere, kPoint, kSpot, kDistant, kConstant, kImage };
    Kind kind;
    std::uint32_t spectrum = 0;
    float scale = 1;
    bool two_sided = false;
    std::uint32_t inside_medium = kNone, outside_medium = kNone;  // on the two sides of an area light; points: outside
    Vec3f p;                                                      // triangle, sphere, point
    Vec3f e1, e2;                                                 // triangle
    Vec3f n;                                                      // triangle: normal; spot: axis; distant: towards the light
    float radius = 0;                                             // sphere
    bool inward = false;                                          // sphere: emits inwards
    float area = 0;
    float outer = 2, inner = 2;  // spot: 1 - cos of its cones; nothing beyond the outer, falls off from the inner
    const Environment* environment = nullptr;

    bool is_infinite() const { return kind >= Kind::kDistant; }
    // A point or one direction: nothing can hit it by chance.
    bool is_delta() const { return is_point() || kind == Kind::kDistant; }
    bool is_point() const { return kind == Kind::kPoint || kind == Kind::kSpot; }
    bool has_area() const { return kind <= Kind::kSphere; }
};

// A point of a light (or a direction of the sky), as seen from somewhere.
struct LightPoint {
    Anchor anchor;      // local lights
    Vec3f wi;           // unit, towards it
    float distance;     // kInfinity for the sky
    float pdf_omega;    // 1/sr at the point that looks; 1 for a delta light
    float falloff = 1;  // delta lights: 1/d^2, times the spot's profile
};

// A ray that a light emits.
struct LightRay {
    Anchor anchor;        // where it starts: on the light, or on a disk outside of the scene
    Vec3f d;              // unit
    float pdf_position;   // 1/m^2: on the light, or on the disk; 1 for a point
    float pdf_direction;  // 1/sr; 1 for a distant light
    float cosine;         // of d to the light's normal; 1 for the sky and for points
    float profile = 1;    // spot: its profile
    std::uint32_t medium;
};

class Lights {
 public:
    // The ball about `center` holds the scene and the camera.
    static Lights build(const SceneDescription& scene, const Geometry& geometry, const Vec3f& center, float radius,
                        SpectrumLibrary& library);
    ~Lights();
    Lights(Lights&&) noexcept;

    std::size_t size() const { return lights_.size(); }
    const Light& operator[](std::uint32_t i) const { return lights_[i]; }  // emitter i of the geometry is light i
    const std::vector<std::uint32_t>& infinite() const { return infinite_; }
    const std::vector<LightSpectrum>& spectra() const { return spectra_; }  // for the wavelength density

    // Lights are chosen by their power as the eye sees it (0.9 p_eye + 0.1 uniform, so that no light is never chosen); the sky has
    // half of the choices where there are local lights too.
    std::uint32_t choose(Uniform u) const { return choice_.sample(u); }
    float probability(std::uint32_t i) const { return choice_.probability(i); }

    // Draws a point of light i for `from`. False: nothing of it can be seen from there.
    bool sample_point(std::uint32_t i, const Vec3f& from, const Receiver& receiver, Uniform u, Uniform v, LightPoint& out) const;
    // Its density [1/sr at `from`] at a point of an area light (p, ng), or of the sky in direction wi. 0 for delta lights.
    float pdf_of_point(std::uint32_t i, const Vec3f& from, const Vec3f& p, const Vec3f& ng) const;
    float pdf_of_direction(std::uint32_t i, const Vec3f& wi, const Receiver& receiver) const;

    // Draws a ray; u, v for the position, s, t for the direction.
    void sample_ray(std::uint32_t i, Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    // Density of direction d [1/sr] of rays that leave a point of light i with normal ng; for the sky that of arriving from -d.
    float pdf_of_emission(std::uint32_t i, const Vec3f& ng, const Vec3f& d) const;
    float pdf_of_position(std::uint32_t i) const;  // 1/m^2: on an area light, or on the disk of the sky; 1 for points

    // value *= what light i sends in direction d (from the light): radiance at a point of an area light with normal ng, radiance
    // of the sky, intensity of a point (without its falloff or profile).
    void multiply_emission(std::uint32_t i, const Vec3f& ng, const Vec3f& d, SampledSpectra& spectra, Batch& value) const;
    float spot_profile(const Light& light, const Vec3f& d) const;

 private:
    Lights();

    std::vector<Light> lights_;
    std::vector<std::uint32_t> infinite_;
    std::vector<LightSpectrum> spectra_;
    std::vector<std::unique_ptr<Environment>> environments_;
    Choice choice_;
    Vec3f center_;
    float radius_ = 0;
};

}  // namespace latent::render
