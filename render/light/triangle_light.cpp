#include "render/light/triangle_light.h"

namespace latent::render {

Interaction TriangleLight::at(const Vec2f& b) const {
    return {p_ + e1_ * b.x + e2_ * b.y, 4e-7f * (max_abs(p_) + max_abs(e1_) + max_abs(e2_)), n_};
}

bool TriangleLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform u, Uniform v, LightPoint& out) const {
    out.uv = sample_triangle(u, v);
    out.at = at(out.uv);
    out.falloff = 1;
    if (!out.look_from(from) || !shines(n_, -out.wi)) return false;
    out.pdf_omega = pdf_of_area(from, out.at.p, n_);
    return out.pdf_omega > 0;
}

void TriangleLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    out.uv = sample_triangle(u, v);
    sample_direction(at(out.uv), s, t, out);
}

}  // namespace latent::render
