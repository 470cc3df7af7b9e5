#include "render/bsdf/bsdf.h"

namespace latent::render {

bool Bsdf::connects(const Vec3f& world_a, const Vec3f& world_b, const Vec3f& a, const Vec3f& b) const {
    if (fibre_) return true;
    const bool reflects = a.z * b.z > 0;
    return (reflects || transmits_) && reflects == (dot(world_a, ng_) * dot(world_b, ng_) > 0);
}

SampledSpectrum Bsdf::albedo() const {
    const SampledSpectrum whole = std::visit([](const auto& closure) { return closure.albedo(); }, closure_);
    return weight_ != nullptr ? whole * *weight_ : whole;
}

void Bsdf::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const Vec3f camera = frame_.to_local(w_camera), light = frame_.to_local(w_light);
    if (delta_ || !connects(w_camera, w_light, camera, light) || !is_met_from(w_camera)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    std::visit([&](const auto& closure) { closure.multiply_f_cos(camera, light, value); }, closure_);
    if (weight_ != nullptr) value *= *weight_;
}

float Bsdf::pdf_omega(const Vec3f& world_wo, const Vec3f& world_wi) const {
    if (delta_ || !is_met_from(world_wo)) return 0;
    const Vec3f wo = frame_.to_local(world_wo), wi = frame_.to_local(world_wi);
    if (!connects(world_wo, world_wi, wo, wi)) return 0;
    return std::visit([&](const auto& closure) { return closure.pdf_omega(wo, wi); }, closure_);
}

bool Bsdf::sample(const Vec3f& world_wo, bool from_camera, float u_lobe, float u, float v, BsdfSample& out,
                  SampledSpectrum& beta) const {
    const Vec3f wo = frame_.to_local(world_wo);
    if (wo.z == 0 && !fibre_) return false;
    if (weight_ != nullptr) beta *= *weight_;
    return std::visit(
        [&](const auto& closure) {
            ClosureSample drawn;
            if (!closure.sample(wo, u_lobe, u, v, drawn, beta)) return false;
            out.wi = normalize(frame_.to_world(drawn.wi));
            out.delta = drawn.delta;
            out.eta2 = drawn.eta2;
            if (drawn.delta) {
                if (!connects(world_wo, out.wi, wo, drawn.wi)) return false;
                out.pdf = drawn.probability;
                out.probability_reverse = drawn.probability_reverse;
                if (!from_camera) {
                    // f |w_light.ns| |w_camera.ng| / |w_light.ng| against the |w_camera.ns| that the delta function's density is
                    // in.
                    beta *= std::abs(wo.z / drawn.wi.z) * abs_dot(out.wi, ng_) / abs_dot(world_wo, ng_);
                } else if (drawn.eta2 != 1) {
                    beta *= 1 / drawn.eta2;
                }
                return true;
            }
            const Vec3f wi = frame_.to_local(out.wi);
            if (!connects(world_wo, out.wi, wo, wi)) return false;
            out.pdf = closure.pdf_omega(wo, wi);
            if (!(out.pdf > 0)) return false;
            if (!from_camera && !is_met_from(out.wi))
                return false;  // seen from there, it is another point of the fibre that shines
            closure.multiply_f_cos(from_camera ? wo : wi, from_camera ? wi : wo, beta);
            beta *= (from_camera ? 1 : abs_dot(out.wi, ng_) / abs_dot(world_wo, ng_)) / out.pdf;
            return true;
        },
        closure_);
}

}  // namespace latent::render
