// color/spectrum.h: a function of wavelength, piecewise linear between samples. Equations: docs/color.md, "Spectra".
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/result.h"

namespace latent::color {

// The range that everything is integrated over, and its integer wavelengths.
inline constexpr double kLambdaMin = 360, kLambdaMax = 830;
inline constexpr int kIntegerNmCount = 471;

enum class Outside {
    kZero,     // nothing beyond the first and last sample (spectra written in scenes and files)
    kClamped,  // the end values go on for ever (named tables, constants)
};

class Spectrum {
 public:
    Spectrum() = default;  // zero everywhere

    // Linear between (lambda_nm[i], value[i]). Errors: kOutOfRange unless there is at least one sample, the counts agree,
    // wavelengths strictly increase and everything is finite.
    static Result<Spectrum> from_samples(std::vector<double> lambda_nm, std::vector<double> value, Outside outside);
    // Linear between f(360), f(361), ..., f(830), which are finite.
    static Spectrum from_function(const std::function<double(double lambda_nm)>& f, Outside outside);
    static Spectrum constant(double value);
    // Planck's law, 1 at its peak lambda_max = 2897.771955 um K / T, sampled at every integer nm of 360..830 and zero outside.
    //   B(lambda) ~ lambda^-5 / (exp(c2 / (lambda T)) - 1),  c2 = h c / k = 1.438776877e7 nm K      [CODATA18]
    // Errors: kOutOfRange unless 0 < T < infinity.
    static Result<Spectrum> blackbody(double temperature_kelvin);

    double operator()(double lambda_nm) const;
    std::span<const double> lambda_nm() const { return lambda_nm_; }
    std::span<const double> values() const { return value_; }
    Outside outside() const { return outside_; }
    double max_value() const;  // over all wavelengths
    double min_value() const;

    Spectrum scaled(double factor) const;

 private:
    std::vector<double> lambda_nm_, value_;
    Outside outside_ = Outside::kZero;
};

// Integral of a(lambda) b(lambda) over 360..830 nm, exact for piecewise linear a and b (Simpson's rule between all their knots).
double integral_of_product(const Spectrum& a, const Spectrum& b);

// A spectrum known at 360, 361, ..., 830 nm only.
struct IntegerNmSpectrum {
    std::array<float, kIntegerNmCount> value{};
};
IntegerNmSpectrum sampled_at_integer_nm(const Spectrum& s);

}  // namespace latent::color
