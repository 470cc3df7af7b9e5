// render/light/point_light.h: a point that shines alike in all directions.
#pragma once

#include "render/light/light_type.h"
#include "render/scene/description.h"

namespace latent::render {

class PointLight {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = true;
    PointLight(const LightDescription& light, std::uint32_t spectrum);

    const PointSource& source() const { return source_; }
    const Emission& emission() const { return emission_; }
    LightBounds bounds() const { return source_.bounds(); }
    double extent() const { return 4 * std::numbers::pi; }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit&) const { return 0; }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return 1; }
    float pdf_direction(const Vec3f&, const Vec3f&) const { return kInv4Pi; }
    bool multiply_emission(const EmissionPoint&, const Vec3f&, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        return true;
    }

 private:
    PointSource source_;
    Emission emission_;
    std::uint32_t medium_;
};

}  // namespace latent::render
