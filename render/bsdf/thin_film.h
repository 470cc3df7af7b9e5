// render/bsdf/thin_film.h: the colours of soap bubbles and oil: light that both faces of a thin film reflect, and that interferes.
// docs/rendering.md, "Thin films".
#pragma once

#include <algorithm>
#include <cmath>

#include "render/bsdf/inputs.h"
#include "render/math/elementary.h"

namespace latent::render {

// A film of index n and thickness d on matter of index m, in air; all are real. With r12 and r23 the amplitudes that its two faces
// reflect, of each polarisation, and phi = 4 pi n d cos(angle in the film) / lambda:
//   R = (r12^2 + r23^2 + 2 r12 r23 cos phi) / (1 + r12^2 r23^2 + 2 r12 r23 cos phi)  [BornWolf99 1.6.4], the mean of both
struct ThinFilm {
    float share = 0;  // the share of the surface that it covers
    float eta = 1.3f;
    float thickness_nm = 0;

    // What closures that can have one are made of.
    static constexpr std::array kInputs = {Input::number("film", 0, 0, 1), Input::number("film_eta", 1.3f, 1, 10),
                                           Input::number("film_thickness", 400, 0, 1e6f)};
    template <class C>
    static ThinFilm of(const Values<C>& v) {
        return {v.number("film"), v.number("film_eta"), v.number("film_thickness")};
    }

    // Light that hits the film in air at cosine c: what its wavelength does not change.
    class Ray {
     public:
        Ray(const ThinFilm& film, float c)
            : sin2_(std::max(0.0f, 1 - c * c)), n_(film.eta), c2_(std::sqrt(std::max(0.0f, 1 - sin2_ / (film.eta * film.eta)))) {
            s12_ = (c - n_ * c2_) / (c + n_ * c2_);
            p12_ = (n_ * c - c2_) / (n_ * c + c2_);
            path_nm_ = 2 * n_ * film.thickness_nm * c2_;
        }
        float reflectance(float base_eta, float lambda_nm) const {
            const float c3 = std::sqrt(std::max(0.0f, 1 - sin2_ / (base_eta * base_eta)));  // none beyond total reflection
            const float s23 = (n_ * c2_ - base_eta * c3) / (n_ * c2_ + base_eta * c3),
                        p23 = (base_eta * c2_ - n_ * c3) / (base_eta * c2_ + n_ * c3);
            const float cos_phi = sincos_turns(path_nm_ / lambda_nm).cos;
            return 0.5f * (sum(s12_, s23, cos_phi) + sum(p12_, p23, cos_phi));
        }

     private:
        static float sum(float r12, float r23, float cos_phi) {
            const float product = r12 * r23, both = 2 * product * cos_phi;
            return std::min((r12 * r12 + r23 * r23 + both) / std::max(1 + product * product + both, 1e-12f), 1.0f);
        }
        float sin2_, n_, c2_, s12_, p12_, path_nm_;
    };
};

// The mean over the k wavelengths of a sample: it chooses between lobes where all wavelengths stay together.
inline float mean_of(const SampledSpectrum& values, std::uint32_t k) {
    float sum = 0;
    for (std::uint32_t i = 0; i < k; ++i) sum += values.v[i];
    return sum / static_cast<float>(k);
}

// The index of matter that reflects `f0` at normal incidence in air.
inline float index_of_reflectance(float f0) {
    const float root = std::sqrt(std::min(f0, 0.9999f));
    return (1 + root) / (1 - root);
}

}  // namespace latent::render
