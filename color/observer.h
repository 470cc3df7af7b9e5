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

enum class ObserverKind : std::uint8_t {
    kEye,     // X, Y, Z
    kCamera,  // r, g, b, as a sensor counts them
    kFilm,    // black and white: three equal curves, so it develops neutral
    kLayers,  // exposures of the layers of a film [lux s]: no colours before they are printed (color/film)
};

// Responses at wavelengths [nm] that strictly increase, at least two; linear between them and zero outside. The scale is arbitrary.
struct ResponseTable {
    std::string name;
    ObserverKind kind = ObserverKind::kEye;
    std::vector<double> lambda_nm{};
    std::vector<std::array<double, 3>> response{};
};

// Three response curves, linear between their knots and zero outside them. A pixel is the integral of radiance times response, for
// the CIE observers XYZ without the factor 683. Does not change once made: any thread.
class Observer {
 public:
    // Any observer of color/catalogue.h. Errors: kNotFound, naming those that are near.
    static Result<Observer> by_name(std::string_view name);
    static const Observer& cie1931();

    // From a table: rows of wavelength [nm] and three responses, or one (film: all three), separated by commas, semicolons, tabs or
    // blanks. `#` starts a comment; one line of column names may come first. A column whose name begins with "log10" holds
    // logarithms; three columns called r, g, b are a camera's; any other three are X, Y, Z. Wavelengths strictly increase,
    // responses are finite and not negative (logarithms may be). Between 400 and 700 nm no two rows are more than 30 nm apart, and
    // where the table ends within 420..660 nm it has fallen to a tenth of its largest response, unless it says that it is zero.
    // Errors: kCorrupt, "line 12: ..."; as of from_table.
    static Result<Observer> from_csv(std::string_view text, std::string name);

    // Brought to the scale of the CIE observers, so that exposures compare: D65 of Y = 1 (CIE 1931) gives 1 in the second curve of
    // an eye and of a film, and (1, 1, 1) with a camera. Errors: kOutOfRange if a curve does not respond to daylight, or far
    // less than others.
    static Result<Observer> from_table(ResponseTable table);
    // At the scale that the table has.
    static Observer as_given(ResponseTable table) { return Observer(std::move(table)); }

    const std::string& name() const { return name_; }
    ObserverKind kind() const { return kind_; }
    bool is_cie1931() const { return name_ == "cie1931"; }
    // What D65 looks like to it: the neutral of its pictures (`adoptedNeutral`). (1/3, 1/3) for a film; for a camera that of
    // CIE 1931, which its balanced values stand for. A filter in front changes the pictures, not what counts as neutral.
    Chromaticity neutral() const { return neutral_; }

    // A camera's channels, all with the scale of its green one: as its sensor counts them.
    Observer unbalanced() const;
    // A camera that sees X, Y, Z: `xyz_from_rgb` (color/camera.h) applied to its curves.
    Observer as_eye(const Matrix3& xyz_from_rgb) const;
    // Behind a filter of this transmittance, all curves multiplied by `factor`. Linear from nm to nm between the knots of both.
    Observer behind(const Spectrum& transmittance, std::string_view filter_name, double factor) const;

    // Exact between knots, zero outside; the same bits on every processor.
    std::array<double, 3> at(double lambda_nm) const;
    std::array<float, 3> operator()(float lambda_nm) const;  // at(), rounded
    // Knots [nm] and the responses there, for those who build their own lookup.
    std::span<const double> lambda_nm() const { return lambda_nm_; }
    std::span<const std::array<double, 3>> responses() const { return response_; }
    // Response `component` as a spectrum (for integrals), 0 = X, 1 = Y, 2 = Z.
    Spectrum curve(int component) const;

 private:
    explicit Observer(ResponseTable table);

    std::string name_;
    ObserverKind kind_;
    Chromaticity neutral_;
    std::array<double, 3> sensitivity_{1, 1, 1};  // a camera's channels as tabulated, relative to the second; 1 for curves
    std::vector<double> lambda_nm_;
    std::vector<std::array<double, 3>> response_;
    std::vector<std::uint32_t> knot_below_;  // guide: the knot at or below the first one + 0, 1, 2, ... nm
};

// Exact integral of s times the three curves over 360..830 nm.
Xyz xyz_from_spectrum(const Spectrum& s, const Observer& observer);

// pbrt's photometric sum: ybar(lambda) s(lambda) of CIE 1931 added over the integer nm of 360..830 (no 683). A light spectrum
// divided by it has Y = 1. Check: 1 over all wavelengths gives 106.856917.
double photometric_sum(const Spectrum& s);

}  // namespace latent::color
