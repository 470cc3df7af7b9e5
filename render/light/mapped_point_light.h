// render/light/mapped_point_light.h: a point whose intensity and colour in each direction are those of a picture: all around it
// (goniometric), or of one that it projects.
#pragma once

#include "render/light/environment_map.h"
#include "render/light/light_type.h"
#include "render/light/projection_map.h"

namespace latent::render {

template <class Map>
class MappedPointLight {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = true;
    // The map must outlive the light.
    MappedPointLight(const LightDescription& light, const Map& map, std::uint32_t spectrum);

    const PointSource& source() const { return source_; }
    const Emission& emission() const { return emission_; }
    LightBounds bounds() const { return source_.bounds(); }
    double extent() const { return map_->luminous_intensity(); }
    bool sample_point(const Vec3f& from, const LightSampleContext&, Uniform, Uniform, LightPoint& out) const {
        return source_.sample_point(from, out);
    }
    float pdf_omega(const Vec3f&, const LightSampleContext&, const LightHit&) const { return 0; }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return 1; }
    float pdf_direction(const Vec3f&, const Vec3f& d) const { return map_->pdf_omega(d); }
    bool multiply_emission(const EmissionPoint&, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        if (!map_->multiply(d, spectra, value)) return false;
        emission_.multiply(spectra, value);
        return true;
    }

 private:
    PointSource source_;
    const Map* map_;
    Emission emission_;
    std::uint32_t medium_;
};

using GoniometricLight = MappedPointLight<EnvironmentMap>;
using ProjectionLight = MappedPointLight<ProjectionMap>;

}  // namespace latent::render
