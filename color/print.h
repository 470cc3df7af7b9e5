// color/print.h: from developed XYZ to a display's linear RGB: tone, luminance, gamut. Equations: docs/color.md, "The print".
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "base/result.h"
#include "color/rgb_space.h"
#include "color/tone_curve.h"
#include "color/tristimulus.h"

namespace latent::color {

enum class Tone {
    kFilm,   // y' = 1 - 2^(-sigma y)
    kCurve,  // y' = PrintSettings::curve(sigma y)
    kNone,   // y' = sigma y: only converts; no gamut mapping, values leave [0,1]
};
enum class Gamut {
    kLuminance,  // clamp, then scale or fade to white until the luminance is y' again [R06 5.3.3]
    kGrey,       // straight towards the grey (y',y',y') until inside: keeps hue better, the same luminance
    kClip,       // clamp and leave it; neither luminance nor hue is kept
};
Result<Gamut> gamut_by_name(std::string_view name);  // "luminance", "grey", "clip"

// Pixels, by what happened to them.
struct PrintReport {
    std::uint64_t pixels = 0;
    std::uint64_t nan = 0;           // y is NaN: black
    std::uint64_t negative = 0;      // y < 0: black
    std::uint64_t infinite = 0;      // y = +Inf: white
    std::uint64_t colourless = 0;    // x or z is not finite: grey y'
    std::uint64_t out_of_gamut = 0;  // a component left [0,1] by more than 1e-5 before it was mapped
    std::uint64_t clipped = 0;       // those among them that Gamut::kClip cut off
    std::uint64_t black = 0;         // y is below the printable range
    std::uint64_t burnt = 0;         // y is above it

    PrintReport& operator+=(const PrintReport& other);
    bool operator==(const PrintReport&) const = default;
};

// Luminances that a display shows as neither black nor white: from `black` to `burnt`.
struct PrintableRange {
    float black = -std::numeric_limits<float>::infinity(), burnt = std::numeric_limits<float>::infinity();
};

struct PrintSettings {
    double sigma = 1;  // sensitivity of the film: y' = 1/2 at y = 1/sigma
    Tone tone = Tone::kFilm;
    Gamut gamut = Gamut::kLuminance;
    Matrix3 adaptation{};    // from the picture's white to the space's (color/adaptation.h); y is the Y after it
    ToneCurve curve{};       // for Tone::kCurve
    PrintableRange range{};  // what is counted as black and burnt
};

// sigma pushed by `stops`: sigma 2^stops.
double pushed_sigma(double sigma, double stops);

class Print {
 public:
    // Errors: kOutOfRange if sigma is not positive and finite; for kLuminance and kGrey, if the space's luminance row is refused.
    static Result<Print> create(const RgbSpace& space, const PrintSettings& settings);

    // One pixel in double: the reference. Except with Tone::kNone, the result is in [0,1], and m . rgb = y' unless the gamut is
    // clipped.
    Rgb pixel(Xyz xyz, PrintReport& report) const;

    // The colour of a pixel before it is mapped into the gamut; nothing for those that have none, or are black.
    std::optional<Rgb> unmapped(Xyz xyz) const;
    bool out_of_gamut(const Rgb& unmapped) const;

    // The same in float over whole rows (planes of equal length; out may be in), with the processor's widest instructions and the
    // same bits whatever these are. With Tone::kFilm: in [0,1], |m . rgb - y'| < 1e-6. `luminances` takes y after adaptation, or
    // nothing if it is empty.
    void row(std::span<const float> x, std::span<const float> y, std::span<const float> z, std::span<float> r, std::span<float> g,
             std::span<float> b, PrintReport& report, std::span<float> luminances = {}) const;

    const PrintableRange& range() const { return range_; }

 private:
    Print() = default;
    double sigma_ = 1;
    Tone tone_ = Tone::kFilm;
    Gamut gamut_ = Gamut::kLuminance;
    std::array<double, 3> y_row_{};  // y after adaptation = y_row . (x, y, z)
    ToneCurve curve_;
    PrintableRange range_;
    Matrix3 rgb_from_xyz_;       // adaptation included
    std::array<double, 3> m_{};  // luminance row
};

}  // namespace latent::color
