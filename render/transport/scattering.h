// render/transport/scattering.h: what a vertex of a path does to light: the BSDF of a surface or the phase function of a medium,
// with the verbs of Bsdf for both.
#pragma once

#include <variant>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/phase.h"

namespace latent::render {

class Scattering {
 public:
    Scattering() : what_(Phase{}) {}
    Scattering(const Bsdf& bsdf) : what_(bsdf) {}
    Scattering(const Phase& phase) : what_(phase) {}
    Scattering(const PhaseFunction& phase) : what_(Phase(phase)) {}

    Scattering& operator=(const Bsdf& bsdf) { return what_.emplace<Bsdf>(bsdf), *this; }
    Scattering& operator=(const Phase& phase) { return what_.emplace<Phase>(phase), *this; }

    bool in_medium() const { return bsdf() == nullptr; }
    bool is_delta() const { return bsdf() && bsdf()->is_delta(); }
    bool is_met_from(const Vec3f& w) const { return !bsdf() || bsdf()->is_met_from(w); }
    LightSampleContext light_sample_context(const Vec3f& w_camera) const {
        return bsdf() ? bsdf()->light_sample_context(w_camera) : LightSampleContext{};
    }
    bool disperses(const Vec3f& w_camera, const Vec3f& w_light) const { return bsdf() && bsdf()->disperses(w_camera, w_light); }

    // value *= f |w_light.ns|, or the phase function.
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
        if (const Bsdf* surface = bsdf()) {
            surface->multiply_f_cos(w_camera, w_light, value);
        } else {
            phase().multiply(w_camera, w_light, value);
        }
    }
    float pdf_omega(const Vec3f& wo, const Vec3f& wi, bool from_camera) const {
        return bsdf() ? bsdf()->pdf_omega(wo, wi, from_camera) : phase().pdf_omega(wo, wi);
    }

    bool sample(const Vec3f& wo, bool from_camera, float u_lobe, float u, float v, BsdfSample& out, SampledSpectrum& beta) const {
        if (const Bsdf* surface = bsdf()) return surface->sample(wo, from_camera, u_lobe, u, v, out, beta);
        out.wi = phase().sample(wo, u_lobe, u, v);
        out.pdf = phase().pdf_omega(wo, out.wi);
        out.delta = false;
        out.eta2 = 1;
        if (!(out.pdf > 0)) return false;
        if (phase().mixture) {
            phase().multiply(wo, out.wi, beta);
            beta *= 1 / out.pdf;
        }
        return true;
    }
    // Phase functions are symmetric.
    float pdf_reverse(const Vec3f& wo, const BsdfSample& drawn, bool from_camera) const {
        return bsdf() ? bsdf()->pdf_reverse(wo, drawn, from_camera) : drawn.pdf;
    }

 private:
    const Bsdf* bsdf() const { return std::get_if<Bsdf>(&what_); }
    const Phase& phase() const { return *std::get_if<Phase>(&what_); }

    std::variant<Phase, Bsdf> what_;
};

}  // namespace latent::render
