// color/film/stock.h: a colour film or print material as densities of three dyes. Equations: docs/color.md, "Film".
#pragma once

#include <vector>

#include "base/result.h"
#include "color/film/material.h"
#include "color/film/spectra.h"

namespace latent::film {

// How far dye forming in a layer holds back the others, per unit amount of dye: neighbours, and red and blue.
struct Coupling {
    double adjacent = 0, far = 0;

    // How much two layers (0 to 2) influence each other; 0 for a layer and itself.
    double between(std::size_t a, std::size_t b) const { return a == b ? 0 : a + b == 2 ? far : adjacent; }
};

class Stock {
 public:
    // `material` must be a colour film or paper. Errors: those of its tables.
    static Result<Stock> make(const Material& material);

    const Material& material() const { return material_; }
    // log10 exposures of the curves, 0.05 apart: in lux s for camera films, on their own scale for print materials.
    const std::vector<double>& log_exposures() const { return h_; }
    const Curve& base() const { return base_; }                   // spectral density without image
    const Curves& dyes() const { return dyes_; }                  // spectral density of a unit amount
    const Curves& sensitivities() const { return sensitivity_; }  // see sensitivity_scale in docs/color.md, "Film"
    double separation_rms() const { return separation_rms_; }     // if dyes are separated by the template; 0: published dyes

    // The same, developed longer by these stops.
    Stock pushed(double stops) const;

    // Amounts of dye, each of its layer's log exposure.
    Triple amounts(const Triple& h) const;
    double amount(std::size_t layer, double h) const;
    // The log exposure at which a layer forms this amount.
    double exposure_for(std::size_t layer, double amount) const;
    Triple min_amounts() const;
    Triple max_amounts() const;

    // Layers hold each other back; neutral exposures stay as they are.
    Triple coupled(const Triple& h, const Coupling& coupling) const;
    // What notes give for the kind of material: 0.20, 0.10 for negatives, 0.06, 0.03 for slides, none for prints.
    Coupling usual_coupling() const;

    Curve density(const Triple& amounts) const;
    const Curves& densitometer_weights() const { return weights_; }
    // As the densitometer of its data sheet reads it.
    Triple integral_density(const Triple& amounts) const;

 private:
    Material material_;
    std::vector<double> h_;
    std::array<std::vector<double>, 3> amount_;  // by layer, at h_
    Curve base_;
    Curves dyes_, sensitivity_, weights_;
    double separation_rms_ = 0;
    double push_ = 0;
    Triple shoulder_from_{}, shoulder_slope_{};  // for negatives: where the plot ends, and the contrast there
};

// Amounts whose integral densities by `weights` (each adds up to 1) are `target`: Newton, from `start`.
Triple unmixed(const Triple& target, const Curve& base, const Curves& dyes, const Curves& weights, Triple start = {});

// What a negative still gains beyond the end of its plot, `beyond` in log exposure, of this contrast there: up to 0.5.
double shoulder(double beyond, double contrast);

// h where the monotone y(h) is `at`; its ends go on.
double inverted(std::span<const double> h, std::span<const double> y, double at);

}  // namespace latent::film
