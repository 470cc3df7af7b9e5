// render/light/sphere_light.h: a whole sphere of an area light. From outside, the cone that it fills is drawn from; from within,
// its area.
#pragma once

#include "render/light/area_emission.h"

namespace latent::render {

class SphereLight : public AreaEmission {
 public:
    SphereLight(const Emitter& emitter, const AreaEmission& area)
        : AreaEmission(area), center_(emitter.p), radius_(emitter.radius), inward_(emitter.inward) {}

    LightBounds bounds() const { return LightBounds::from_ball(Vec3d(center_), static_cast<double>(radius_)); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f& from, const LightSampleContext& context, const LightHit& hit) const;
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;

 private:
    // The squared distance of the centre; whether the sphere is seen as a cone from there.
    bool is_outside(float d2) const { return d2 > radius_ * radius_ * 1.0002f; }
    Interaction at(const Vec3f& outwards) const;

    Vec3f center_;
    float radius_;
    bool inward_;  // ng points to the centre
};

}  // namespace latent::render
