// render/light/triangle_light.h: a triangle of an area light.
#pragma once

#include "render/light/area_emission.h"

namespace latent::render {

class TriangleLight {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = false;
    TriangleLight(const Emitter& emitter, const AreaEmission& area)
        : p_(emitter.p), e1_(emitter.e1), e2_(emitter.e2), n_(emitter.n), area_(area) {}

    const Emission& emission() const { return area_.emission(); }
    double extent() const { return area_.extent(); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f& from, const LightSampleContext&, const LightHit& hit) const {
        return area_.pdf_omega(from, hit.p, hit.ng);
    }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return area_.pdf_position(); }
    float pdf_direction(const Vec3f& ng, const Vec3f& d) const { return area_.pdf_direction(ng, d); }
    bool multiply_emission(const EmissionPoint& at, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        return area_.multiply_emission(at, d, spectra, value);
    }

 private:
    Interaction at(const Vec2f& b) const;

    Vec3f p_, e1_, e2_, n_;
    AreaEmission area_;
};

}  // namespace latent::render
