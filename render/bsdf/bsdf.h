// render/bsdf/bsdf.h: what a surface does to light where a path hits it: a closure in the frame of the shading normal.
// docs/rendering.md, "Surfaces".
#pragma once

#include "render/bsdf/closures.h"
#include "render/bsdf/light_sample_context.h"
#include "render/math/vec.h"
#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

struct BsdfSample {
    Vec3f wi;
    float pdf;  // 1/sr; for a delta function the probability that its coefficient stands for (see weights.h)
    bool delta;
    float probability_reverse;  // for a delta function: that of the way back
    float eta2;                 // by which radiance was scaled: squared index on wi's side over that on wo's; 1 for reflection
};

// Directions are the world's and point away from the surface; `w_camera` leads towards the camera, `w_light` towards the light,
// whichever subpath came first. Values are those of radiance flowing from w_light to w_camera: the one function serves both kinds
// of subpath.
//
// Cosines: f holds with the shading normal ns, area and solid angle convert with the geometric normal ng, so that a vertex
// contributes f |w_light.ns| / |w_light.ng| between two geometry terms in ng [Veach97 5.3]. `multiply_f_cos` multiplies by
// f |w_light.ns|: along a camera subpath that is all; along a light subpath the caller divides by |w_light.ng| and multiplies by
// |w_camera.ng|. A surface reflects only on one side of ng and transmits only to the other: no light leaks through bumps [R06 9.8].
// A fibre has no sides; it is seen where w_camera comes from outside.
//
// ns is turned towards ng where the camera would see a reflection from below the surface (`seen_from`), so f depends on which of
// the two directions is the camera's. A light subpath draws w_camera about the ns that is stored. A coat with a normal of its own
// does the same for itself, and reflects to wherever the surface does not stand in the way.
class Bsdf {
 public:
    // frame.z is the shading normal. Valid as long as the values that the closure points to.
    template <Closure C>
    Bsdf(const Frame& frame, const Vec3f& ng, const C& closure)
        : frame_(frame), ng_(ng), delta_(closure.is_delta()), transmits_(C::kTransmits), tilted_(frame.z != ng), closure_(closure) {
        if constexpr (std::is_same_v<C, Hair>) fibre_ = true, round_ = closure.is_round();
    }

    // Multiplies f by `weight`, which must live as long. Directions are drawn as before.
    void weigh(const SampledSpectrum& weight) { weight_ = &weight; }

    // The normal of a coat, if the closure has one.
    void lay_coat(const Vec3f& n) {
        std::visit(
            [&](const auto& closure) {
                if constexpr (requires { closure.with_coat_normal(n); }) has_coat_normal_ = closure.is_coated() && n != frame_.z;
            },
            closure_);
        coat_n_ = n;
    }

    // Whether rays from w meet it at all: a round fibre is met from outside alone.
    bool is_met_from(const Vec3f& w) const { return !round_ || dot(w, ng_) > 0; }
    // Directions come from a delta function: nothing can be connected to this vertex.
    bool is_delta() const { return delta_; }
    // The shading normal.
    const Vec3f& normal() const { return frame_.z; }
    // About the share of light that it scatters.
    SampledSpectrum albedo() const;
    // For whom a light's point is drawn, looked at from wo.
    LightSampleContext light_sample_context(const Vec3f& w_camera) const {
        return {face_forward(seen_from(w_camera).z, w_camera), transmits_ || has_coat_normal_};
    }

    // value *= f |w_light.ns|. Nothing but zero if is_delta().
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    // Density [1/sr] with which `sample` finds wi from wo; 0 if is_delta().
    float pdf_omega(const Vec3f& wo, const Vec3f& wi, bool from_camera) const;
    // What passes from w_light to w_camera is refracted by an index that varies with wavelength: only the kept one is right.
    bool disperses(const Vec3f& w_camera, const Vec3f& w_light) const {
        const Frame frame = seen_from(w_camera, false);
        return std::visit([&](const auto& closure) { return closure.disperses(frame.to_local(w_camera), frame.to_local(w_light)); },
                          closure_);
    }
    // Draws wi for a subpath that arrives from wo; beta *= weight of the step. `from_camera`: a camera subpath. False: absorbed.
    bool sample(const Vec3f& wo, bool from_camera, float u_lobe, float u, float v, BsdfSample& out, SampledSpectrum& beta) const;
    // As `pdf` of what `sample` drew: that it finds wo from wi.
    float pdf_reverse(const Vec3f& wo, const BsdfSample& drawn, bool from_camera) const {
        return drawn.delta ? drawn.probability_reverse : pdf_omega(drawn.wi, wo, !from_camera);
    }

 private:
    // The frame that a camera sees from w. With g = ng and s = ns on w's side, r = 2 (s.w) s - w the reflection of w, and
    // t = min(0.9 g.w, 0.01): if r.g < t, ns becomes the normal that reflects w along r + (t - r.g) g, which is just above the
    // surface [Keller17]. Of smooth glass, only `reflection` does: what it refracts keeps ns while s.w > 0, so that light subpaths
    // find it.
    Frame seen_from(const Vec3f& w, bool reflection) const { return tilted_ ? turned_to(w, reflection) : frame_; }
    Frame seen_from(const Vec3f& w) const { return seen_from(w, !delta_ || !transmits_); }
    Frame turned_to(const Vec3f& w, bool reflection) const;
    Vec3f turned_to(const Vec3f& w, const Vec3f& normal, bool reflection) const;
    // f of the closure in `frame`, its coat's normal as it is seen from w_camera; null: as it is stored.
    template <class C, class F>
    auto with_coat(const C& closure, const Frame& frame, const Vec3f* w_camera, const F& f) const {
        if constexpr (requires { closure.with_coat_normal(coat_n_); }) {
            if (has_coat_normal_)
                return f(
                    closure.with_coat_normal(frame.to_local(w_camera != nullptr ? turned_to(*w_camera, coat_n_, true) : coat_n_)));
        }
        return f(closure);
    }
    // The side rule, for two directions in the world and in the frame.
    bool connects(const Vec3f& world_a, const Vec3f& world_b, const Vec3f& a, const Vec3f& b) const;

    Frame frame_;
    Vec3f ng_;
    bool delta_, transmits_;
    bool tilted_;  // ns is not ng
    bool fibre_ = false, round_ = false;
    bool has_coat_normal_ = false;
    Vec3f coat_n_{};
    const SampledSpectrum* weight_ = nullptr;
    AnyClosure closure_;
};

}  // namespace latent::render
