// render/light/goniometric_light.h: a point whose intensity in each direction is that of an image.
#pragma once

#include "render/light/environment_map.h"
#include "render/light/light_type.h"

namespace latent::render {

class GoniometricLight {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = true;
    // The map must outlive the light.
    GoniometricLight(const LightDescription& light, const EnvironmentMap& map, std::uint32_t spectrum);

    const PointSource& source() const { return source_; }
    const Emission& emission() const { return emission_; }
    double extent() const { return 4 * std::numbers::pi * map_->mean_luminance(); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit&) const { return 0; }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return 1; }
    float pdf_direction(const Vec3f&, const Vec3f& d) const { return map_->pdf_omega(d); }
    bool multiply_emission(const EmissionPoint&, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        map_->multiply(d, spectra, value);
        return true;
    }

 private:
    PointSource source_;
    const EnvironmentMap* map_;
    Emission emission_;
    std::uint32_t medium_;
};

}  // namespace latent::render
