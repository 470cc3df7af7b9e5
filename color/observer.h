// color/observer.h: who looks: three response curves over wavelength. Equations: docs/color.md, "Observers".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"
#include "color/tristimulus.h"

namespace latent::color {

// Three response curves, linear between their knots and zero outside them. A pixel is the integral of radiance times response, for
// the CIE observers XYZ without the factor 683. A black-and-white film has three equal curves, so it develops neutral: X = Y = Z.
class Observer {
 public:
    // Names: cie1931 (2 degree), cie1964 (10 degree), cie2015-2, cie2015-10. Errors: kNotFound, listing them.
    static Result<Observer> by_name(std::string_view name);
    static const Observer& cie1931();

    // From a table: rows of wavelength [nm] and three responses, or one (film: all three), separated by commas, semicolons, tabs or
    // blanks. `#` starts a comment; one line of column names may come first. A column whose name begins with "log10" holds
    // logarithms; three columns called r, g, b are a camera's and are combined into X, Y, Z by xyz_from_camera; any other three are
    // X, Y, Z as they are. Wavelengths strictly increase, responses are finite and not negative (logarithms may be).
    // Such scales are arbitrary, so all curves are multiplied by one factor that makes D65 of Y = 1 (CIE 1931) answer with 1 in the
    // second (or only) curve: exposures then compare with those of the CIE observers.
    // Errors: kCorrupt, "line 12: ..."; kOutOfRange if the curves of a camera do not differ.
    static Result<Observer> from_csv(std::string_view text, std::string name);

    const std::string& name() const { return name_; }
    bool is_cie1931() const { return name_ == "cie1931"; }

    // Exact between knots, zero outside; the same bits on every processor.
    std::array<double, 3> at(double lambda_nm) const;
    std::array<float, 3> operator()(float lambda_nm) const;  // at(), rounded
    // Knots [nm] and the responses there, for those who build their own lookup.
    std::span<const double> lambda_nm() const { return lambda_nm_; }
    std::span<const std::array<double, 3>> responses() const { return response_; }
    // Response `component` as a spectrum (for integrals), 0 = X, 1 = Y, 2 = Z.
    Spectrum curve(int component) const;

 private:
    Observer(std::string name, std::vector<double> lambda_nm, std::vector<std::array<double, 3>> response);
    static Observer from_table(std::string_view name, std::string_view table);

    std::string name_;
    std::vector<double> lambda_nm_;
    std::vector<std::array<double, 3>> response_;
    std::vector<std::uint32_t> knot_below_;  // guide: the knot at or below the first one + 0, 1, 2, ... nm
};

// Exact integral of s times the three curves over 360..830 nm.
Xyz xyz_from_spectrum(const Spectrum& s, const Observer& observer);

// pbrt's photometric sum: ybar(lambda) s(lambda) of CIE 1931 added over the integer nm of 360..830 (no 683). A light spectrum
// divided by it has Y = 1. Check: 1 over all wavelengths gives 106.856917.
double photometric_sum(const Spectrum& s);

// Chromaticity of D65 under the observer: the neutral of developed pictures (`adoptedNeutral`). (1/3, 1/3) for a film.
Chromaticity d65_chromaticity(const Observer& observer);

}  // namespace latent::color
