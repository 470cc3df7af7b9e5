// render/light/image_infinite_light.h: light from infinity whose colour in each direction is that of an image.
#pragma once

#include "render/light/environment_map.h"
#include "render/light/scene_ball.h"

namespace latent::render {

class ImageInfiniteLight {
 public:
    static constexpr bool kIsInfinite = true, kIsDelta = false;
    // The map must outlive the light.
    ImageInfiniteLight(const LightDescription& light, const EnvironmentMap& map, std::uint32_t spectrum, const SceneBall& ball);

    const Emission& emission() const { return emission_; }
    // As of a uniform infinite light.
    double extent() const { return std::numbers::pi * ball_.disk_area() * map_->mean_luminance(); }
    double contrast() const { return map_->contrast(); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit& hit) const { return map_->pdf_omega(hit.wi); }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return ball_.pdf_position(); }
    float pdf_direction(const Vec3f&, const Vec3f& d) const { return map_->pdf_omega(-d); }
    bool multiply_emission(const EmissionPoint&, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        emission_.multiply(spectra, value);
        map_->multiply(-d, spectra, value);
        return true;
    }

 private:
    const EnvironmentMap* map_;
    Emission emission_;
    SceneBall ball_;
};

}  // namespace latent::render
