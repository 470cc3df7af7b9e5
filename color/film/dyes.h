// color/film/dyes.h: the spectra of a material's three dyes, published or separated. Equations: docs/color.md, "Film".
#pragma once

#include <optional>

#include "base/result.h"
#include "color/film/material.h"
#include "color/film/spectra.h"

namespace latent::film {

struct Dyes {
    Curves unit;                  // cyan, magenta, yellow: peak density 1
    std::optional<Curve> base{};  // spectral density without image, if it was published
    double separation_rms = 0;    // density: how well the template fits, where the dyes were not published
};

// Errors: those of the table.
Result<Dyes> dyes_of(const Material& material);

}  // namespace latent::film
