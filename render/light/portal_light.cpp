#include "render/light/portal_light.h"

namespace latent::render {

PortalLight::PortalLight(const LightDescription& light, const Portal& portal, const EnvironmentMap* map, std::uint32_t spectrum,
                         const SceneBall& ball)
    : portal_(&portal),
      map_(map),
      emission_{spectrum, static_cast<float>(light.scale)},
      disk_{Vec3f(portal.center()), static_cast<float>(portal.radius() * 1.00001)},
      distance_(length(disk_.center - ball.center) + ball.radius) {
    if (light.illuminance)
        emission_.scale *= static_cast<float>(*light.illuminance / (map != nullptr ? map->upper_illuminance() : std::numbers::pi));
}

bool PortalLight::sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const {
    out = {.at = {}, .wi = {}, .distance = kInfinity, .pdf_omega = 0};
    const bool by_map = map_ != nullptr && u.index(2) == 0;
    if (map_ != nullptr) u = u.within(2);
    if (by_map) {
        out.wi = map_->sample(u, v);
    } else if (!portal_->sample(from, u, v, out.wi)) {
        return false;
    }
    if (!portal_->shows(from, out.wi)) return false;
    out.pdf_omega = pdf_omega(from, context, {out.wi});
    return out.pdf_omega > 0;
}

float PortalLight::pdf_omega(const Vec3f& from, const LightSampleContext&, const LightHit& hit) const {
    const float even = portal_->pdf_omega(from, hit.wi);
    return map_ == nullptr ? even : 0.5f * (even + map_->pdf_omega(hit.wi));
}

float PortalLight::pdf_direction(const Vec3f&, const Vec3f& d) const {
    if (!(dot(Vec3d(d), portal_->outwards()) < 0)) return 0;
    return map_ == nullptr ? 2 * kInv4Pi : map_->pdf_omega(-d);
}

void PortalLight::sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
    Vec3f towards = map_ == nullptr ? sample_sphere(s, t) : map_->sample(s, t);
    if (map_ == nullptr) towards = face_forward(towards, Vec3f(portal_->outwards()));
    out = disk_.sample_ray(towards, pdf_direction({}, -towards), u, v);
    out.profile = portal_->is_crossed(out.at.p, towards) ? 1 : 0;
    out.at.p += towards * distance_;
}

}  // namespace latent::render
