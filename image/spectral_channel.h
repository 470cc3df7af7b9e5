// image/spectral_channel.h: names of channels in spectral OpenEXR files [Fichet21].
#pragma once

#include <optional>
#include <string_view>

namespace latent::image {

// Wavelength [nm] of a channel of emitted light, "S0.<number><unit>": "S0.550,000nm", "S0.0,55um", "S0.545THz". The number has a
// decimal comma (or point), the unit is metres or hertz with any prefix of SI. Nothing for any other name.
std::optional<double> emitted_wavelength_nm(std::string_view channel);

// True for "T.<number><unit>": a reflectance, which is no light.
bool is_reflectance(std::string_view channel);

}  // namespace latent::image
