// render/light/triangle_light.h: a triangle of an area light.
#pragma once

#include "render/light/area_emission.h"

namespace latent::render {

class TriangleLight : public AreaEmission {
 public:
    TriangleLight(const Emitter& emitter, const AreaEmission& area)
        : AreaEmission(area), p_(emitter.p), e1_(emitter.e1), e2_(emitter.e2), n_(emitter.n) {}

    LightBounds bounds() const {
        const Vec3d corners[] = {Vec3d(p_), Vec3d(p_) + Vec3d(e1_), Vec3d(p_) + Vec3d(e2_)};
        Box box;
        for (const Vec3d& p : corners) box.add(p);
        LightBounds out = LightBounds::from_box(box);
        out.center = (corners[0] + corners[1] + corners[2]) / 3;
        out.radius = 0;
        for (const Vec3d& p : corners) out.radius = std::max(out.radius, length(p - out.center));
        return flat(out, Vec3d(n_));
    }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;

 private:
    Interaction at(const Vec2f& b) const;

    Vec3f p_, e1_, e2_, n_;
};

}  // namespace latent::render
