#include "render/light/quadric_light.h"

#include "render/scene/quadric.h"

namespace latent::render {

Interaction QuadricLight::sample(Uniform u, Uniform v) const {
    const QuadricPoint local = quadric_point(*shape_, u, v);
    const Vec3f p(shape_->to_world.point(local.p));
    const Vec3d n = shape_->to_world.normal(local.n);
    return {p, 4e-7f * max_abs(p), Vec3f(n * ((shape_->flip_normal ? -1 : 1) / length(n)))};
}

LightBounds QuadricLight::bounds() const {
    const LightBounds all_about = LightBounds::from_box(quadric_box(*shape_));
    if (shape_->kind != ShapeKind::kDisk) return all_about;
    return flat(all_about, normalize(shape_->to_world.normal({0, 0, shape_->flip_normal ? -1.0 : 1.0})));
}

bool QuadricLight::sample_point(const Vec3f& from, const LightSampleContext&, Uniform u, Uniform v, LightPoint& out) const {
    out.at = sample(u, v);
    out.falloff = 1;
    if (!out.look_from(from) || !shines(out.at.ng, -out.wi)) return false;
    out.pdf_omega = pdf_of_area(from, out.at.p, out.at.ng);
    return out.pdf_omega > 0;
}

void QuadricLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    sample_direction(sample(u, v), s, t, out);
}

}  // namespace latent::render
