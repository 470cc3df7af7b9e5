#include "color/tone_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parse.h"

namespace latent::color {
namespace {

constexpr double kDensityRange = 3;  // from the darkest to the clearest part of a slide

// [Narkowicz16], scaled to 1/2 at t = 1.
double filmic(double t) {
    constexpr double kScale = 0.3563298719772006;
    const double x = kScale * t;
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

// Transmittance of a slide: at exposure 1 its straight line ends in the shoulder, and kDensityRange / gamma decades below in the
// toe.
double transmittance(double t, double gamma, double toe, double shoulder) {
    const double toe_at = std::pow(10, -kDensityRange / gamma);
    const double rise = toe * std::log10(1 + std::pow(t / toe_at, 1 / toe)),
                 fall = shoulder * std::log10(1 + std::pow(t, 1 / shoulder));
    return std::pow(10, gamma * (rise - fall) - kDensityRange);
}

// f(t) = value, for a function that increases.
template <class F>
double inverse(const F& f, double value) {
    double low = -60, high = 60;  // octaves
    for (int i = 0; i < 200; ++i) {
        const double middle = (low + high) / 2;
        (f(std::exp2(middle)) < value ? low : high) = middle;
    }
    return std::exp2(high);
}

}  // namespace

Result<ToneCurve> ToneCurve::make(std::string_view name, double contrast, double black) {
    ToneCurve curve;
    curve.name_ = name;
    curve.contrast_ = contrast;
    curve.black_ = black;
    const std::string_view kind = name.substr(0, name.find(':'));
    if (kind == "film")
        curve.kind_ = Kind::kFilm;
    else if (kind == "linear")
        curve.kind_ = Kind::kLinear;
    else if (kind == "reinhard")
        curve.kind_ = Kind::kReinhard;
    else if (kind == "filmic")
        curve.kind_ = Kind::kFilmic;
    else if (kind == "density")
        curve.kind_ = Kind::kDensity;
    else
        curve.name_.clear();
    if (curve.name_.empty() || (kind.size() < name.size() && curve.kind_ != Kind::kDensity))
        return is_not(name, "a tone curve (choose film, linear, reinhard, filmic, density, density:GAMMA,TOE,SHOULDER or none)");
    if (kind.size() < name.size()) {
        const auto numbers = parse_numbers(name.substr(kind.size() + 1));
        const auto within = [](double v, double least, double most) { return v >= least && v <= most; };
        if (!numbers || numbers->size() != 3 || !within((*numbers)[0], 0.2, 5) || !within((*numbers)[1], 0.05, 3) ||
            !within((*numbers)[2], 0.05, 3))
            return usage_error(
                fmt::format("'{}': gamma must be 0.2 to 5, toe and shoulder 0.05 to 3 (try "
                            "density:1.6,0.4,0.4)",
                            name));
        curve.gamma_ = (*numbers)[0], curve.toe_ = (*numbers)[1], curve.shoulder_ = (*numbers)[2];
    }
    if (curve.kind_ == Kind::kDensity) {
        curve.darkest_ = transmittance(0, curve.gamma_, curve.toe_, curve.shoulder_);
        curve.middle_ = inverse([&](double t) { return curve.plain(t); }, 0.5);
    }
    if (curve.is_film()) return curve;
    constexpr int kSteps = 1 << kStepBits;
    for (int i = 0; i <= kOctaves * kSteps; ++i)
        curve.table_.push_back(static_cast<float>(
            std::min(2.0, curve.unclamped(std::ldexp(1 + static_cast<double>(i % kSteps) / kSteps, kFirstOctave + i / kSteps)))));
    curve.table_.push_back(curve.table_.back());
    return curve;
}

double ToneCurve::plain(double t) const {
    switch (kind_) {
        case Kind::kFilm:
            return -std::expm1(-t * 0.693147180559945309);
        case Kind::kLinear:
            return t / 2;
        case Kind::kReinhard:
            return t / (1 + t);
        case Kind::kFilmic:
            return filmic(t);
        case Kind::kDensity:
            return (transmittance(t * middle_, gamma_, toe_, shoulder_) - darkest_) / (1 - darkest_);
    }
    return 0;
}

double ToneCurve::unclamped(double exposure) const {
    const double t = std::min(contrast_ == 1 ? exposure : std::pow(exposure, contrast_), 0x1p80);
    return (plain(t) - black_) / (1 - black_);
}

double ToneCurve::operator()(double exposure) const { return exposure > 0 ? std::clamp(unclamped(exposure), 0.0, 1.0) : 0; }

double ToneCurve::exposure_of(double printed) const {
    return inverse([this](double t) { return (*this)(t); }, printed);
}

}  // namespace latent::color
