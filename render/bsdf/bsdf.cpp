#include "render/bsdf/bsdf.h"

namespace latent::render {

namespace {

constexpr float kLift =
    0.01f;  // above the surface: the height of a reflection that would go below it, so that its lobe is above, too

}  // namespace

bool Bsdf::connects(const Vec3f& world_a, const Vec3f& world_b, const Vec3f& a, const Vec3f& b) const {
    if (fibre_) return true;
    const bool reflects = has_coat_normal_ || a.z * b.z > 0;  // the closure looks at the sides of surface and coat itself
    return (reflects || transmits_) && reflects == (dot(world_a, ng_) * dot(world_b, ng_) > 0);
}

Frame Bsdf::turned_to(const Vec3f& w, bool reflection) const {
    if (fibre_) return frame_;
    const Vec3f n = turned_to(w, frame_.z, reflection);
    return n == frame_.z ? frame_ : Frame::from_z_x(n, frame_.x);
}

Vec3f Bsdf::turned_to(const Vec3f& w, const Vec3f& normal, bool reflection) const {
    const Vec3f g = face_forward(ng_, w), s = face_forward(normal, g);
    const float up = dot(g, w), t = std::min(0.9f * up, kLift), cosine = dot(s, w), reflected = 2 * cosine * dot(s, g) - up;
    if (reflection ? reflected >= t : cosine > 0) return normal;
    const Vec3f n = w + normalize(s * (2 * cosine) - w + g * (t - reflected));
    const float squared = length_squared(n);
    if (!(squared > 0)) return normal;  // w lies in the surface
    return n / (dot(s, normal) < 0 ? -std::sqrt(squared) : std::sqrt(squared));
}

SampledSpectrum Bsdf::albedo() const {
    const SampledSpectrum whole = std::visit([](const auto& closure) { return closure.albedo(); }, closure_);
    return weight_ != nullptr ? whole * *weight_ : whole;
}

void Bsdf::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const Frame frame = seen_from(w_camera);
    const Vec3f camera = frame.to_local(w_camera), light = frame.to_local(w_light);
    if (delta_ || !connects(w_camera, w_light, camera, light) || !is_met_from(w_camera)) {
        value = SampledSpectrum(0.0f);
        return;
    }
    std::visit(
        [&](const auto& closure) {
            with_coat(closure, frame, &w_camera, [&](const auto& coated) { coated.multiply_f_cos(camera, light, value); });
        },
        closure_);
    if (weight_ != nullptr) value *= *weight_;
}

float Bsdf::pdf_omega(const Vec3f& world_wo, const Vec3f& world_wi, bool from_camera) const {
    if (delta_ || !is_met_from(world_wo)) return 0;
    const Frame frame = from_camera ? seen_from(world_wo) : frame_;
    const Vec3f wo = frame.to_local(world_wo), wi = frame.to_local(world_wi);
    if (!connects(world_wo, world_wi, wo, wi)) return 0;
    return std::visit(
        [&](const auto& closure) {
            return with_coat(closure, frame, from_camera ? &world_wo : nullptr,
                             [&](const auto& coated) { return coated.pdf_omega(wo, wi); });
        },
        closure_);
}

bool Bsdf::sample(const Vec3f& world_wo, bool from_camera, float u_lobe, float u, float v, BsdfSample& out,
                  SampledSpectrum& beta) const {
    const Frame frame = from_camera ? seen_from(world_wo) : frame_;
    const Vec3f wo = frame.to_local(world_wo);
    if (wo.z == 0 && !fibre_) return false;
    if (weight_ != nullptr) beta *= *weight_;
    const auto draw = [&](const auto& closure, const auto& stored) {
        ClosureSample drawn;
        if (!closure.sample(wo, u_lobe, u, v, drawn, beta)) return false;
        out.wi = normalize(frame.to_world(drawn.wi));
        out.delta = drawn.delta;
        out.eta2 = drawn.eta2;
        if (drawn.delta) {
            const Frame seen = seen_from(from_camera ? world_wo : out.wi, wo.z * drawn.wi.z > 0);
            // About the ns that is stored, a light subpath does not find what the camera sees about another one.
            const bool turned = seen.z != frame_.z;
            if (from_camera && seen.z != frame.z) out.wi = normalize(seen.z * (2 * dot(seen.z, world_wo)) - world_wo);
            if (!connects(world_wo, out.wi, wo, drawn.wi)) return false;
            out.pdf = drawn.probability;
            out.probability_reverse = turned ? 0 : drawn.probability_reverse;
            if (!from_camera) {
                if (turned) return false;
                // f |w_light.ns| |w_camera.ng| / |w_light.ng| against the |w_camera.ns| that the delta function's density is
                // in.
                beta *= std::abs(wo.z / drawn.wi.z) * abs_dot(out.wi, ng_) / abs_dot(world_wo, ng_);
            } else if (drawn.eta2 != 1) {
                beta *= 1 / drawn.eta2;
            }
            return true;
        }
        const Vec3f wi = frame.to_local(out.wi);
        if (!connects(world_wo, out.wi, wo, wi)) return false;
        out.pdf = closure.pdf_omega(wo, wi);
        if (!(out.pdf > 0)) return false;
        if (!from_camera && !is_met_from(out.wi)) return false;  // seen from there, it is another point of the fibre that shines
        if (from_camera) {
            closure.multiply_f_cos(wo, wi, beta);
            beta *= 1 / out.pdf;
            return true;
        }
        const Frame seen = seen_from(out.wi);
        const Vec3f camera = seen.to_local(out.wi), light = seen.to_local(world_wo);
        if (!connects(out.wi, world_wo, camera, light)) return false;
        with_coat(stored, seen, &out.wi, [&](const auto& coated) { coated.multiply_f_cos(camera, light, beta); });
        beta *= abs_dot(out.wi, ng_) / abs_dot(world_wo, ng_) / out.pdf;
        return true;
    };
    return std::visit(
        [&](const auto& stored) {
            return with_coat(stored, frame, from_camera ? &world_wo : nullptr,
                             [&](const auto& closure) { return draw(closure, stored); });
        },
        closure_);
}

}  // namespace latent::render
