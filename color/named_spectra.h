// color/named_spectra.h: measured spectra by pbrt's names, and the CIE's daylight. Numbers: color/data/README.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "color/spectrum.h"
#include "color/tristimulus.h"

namespace latent::color {

// glass-{BK7,BAF10,FK51A,LASF9,SF5,SF10,SF11} (and pbrt's F5, F10, F11 for the SF types),
// metal-{Ag,Al,Au,Cu,CuZn,MgO,TiO2}-{eta,k}, stdillum-{A,D50,D65,F1..F12}, illum-acesD60. All go on beyond their range by their end
// values. Where pbrt's table is wrong (D50, some F lamps) this is the CIE's. Errors: kNotFound, naming the nearest names.
Result<Spectrum> named_spectrum(std::string_view name);
std::vector<std::string> named_spectrum_names();

// The daylight that print white, RGB lights and `adoptedNeutral` refer to: stdillum-D65.
const Spectrum& illuminant_d65();

// Chromaticity of the CIE daylight phase with correlated colour temperature T = `cct_kelvin`.
//   x = -4.6070e9/T^3 + 2.9678e6/T^2 + 0.09911e3/T + 0.244063    for  4000 <= T <=  7000
//   x = -2.0064e9/T^3 + 1.9018e6/T^2 + 0.24748e3/T + 0.237040    for  7000 <  T <= 25000
//   y = -3 x^2 + 2.87 x - 0.275
// Returns (x, y) for the CIE 1931 2-degree observer. Errors: kOutOfRange outside 4000..25000 K.
// Source: [WyszeckiStiles00] pp. 145-146. Check: 6504 K gives (0.3127, 0.3291), i.e. D65.
Result<Chromaticity> daylight_chromaticity(double cct_kelvin);

// Spectrum of that daylight phase, 300..830 nm, near 100 at 560 nm:
//   S = S0 + M1 S1 + M2 S2,  M = 0.0241 + 0.2562 x - 0.7341 y,
//   M1 = (-1.3515 - 1.7703 x + 5.9114 y) / M,  M2 = (0.0300 - 31.4424 x + 30.0717 y) / M     [CIE15]
// with M1 and M2 rounded to three decimals, as the CIE's own tables of D50, D65, ... are. Errors: kOutOfRange as above.
Result<Spectrum> daylight(double cct_kelvin);

}  // namespace latent::color
