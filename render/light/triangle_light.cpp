#include "render/light/triangle_light.h"

namespace latent::render {

Interaction TriangleLight::sample(Uniform u, Uniform v) const {
    const Vec2f b = sample_triangle(u, v);
    return {p_ + e1_ * b.x + e2_ * b.y, 4e-7f * (max_abs(p_) + max_abs(e1_) + max_abs(e2_)), n_};
}

bool TriangleLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform u, Uniform v, LightPoint& out) const {
    out.at = sample(u, v);
    out.falloff = 1;
    if (!out.look_from(from) || !area_.shines(n_, -out.wi)) return false;
    out.pdf_omega = area_.pdf_omega(from, out.at.p, n_);
    return out.pdf_omega > 0;
}

void TriangleLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    area_.sample_direction(sample(u, v), s, t, out);
}

}  // namespace latent::render
