// render/load/pbrt/measured_media.h: translucent materials by name, as they were measured [Jensen01].
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "color/spectrum.h"

namespace latent::render {

struct MeasuredMedium {
    color::Spectrum sigma_a, sigma_s;  // 1/mm; sigma_s is reduced: for isotropic scattering
};
std::optional<MeasuredMedium> measured_medium(std::string_view name);
std::string measured_media();  // their names

}  // namespace latent::render
