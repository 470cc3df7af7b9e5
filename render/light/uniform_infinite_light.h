// render/light/uniform_infinite_light.h: the same radiance from all directions, from infinity.
#pragma once

#include "render/light/scene_ball.h"
#include "render/scene/description.h"

namespace latent::render {

// Directions are drawn by the cosine to the surface that they light; evenly from the sphere in a medium.
class UniformInfiniteLight {
 public:
    static constexpr bool kIsInfinite = true, kIsDelta = false;
    UniformInfiniteLight(const LightDescription& light, std::uint32_t spectrum, const SceneBall& ball);

    const Emission& emission() const { return emission_; }
    // 4 pi L crosses each square metre of the scene, and a surface receives pi L at most.
    double extent() const { return std::numbers::pi * ball_.disk_area(); }
    double contrast() const { return 1; }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f& from, const LightSampleContext& context, const LightHit& hit) const;
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return ball_.pdf_position(); }
    float pdf_direction(const Vec3f&, const Vec3f&) const { return kInv4Pi; }
    bool multiply_emission(const EmissionPoint&, const Vec3f&, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        return true;
    }

 private:
    Emission emission_;
    SceneBall ball_;
};

}  // namespace latent::render
