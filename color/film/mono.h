// color/film/mono.h: films and papers in black and white: one curve, chosen among those of the data sheet.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "color/film/material.h"

namespace latent::film {

struct MonoCurve {
    std::vector<double> log_exposure, density;
};

// The curve of the time of development whose contrast is nearest to that of ISO 6: a density of 0.8 over 1.3 in log exposure;
// pushed by these stops. Errors: of the tables.
Result<MonoCurve> mono_film(const Material& film, double push);

// The curve of a contrast filter, "00", "0", "1" .. "5"; "": none. Errors: kUsage, naming those that the paper has.
Result<MonoCurve> mono_paper(const Material& paper, const std::string& contrast_filter);

}  // namespace latent::film
