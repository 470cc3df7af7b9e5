// color/tone_curve.h: tone curves, from luminance to the brightness of a print. Formulas: docs/color.md, "Tone curves".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::color {

// y' of an exposure t = sigma y: increasing, from 0 at t = 0 towards 1; 1/2 at t = 1 (without `black`).
class ToneCurve {
 public:
    ToneCurve() = default;  // that of the film: 1 - 2^-t

    // "film", "linear", "reinhard", "filmic", "density" or "density:GAMMA,TOE,SHOULDER". t is raised to the power `contrast`; what
    // is below `black` prints black, and the rest is stretched. Errors: kUsage, with the choices.
    static Result<ToneCurve> make(std::string_view name, double contrast, double black);

    const std::string& name() const { return name_; }
    bool is_film() const { return kind_ == Kind::kFilm && contrast_ == 1 && black_ == 0; }

    double operator()(double exposure) const;
    double exposure_of(double printed) const;  // the inverse

    // For rows of pixels: y', not yet clamped to 0..1, at 2^(kFirstOctave + i / kSteps), i = 0 .. kOctaves kSteps, linear in the
    // mantissa between these steps, in proportion to t below them, and level above. Empty for the plain film.
    static constexpr int kFirstOctave = -30, kOctaves = 54, kStepBits = 10;
    const std::vector<float>& table() const { return table_; }

 private:
    enum class Kind { kFilm, kLinear, kReinhard, kFilmic, kDensity };
    double plain(double t) const;
    double unclamped(double exposure) const;

    std::string name_ = "film";
    Kind kind_ = Kind::kFilm;
    double contrast_ = 1, black_ = 0;
    double gamma_ = 1.6, toe_ = 0.4, shoulder_ = 0.4;  // for kDensity
    double darkest_ = 0, middle_ = 1;                  // transmittance without light; exposure of 1/2
    std::vector<float> table_;
};

}  // namespace latent::color
