// render/bsdf/hair.h: light scattered by a hair, a fibre of clear or coloured matter with tilted scales. docs/rendering.md, "Hair".
#pragma once

#include <array>
#include <optional>

#include "render/bsdf/closure.h"

namespace latent::render {

struct Fibre {
    const SampledSpectrum* sigma_a;  // in its radii
    float eta = 1.55f;
    float beta_m = 0.3f, beta_n = 0.3f;  // roughness along it and around it, 0 to 1
    float tilt_turns = 2.0f / 360;       // tilt of its scales
};

// Local x runs along the fibre. With h the place across the fibre, -1 to 1, that is seen from w_camera, S in 1/sr
//   f |w_light.z| = S(w_camera, w_light, h) = sum over p of M_p(theta) A_p(theta_camera, h) N_p(phi, h)
// [dEon11], [Chiang16]: p = 0 is reflected, 1 passes through, 2 is reflected once inside, the
// last term is all the rest. S has no cosine and no sides: whatever leaves the fibre counts where it is seen. Not reciprocal: h is
// always that of w_camera, for both kinds of subpath.
class Hair {
 public:
    static constexpr std::string_view kName = "hair";
    // Absorption, or the colour of much hair together. alpha in degrees.
    static constexpr std::array kInputs = {Input{.name = "sigma_a", .high = 1e6f, .may_be_missing = true},
                                           Input{.name = "color", .may_be_missing = true},
                                           Input::number("eta", 1.55f, 1.0001f, 10),
                                           Input::number("beta_m", 0.3f, 0, 1),
                                           Input::number("beta_n", 0.3f, 0, 1),
                                           Input::number("alpha", 2, -45, 45)};
    static constexpr bool kTransmits = true;
    static constexpr int kTerms = 4;

    struct State;
    // A direction in which a fibre is seen, and what follows from it.
    struct View {
        View(const State& state, const Vec3f& seen_from);
        // A_p of light that the fibre's inside attenuates by `transmittance` along `path`.
        std::array<float, kTerms> attenuation(float transmittance) const;
        // Where a ray without roughness would leave the fibre, from phi.
        float turn(int p) const { return 2 * static_cast<float>(p) * gamma_t - 2 * gamma_o + 0.5f * static_cast<float>(p); }
        // M_p N_p towards wi, of each term.
        const std::array<float, kTerms>& lobes(const State& state, const Vec3f& wi);

        Vec3f w;
        float sin, cos;                                // those of theta, the angle out of the plane across the fibre
        float phi;                                     // [turns] around it
        float gamma_o, gamma_t;                        // [turns] at which the fibre's circle is entered, outside and inside
        float reflectance, path;                       // at the surface; through the fibre, in its radii
        std::array<float, kTerms> sin_term, cos_term;  // those of theta turned by the scales, for each term
        SampledSpectrum transmittance;
        std::array<float, kTerms> probability;  // each term's share, over all wavelengths

     private:
        std::optional<Vec3f> wi_{};  // direction that lobes_ were computed for
        std::array<float, kTerms> lobes_{};
    };

    struct State {
        // `across`: of a ribbon, the place along local y, -1 to 1. Else the fibre is round, and the normal says where it is seen.
        State(const Fibre& fibre, bool is_ribbon, float across);

        Fibre fibre;
        bool is_ribbon;
        float across;
        std::array<float, kTerms> variance;       // v_p, of M_p
        float scale;                              // scale of the logistic distribution in N_p, in turns
        float all;                                // its part within half a turn to both sides
        std::array<float, 3> sin_tilt, cos_tilt;  // those of 2^k times the tilt
        mutable std::optional<View> last{};       // asked for: a path draws, weighs and connects from one direction
    };
    explicit Hair(const Values<Hair>& v);
    explicit Hair(const State& state) : state_(&state) {}
    static bool is_isotropic(const Values<Hair>&) { return false; }

    // Rays hit it from outside alone: what lies behind is the same fibre again.
    bool is_round() const { return !state_->is_ribbon; }
    bool is_delta() const { return false; }
    SampledSpectrum albedo() const;
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    // As if wo led to the camera.
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    View& seen_from(const Vec3f& w) const;
    const State* state_;
};

}  // namespace latent::render
