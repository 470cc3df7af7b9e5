// render/bsdf/coated.h: a base under a layer of clear or scattering matter with a smooth or rough surface. docs/rendering.md,
// "Layers".
#pragma once

#include "render/bsdf/closure.h"
#include "render/bsdf/coat.h"
#include "render/bsdf/conductor.h"
#include "render/bsdf/diffuse.h"
#include "render/sampling/random.h"

namespace latent::render {

struct Layer {
    Coat coat;                                // a dispersive one: at the kept wavelength
    const SampledSpectrum* eta = nullptr;     // if it is dispersive: for each wavelength
    float thickness = 0;                      // in mean free paths
    const SampledSpectrum* albedo = nullptr;  // the albedo of what is in the layer; null: it only absorbs
    float g = 0;                              // its phase function's
    std::uint32_t max_depth = 10;             // scatterings and reflections within the layer
    std::uint32_t walks = 1;                  // random walks that an evaluation is the mean of
    std::uint64_t key = 0;                    // key of their numbers: another one at each vertex of each sample
};

// Both sides look alike. Evaluation is exact where the coat is smooth, the layer does not scatter and the base is a diffuse one or
// a smooth metal. Else it is an unbiased estimate by random walks within the layer, whose numbers are a function of the key and of
// the two directions: the same for both orders of them. Densities are exact, functions of the directions alone.
template <class Base>
class Coated {
 public:
    static constexpr std::string_view kName = std::is_same_v<Base, Diffuse> ? "coateddiffuse" : "coatedconductor";
    static constexpr std::array kInputs =
        joined(Base::kInputs,
               std::array{Input::index("layer.eta"), Input::alpha("layer.alpha_x"), Input::alpha("layer.alpha_y"),
                          Input::number("layer.thickness", 0.01f, 0, 1e6f), Input{.name = "layer.albedo", .may_be_missing = true},
                          Input::number("layer.g", 0, -0.9999f, 0.9999f), Input::option("layer.max_depth", 10),
                          Input::option("layer.walks", 1)});
    static constexpr bool kTransmits = false;

    // What the closure looks at; it must live as long.
    struct State {
        State(const Layer& layer, const Base& base);

        Layer layer;
        Base base;
        bool smooth_coat, smooth_base;
        float brightness;        // about the share of entering light that leaves the layer
        float cosine_share = 1;  // share of directions from within the layer drawn by the cosine; else as the base reflects
        Microfacets lobe{1, 1};  // how the base reflects, seen through the coat
        float returned = 0;      // share of diffuse light from below that the smooth coat and the layer return to the base
    };
    explicit Coated(const Values<Coated>& v);
    explicit Coated(const State& state) : state_(&state) {}
    static bool is_isotropic(const Values<Coated>& v);

    bool is_delta() const { return state_->smooth_coat && state_->smooth_base && !state_->layer.albedo; }
    SampledSpectrum albedo() const { return state_->base.albedo(); }
    bool disperses(const Vec3f&, const Vec3f&) const { return state_->layer.eta && !is_exact(); }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    bool is_exact() const;
    // Probability that a direction is drawn from the coat's reflection, for a cosine above.
    float coat_probability(float c) const;
    // In each wavelength, of the delta function: reflection by the coat and by all smooth surfaces together.
    SampledSpectrum mirrored(float c) const;
    // f of light that enters the layer, both directions above.
    SampledSpectrum from_within(const Vec3f& a, const Vec3f& b) const;
    SampledSpectrum diffuse_exactly(const Vec3f& a, const Vec3f& b) const;
    SampledSpectrum diffuse_walk(const Vec3f& a, const Vec3f& b, Random& number) const;
    SampledSpectrum walk(const Vec3f& a, const Vec3f& b, Random& number) const;

    const State* state_;
};

using CoatedDiffuse = Coated<Diffuse>;
using CoatedConductor = Coated<Conductor>;

}  // namespace latent::render
