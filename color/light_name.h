// color/light_name.h: lights as people name them on command lines: "D65", "A", "E", "F1" to "F12", "5200K".
#pragma once

#include <span>
#include <string_view>

#include "base/result.h"
#include "color/spectrum.h"

namespace latent::color {

inline constexpr double kMinKelvin = 1000, kDaylightKelvin = 4000, kMaxKelvin = 25000;

// True for a number and K: "5200K", "5200k".
bool is_temperature(std::string_view text);
// Kelvin. Errors: kUsage outside 1000..25000 K.
Result<double> parse_temperature(std::string_view text);

// The spectrum, at any scale. A temperature means daylight from 4000 K on, and a blackbody below. Errors: kNotFound; kUsage for
// temperatures as above.
Result<Spectrum> light_by_name(std::string_view text);

struct NamedLight {
    std::string_view name, what;
};
// All that are not temperatures.
std::span<const NamedLight> named_lights();

}  // namespace latent::color
