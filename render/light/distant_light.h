// render/light/distant_light.h: parallel light from one direction.
#pragma once

#include "render/light/scene_ball.h"
#include "render/scene/description.h"

namespace latent::render {

class DistantLight {
 public:
    static constexpr bool kIsInfinite = true, kIsDelta = true;
    DistantLight(const LightDescription& light, std::uint32_t spectrum, const SceneBall& ball);

    const Emission& emission() const { return emission_; }
    double extent() const { return ball_.disk_area(); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit&) const { return 0; }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return ball_.pdf_position(); }
    float pdf_direction(const Vec3f&, const Vec3f&) const { return 0; }
    bool multiply_emission(const EmissionPoint&, const Vec3f&, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        return true;
    }

 private:
    Vec3f towards_;  // the light; unit
    Emission emission_;
    SceneBall ball_;
};

}  // namespace latent::render
