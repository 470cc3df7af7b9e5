// render/light/spot_light.h: a point that shines into a cone, with a soft edge.
#pragma once

#include "render/light/light_type.h"
#include "render/scene/description.h"

namespace latent::render {

// Nothing beyond the outer cone; from the inner one on the intensity falls off by a smooth step of the cosine.
class SpotLight {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = true;
    SpotLight(const LightDescription& light, std::uint32_t spectrum);

    const PointSource& source() const { return source_; }
    const Emission& emission() const { return emission_; }
    LightBounds bounds() const {
        LightBounds out = source_.bounds();
        out.concentration = 1 / solid_angle_;
        return out;
    }
    double extent() const { return solid_angle_; }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit&) const { return 0; }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return 1; }
    float pdf_direction(const Vec3f&, const Vec3f& d) const {
        return one_minus_dot(d, source_.axis) > source_.outer ? 0 : pdf_of_cone(source_.outer);
    }
    bool multiply_emission(const EmissionPoint&, const Vec3f&, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        return true;
    }

 private:
    float profile(const Vec3f& d) const;

    PointSource source_;
    float inner_;  // 1 - cos of the cone in which the intensity is whole
    Emission emission_;
    std::uint32_t medium_;
    double solid_angle_;  // that would hold as much at full intensity: the smooth step counts half
};

}  // namespace latent::render
