#include "render/light/area_emission.h"

#include "render/math/elementary.h"

namespace latent::render {

// Looked up without a footprint, so that all strategies find the same.
void EmissionPattern::multiply(std::uint32_t primitive, const EmissionPoint& at, SampledSpectra& spectra,
                               SampledSpectrum& value) const {
    SurfaceHit hit{};
    hit.p = at.p;
    hit.ng = hit.ns = at.ng;
    hit.on = {kNone, shape, primitive, at.uv};
    TexturePoint point{};
    point.p = at.p;
    point.n = at.ng;
    const SurfaceCoordinates coordinates = geometry->coordinates(hit);
    point.uv = coordinates.uv;
    point.vertices = coordinates.vertices;
    point.spectra = &spectra;
    if (picture) value *= picture->at(point);
    if (!at.is_met) value *= std::clamp(alpha.at(point), 0.0f, 1.0f);
}

AreaEmission::AreaEmission(const AreaLightDescription& light, std::uint32_t spectrum, const Emitter& emitter,
                           const EmissionPattern* pattern)
    : emission_{spectrum, 0},
      area_(static_cast<float>(emitter.area)),
      mean_(static_cast<float>(light.mean_luminance)),
      exponent_(static_cast<float>(light.exponent)),
      two_sided_(light.two_sided),
      inside_medium_(emitter.inside_medium),
      outside_medium_(emitter.outside_medium),
      primitive_(emitter.primitive),
      pattern_(pattern) {
    if (!(emitter.area > 0)) return;  // black
    // `power` is that of a whole patch, where the scene has one.
    const double sides = two_sided_ ? 2 : 1, area = emitter.is_half ? 2 * emitter.area : emitter.area;
    const double per_scale = std::numbers::pi * area * sides * light.mean_luminance * (2 / (light.exponent + 2));
    emission_.scale = static_cast<float>(light.scale * (light.power ? *light.power / per_scale : 1));
}

float AreaEmission::falloff(const Vec3f& ng, const Vec3f& d) const {
    const float h = one_minus_dot(dot(ng, d) < 0 ? -ng : ng, d);
    return h < 1 ? exp_nonpositive(exponent_ * log_one_minus(h)) : 0;
}

void AreaEmission::sample_direction(const Interaction& at, Uniform s, Uniform t, LightRay& out) const {
    const bool back = two_sided_ && s.index(2) == 1;
    if (two_sided_) s = s.within(2);
    Vec3f local = exponent_ == 0 ? sample_cosine_hemisphere(s, t)  // else the density goes with cos^(exponent + 1)
                                 : direction_at(exp_nonpositive(log_one_minus(s) / (exponent_ + 2)), t);
    local.z = std::max(local.z, 1e-6f);
    out.at = at;
    out.d = normalize(Frame::from_z(back ? -at.ng : at.ng).to_world(local));
    out.pdf_position = pdf_position();
    out.pdf_direction = pdf_direction(at.ng, out.d);
    out.cosine = abs_dot(out.d, at.ng);
    out.profile = 1;
    out.medium = back ? inside_medium_ : outside_medium_;
}

}  // namespace latent::render
