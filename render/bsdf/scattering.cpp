#include "render/bsdf/scattering.h"

#include "render/bsdf/fresnel.h"

namespace latent::render {
namespace {

// Rougher than this, facets have a density; smoother is a mirror [PBRT4 9.6.1].
constexpr float kSmooth = 1e-3f;

// The facet normal, z > 0, that reflects `a` into `b`, or refracts it there if `eta` (b's side over a's) is not 1.
// False: none, or it faces away from one of the two.
bool half_vector(const Vec3f& a, const Vec3f& b, float eta, Vec3f& m) {
    const Vec3f sum = a + b * eta;
    const float squared = length_squared(sum);
    if (!(squared > 0) || a.z == 0 || b.z == 0) return false;
    m = sum / std::sqrt(squared);
    if (m.z < 0) m = -m;
    return dot(m, a) * a.z > 0 && dot(m, b) * b.z > 0;
}

// d omega_m / d omega_b of refraction: |b.m| / (b.m + a.m / eta)^2 [WMLT07].
float refraction_jacobian(const Vec3f& a, const Vec3f& b, const Vec3f& m, float eta) {
    const float denominator = dot(b, m) + dot(a, m) / eta;
    return abs_dot(b, m) / (denominator * denominator);
}

}  // namespace

float henyey_greenstein(float g, float cosine) {
    const float d = 1 + g * g + 2 * g * cosine;
    return kInv4Pi * (1 - g * g) / (d * std::sqrt(std::max(0.0f, d)));
}

Scattering Scattering::diffuse(const Frame& frame, const Vec3f& ng, const Batch& reflectance) {
    Scattering s;
    s.frame_ = frame;
    s.ng_ = ng;
    s.first_ = &reflectance;
    return s;
}

Scattering Scattering::conductor(const Frame& frame, const Vec3f& ng, const Batch& eta, const Batch& k, float alpha_x,
                                 float alpha_y) {
    Scattering s = diffuse(frame, ng, eta);
    s.kind_ = Kind::kConductor;
    s.second_ = &k;
    s.facets_ = {std::max(alpha_x, 1e-4f), std::max(alpha_y, 1e-4f)};
    s.delta_ = std::max(alpha_x, alpha_y) < kSmooth;
    return s;
}

Scattering Scattering::dielectric(const Frame& frame, const Vec3f& ng, const Batch& eta, bool dispersive, std::uint32_t kept,
                                  float alpha_x, float alpha_y) {
    Scattering s = conductor(frame, ng, eta, eta, alpha_x, alpha_y);
    s.kind_ = Kind::kDielectric;
    s.dispersive_ = dispersive;
    s.kept_ = kept;
    s.eta_ = eta[kept];
    s.delta_ = s.delta_ || (s.eta_ == 1 && !dispersive);
    return s;
}

Scattering Scattering::thin_dielectric(const Frame& frame, const Vec3f& ng, const Batch& eta, bool dispersive, std::uint32_t kept) {
    Scattering s = dielectric(frame, ng, eta, dispersive, kept, 0, 0);
    s.kind_ = Kind::kThinDielectric;
    return s;
}

Scattering Scattering::phase(float g) {
    Scattering s;
    s.kind_ = Kind::kPhase;
    s.g_ = g;
    return s;
}

// Odds of reflection at cosine c; of a pane after all bounces between its two faces: F + (1 - F)^2 F / (1 - F^2).
float Scattering::reflectance(float c, float eta) const {
    const float f = fresnel_dielectric(c, eta);
    return kind_ == Kind::kThinDielectric ? 2 * f / (1 + f) : f;
}

// The same in every wavelength, for light that meets a facet from the side of local direction w.
Batch Scattering::reflectance_batch(const Vec3f& w, float c) const {
    if (kind_ == Kind::kConductor) return fresnel_conductor(c, *first_, *second_);
    if (!dispersive_) return Batch(reflectance(c, across(w, eta_)));
    return batch_of([&](std::uint32_t i) { return reflectance(c, across(w, (*first_)[i])); });
}

void Scattering::multiply_f_cos(const Vec3f& w_eye, const Vec3f& w_light, Batch& value) const {
    if (kind_ == Kind::kPhase) {
        value *= henyey_greenstein(g_, dot(w_eye, w_light));
        return;
    }
    const Vec3f eye = frame_.to_local(w_eye), light = frame_.to_local(w_light);
    const bool same_side = eye.z * light.z > 0;
    if (delta_ || same_side != reflects(w_eye, w_light)) {
        value = Batch(0.0f);
    } else if (kind_ == Kind::kDielectric) {
        multiply_rough_dielectric(eye, light, value);
    } else if (!same_side) {
        value = Batch(0.0f);
    } else if (kind_ == Kind::kDiffuse) {
        const float s = kInvPi * std::abs(light.z);
        for (std::uint32_t i = 0; i < kLanes; ++i) value.v[i] *= first_->v[i] * s;
    } else {
        Vec3f m;
        if (!half_vector(eye, light, 1, m)) {
            value = Batch(0.0f);
            return;
        }
        value *= reflectance_batch(eye, abs_dot(eye, m));
        value *= facets_.density(m) * facets_.masking_shadowing(eye, light) / (4 * std::abs(eye.z));
    }
}

// Reflection F D G / (4 |cos cos|); transmission (1 - F) D G |eye.m light.m| / (|cos cos| (light.m + eye.m / eta)^2 eta^2), eta the
// index on light's side over that on eye's [WMLT07]; the last factor is the compression of radiance.
void Scattering::multiply_rough_dielectric(const Vec3f& eye, const Vec3f& light, Batch& value) const {
    const bool same_side = eye.z * light.z > 0;
    const float eta = same_side ? 1 : across(eye, eta_);
    Vec3f m;
    if (!half_vector(eye, light, eta, m)) {
        value = Batch(0.0f);
        return;
    }
    const float dg = facets_.density(m) * facets_.masking_shadowing(eye, light);
    const float cosine = abs_dot(eye, m);
    if (same_side) {
        value *= reflectance_batch(eye, cosine);
        value *= dg / (4 * std::abs(eye.z));
    } else {
        const float t = 1 - fresnel_dielectric(cosine, eta);
        value *= t * dg * cosine * refraction_jacobian(eye, light, m, eta) / (std::abs(eye.z) * eta * eta);
    }
}

float Scattering::pdf_rough_dielectric(const Vec3f& wo, const Vec3f& wi) const {
    const bool same_side = wo.z * wi.z > 0;
    const float eta = across(wo, eta_);
    Vec3f m;
    if (!half_vector(wo, wi, same_side ? 1 : eta, m)) return 0;
    const float f = fresnel_dielectric(abs_dot(wo, m), eta);
    const float d = facets_.visible_density(wo, m);
    return same_side ? f * d / (4 * abs_dot(wo, m)) : (1 - f) * d * refraction_jacobian(wo, wi, m, eta);
}

float Scattering::pdf_omega(const Vec3f& world_wo, const Vec3f& world_wi) const {
    if (kind_ == Kind::kPhase) return henyey_greenstein(g_, dot(world_wo, world_wi));
    if (delta_) return 0;
    const Vec3f wo = frame_.to_local(world_wo), wi = frame_.to_local(world_wi);
    const bool same_side = wo.z * wi.z > 0;
    if (same_side != reflects(world_wo, world_wi)) return 0;
    if (kind_ == Kind::kDielectric) return pdf_rough_dielectric(wo, wi);
    if (!same_side) return 0;
    if (kind_ == Kind::kDiffuse) return kInvPi * std::abs(wi.z);
    Vec3f m;
    return half_vector(wo, wi, 1, m) ? facets_.visible_density(wo, m) / (4 * abs_dot(wo, m)) : 0;
}

bool Scattering::sample(const Vec3f& wo, bool from_eye, float u_lobe, float u, float v, Sample& out, Batch& beta) const {
    if (delta_) return sample_smooth(wo, from_eye, u_lobe, out, beta);
    out.delta = false;
    out.eta2 = 1;
    if (kind_ == Kind::kPhase) {
        // The inverse of the cumulative distribution in the cosine; isotropic where g would divide by nothing.
        const float t = (1 - g_ * g_) / (1 + g_ - 2 * g_ * u);
        const float c = std::abs(g_) < 1e-3f ? 1 - 2 * u : -(1 + g_ * g_ - t * t) / (2 * g_);
        out.wi = Frame::from_z(wo).to_world(direction_at(std::clamp(c, -1.0f, 1.0f), v));
        out.pdf = out.pdf_reverse = henyey_greenstein(g_, dot(wo, out.wi));
        return out.pdf > 0;
    }

    const Vec3f local = frame_.to_local(wo);
    if (local.z == 0) return false;
    Vec3f wi;
    if (kind_ == Kind::kDiffuse) {
        wi = sample_cosine_hemisphere(u, v);
        if (local.z < 0) wi.z = -wi.z;
    } else {
        const Vec3f m = facets_.sample_visible(local, u, v);
        const float eta = across(local, eta_);
        const bool reflected = kind_ == Kind::kConductor || u_lobe < fresnel_dielectric(abs_dot(local, m), eta);
        if (reflected) {
            wi = m * (2 * dot(local, m)) - local;
        } else if (!refract(local, face_forward(m, local), eta, wi)) {
            return false;
        }
        if (reflected != (wi.z * local.z > 0)) return false;
        if (!reflected) out.eta2 = eta * eta;
    }
    out.wi = normalize(frame_.to_world(wi));
    out.pdf = pdf_omega(wo, out.wi);
    if (!(out.pdf > 0)) return false;
    out.pdf_reverse = pdf_omega(out.wi, wo);
    const Vec3f& w_eye = from_eye ? wo : out.wi;
    const Vec3f& w_light = from_eye ? out.wi : wo;
    multiply_f_cos(w_eye, w_light, beta);
    beta *= (from_eye ? 1 : abs_dot(out.wi, ng_) / abs_dot(wo, ng_)) / out.pdf;
    return true;
}

// Reflection with the odds F, at the kept wavelength, of refraction else.
bool Scattering::sample_smooth(const Vec3f& world_wo, bool from_eye, float u_lobe, Sample& out, Batch& beta) const {
    const Vec3f wo = frame_.to_local(world_wo);
    const float c = std::abs(wo.z);
    if (c == 0) return false;
    out.delta = true;
    out.eta2 = 1;
    Vec3f wi{-wo.x, -wo.y, wo.z};
    if (kind_ == Kind::kConductor) {
        out.pdf = out.pdf_reverse = 1;
        beta *= reflectance_batch(wo, c);
    } else {
        const float eta = across(wo, eta_), f = reflectance(c, eta);
        if (u_lobe < f) {
            out.pdf = out.pdf_reverse = f;
            if (dispersive_) {
                beta *= reflectance_batch(wo, c);
                beta *= 1 / f;
            }
        } else if (kind_ == Kind::kThinDielectric) {
            out.pdf = out.pdf_reverse = 1 - f;
            wi = -wo;
            if (dispersive_) {
                const Batch r = reflectance_batch(wo, c);
                beta *= batch_of([&](std::uint32_t i) { return (1 - r[i]) / (1 - f); });
            }
        } else {
            if (!refract(wo, Vec3f{0, 0, wo.z > 0 ? 1.0f : -1.0f}, eta, wi)) return false;
            out.eta2 = eta * eta;
            out.pdf = 1 - f;
            out.pdf_reverse = (1 - f) * c / (std::abs(wi.z) * out.eta2);
            if (from_eye) beta *= 1 / out.eta2;
        }
    }
    out.wi = normalize(frame_.to_world(wi));
    if ((wi.z * wo.z > 0) != reflects(world_wo, out.wi)) return false;
    if (!from_eye) {
        // f |w_light.ns| |w_eye.ng| / |w_light.ng| against the |w_eye.ns| that the delta function's density is in.
        beta *= std::abs(wo.z / wi.z) * abs_dot(out.wi, ng_) / abs_dot(world_wo, ng_);
    }
    return true;
}

}  // namespace latent::render
