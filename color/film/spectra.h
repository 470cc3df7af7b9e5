// color/film/spectra.h: spectra at every nm from 380 to 780, which sums stand for integrals over. No libm: they decide pixels.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "color/spectrum.h"

namespace latent::film {

inline constexpr int kFirstNm = 380;
inline constexpr std::size_t kNm = 401;

using Curve = std::array<double, kNm>;  // at 380, 381, ..., 780 nm
using Curves = std::array<Curve, 3>;    // red-, green- and blue-sensitive layer, or X, Y, Z
using Triple = std::array<double, 3>;   // one number for each layer: r, g, b; their dyes are cyan, magenta, yellow

// y at `at`, linear between (x[i], y[i]); `x` increases. The end values go on.
double interpolated(double at, std::span<const double> x, std::span<const double> y);
Curve sampled(std::span<const double> lambda_nm, std::span<const double> y);  // the same at each nm

// Sum of a b.
double dot(const Curve& a, const Curve& b);
// 10^-density.
Curve transmittance(const Curve& density);

// "D50", "D55", "D65": daylight; "3200K", "A" (2856 K): a blackbody. Of any scale.
color::Spectrum light_spectrum(std::string_view name);
// The same with Y = 1 of matching(), as a sum.
Curve light(std::string_view name);
const Curves& matching();  // colour matching functions of CIE 1931
// Densitometer of status 'A' or 'M' [ISO5-3]: weights, the sum of each is 1.
Curves densitometer(char status);
// The same as the eye: light of 2856 K, V(lambda) [ISO5-3].
Curve visual_densitometer();

// x^(1/3), x > 0.
double cube_root(double x);
// CIELAB of XYZ under a white.
Triple lab(const Triple& xyz, const Triple& white);

// The solution of m x = y; `m` is not singular.
Triple solve(const std::array<Triple, 3>& m, const Triple& y);

}  // namespace latent::film
