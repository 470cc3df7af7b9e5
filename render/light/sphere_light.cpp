#include "render/light/sphere_light.h"

namespace latent::render {
namespace {

// 1 - cos of an angle below a right one, given its squared sine.
float one_minus_cos(float sin2) { return sin2 / (1 + std::sqrt(std::max(0.0f, 1 - sin2))); }

}  // namespace

Interaction SphereLight::at(const Vec3f& outwards) const {
    return {center_ + outwards * radius_, 4e-7f * (max_abs(center_) + radius_), inward_ ? -outwards : outwards};
}

bool SphereLight::sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const {
    const Vec3f axis = center_ - from;
    const float d2 = length_squared(axis);
    if (is_outside(d2)) {
        const float sin2_max = radius_ * radius_ / d2;
        const float h = one_minus_cos(sin2_max) * u, cosine = 1 - h;
        const float sin2 = h * (1 + cosine);
        // The angle at the centre between -axis and the point where the drawn direction hits the sphere [PBRT4 6.2.4].
        const float cos_alpha = sin2 / std::sqrt(sin2_max) + cosine * std::sqrt(std::max(0.0f, 1 - sin2 / sin2_max));
        out.at = at(Frame::from_z(-axis / std::sqrt(d2)).to_world(direction_at(std::min(cos_alpha, 1.0f), v)));
    } else {
        out.at = at(sample_sphere(u, v));
    }
    out.falloff = 1;
    if (!out.look_from(from) || !shines(out.at.ng, -out.wi)) return false;
    out.pdf_omega = pdf_omega(from, context, {out.wi, out.at.p, out.at.ng});
    return out.pdf_omega > 0;
}

float SphereLight::pdf_omega(const Vec3f& from, const LightSampleContext&, const LightHit& hit) const {
    const float d2 = length_squared(center_ - from);
    if (is_outside(d2)) return inward_ ? 0 : pdf_of_cone(one_minus_cos(radius_ * radius_ / d2));
    return pdf_of_area(from, hit.p, hit.ng);
}

void SphereLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    sample_direction(at(sample_sphere(u, v)), s, t, out);
}

}  // namespace latent::render
