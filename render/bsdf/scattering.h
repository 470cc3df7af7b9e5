// render/bsdf/scattering.h: what a vertex of a path does to light: the BSDF of a surface or the phase function of a medium, at the
// wavelengths of one sample. docs/rendering.md, "Surfaces" and "Media".
#pragma once

#include <cstdint>

#include "render/bsdf/microfacet.h"
#include "render/bsdf/receiver.h"
#include "render/math/vec.h"
#include "render/spectral/batch.h"

namespace latent::render {

// Directions point away from the vertex; `w_eye` leads towards the camera, `w_light` towards the light, whichever subpath came
// first. Values are those of radiance flowing from w_light to w_eye: the one function serves both kinds of subpath.
//
// Cosines: f holds with the shading normal ns, area and solid angle convert with the geometric normal ng, so that a vertex
// contributes f |w_light.ns| / |w_light.ng| between two geometry terms in ng [Veach97 5.3]. `multiply_f_cos` multiplies by
// f |w_light.ns|: along a camera subpath that is all; along a light subpath the caller divides by |w_light.ng| and multiplies by
// |w_eye.ng|. A surface reflects only on one side of ng and transmits only to the other: no light leaks through bumps [R06 9.8].
class Scattering {
 public:
    enum class Kind : std::uint8_t { kDiffuse, kConductor, kDielectric, kThinDielectric, kPhase };

    static Scattering diffuse(const Frame& frame, const Vec3f& ng, const Batch& reflectance);
    static Scattering conductor(const Frame& frame, const Vec3f& ng, const Batch& eta, const Batch& k, float alpha_x,
                                float alpha_y);
    // `eta` per wavelength; transmission of a `dispersive` one follows lane `kept` alone, and so do the odds of its lobes.
    static Scattering dielectric(const Frame& frame, const Vec3f& ng, const Batch& eta, bool dispersive, std::uint32_t kept,
                                 float alpha_x, float alpha_y);
    // Nothing is refracted: all lanes go on together, with the odds of lane `kept`.
    static Scattering thin_dielectric(const Frame& frame, const Vec3f& ng, const Batch& eta, bool dispersive, std::uint32_t kept);
    static Scattering phase(float g);

    // Directions come from a delta function: nothing can be connected to this vertex.
    bool is_delta() const { return delta_; }
    bool in_medium() const { return kind_ == Kind::kPhase; }
    // For whom a light's point is drawn, looked at from wo.
    Receiver receiver(const Vec3f& wo) const {
        if (in_medium()) return {};
        return {face_forward(frame_.z, wo), kind_ == Kind::kDielectric};
    }

    // value *= f |w_light.ns|. Nothing but zero if is_delta().
    void multiply_f_cos(const Vec3f& w_eye, const Vec3f& w_light, Batch& value) const;
    // Density [1/sr] with which `sample` finds wi from wo; 0 if is_delta().
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    // What passes from w_light to w_eye is refracted by an index that varies with wavelength: only lane `kept` is right.
    bool disperses(const Vec3f& w_eye, const Vec3f& w_light) const {
        return dispersive_ && kind_ == Kind::kDielectric && dot(w_eye, frame_.z) * dot(w_light, frame_.z) < 0;
    }

    struct Sample {
        Vec3f wi;
        float pdf, pdf_reverse;  // 1/sr; of a delta function the odds that its coefficient stands for (see bdpt.h)
        bool delta;
        float eta2 = 1;  // by which radiance was scaled: squared index on wi's side over that on wo's; 1 for reflection
    };
    // Draws wi for a subpath that arrives from wo; beta *= weight of the step. `from_eye`: a camera subpath. False: absorbed.
    bool sample(const Vec3f& wo, bool from_eye, float u_lobe, float u, float v, Sample& out, Batch& beta) const;

 private:
    bool reflects(const Vec3f& a, const Vec3f& b) const { return dot(a, ng_) * dot(b, ng_) > 0; }
    bool sample_smooth(const Vec3f& wo, bool from_eye, float u_lobe, Sample& out, Batch& beta) const;
    // Index of the side that local direction `w` does not lie on over that of its side; of a pane that of its glass.
    float across(const Vec3f& w, float eta) const { return w.z > 0 || kind_ == Kind::kThinDielectric ? eta : 1 / eta; }
    float reflectance(float c, float eta) const;
    Batch reflectance_batch(const Vec3f& w, float c) const;
    void multiply_rough_dielectric(const Vec3f& eye, const Vec3f& light, Batch& value) const;
    float pdf_rough_dielectric(const Vec3f& wo, const Vec3f& wi) const;

    Kind kind_ = Kind::kDiffuse;
    bool delta_ = false, dispersive_ = false;
    std::uint32_t kept_ = 0;
    Frame frame_;
    Vec3f ng_;
    const Batch* first_ = nullptr;   // reflectance, or eta
    const Batch* second_ = nullptr;  // k of a conductor
    Microfacets facets_{0, 0};
    float eta_ = 1;  // dielectrics: at the kept wavelength
    float g_ = 0;    // phase
};

// Henyey-Greenstein phase function [1/sr]: cosine of the angle between wo and wi, both pointing away, so that g > 0 favours -1.
//   p = (1 - g^2) / (4 pi (1 + g^2 + 2 g c)^(3/2))    [HG41]
float henyey_greenstein(float g, float cosine);

}  // namespace latent::render
