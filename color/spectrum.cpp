#include "color/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace latent::color {

Result<Spectrum> Spectrum::from_samples(std::vector<double> lambda_nm, std::vector<double> value, Outside outside) {
    if (lambda_nm.empty() || lambda_nm.size() != value.size()) {
        return Error{ErrorCode::kOutOfRange, fmt::format("a spectrum needs pairs of wavelength and value: {} and {} given",
                                                         lambda_nm.size(), value.size())};
    }
    for (std::size_t i = 0; i < lambda_nm.size(); ++i) {
        if (!std::isfinite(lambda_nm[i]) || !std::isfinite(value[i])) {
            return Error{ErrorCode::kOutOfRange,
                         fmt::format("sample {} of a spectrum is not finite: {} nm, {}", i, lambda_nm[i], value[i])};
        }
        if (i > 0 && lambda_nm[i] <= lambda_nm[i - 1]) {
            return Error{ErrorCode::kOutOfRange, fmt::format("wavelengths of a spectrum must increase: {} nm follows {} nm",
                                                             lambda_nm[i], lambda_nm[i - 1])};
        }
    }
    Spectrum s;
    s.lambda_nm_ = std::move(lambda_nm);
    s.value_ = std::move(value);
    s.outside_ = outside;
    return s;
}

Spectrum Spectrum::from_function(const std::function<double(double)>& f, Outside outside) {
    Spectrum s;
    for (int i = 0; i < kIntegerNmCount; ++i) {
        s.lambda_nm_.push_back(kLambdaMin + i);
        s.value_.push_back(f(kLambdaMin + i));
    }
    s.outside_ = outside;
    return s;
}

Spectrum Spectrum::constant(double value) {
    Spectrum s;
    s.lambda_nm_ = {kLambdaMin, kLambdaMax};
    s.value_ = {value, value};
    s.outside_ = Outside::kClamped;
    return s;
}

Result<Spectrum> Spectrum::blackbody(double temperature_kelvin) {
    if (!(temperature_kelvin > 0) || !std::isfinite(temperature_kelvin)) {
        return Error{ErrorCode::kOutOfRange,
                     fmt::format("a blackbody needs a positive temperature in kelvin, not {}", temperature_kelvin)};
    }
    constexpr double kC2 = 1.438776877e7, kWien = 2.897771955e6;  // nm K
    // Relative to the peak: (peak / lambda)^5 (exp(c2 / (peak T)) - 1) / (exp(c2 / (lambda T)) - 1); no overflow in between.
    const double peak_nm = kWien / temperature_kelvin;
    const double at_peak = std::expm1(kC2 / kWien);
    return from_function(
        [&](double lambda) { return std::pow(peak_nm / lambda, 5) * at_peak / std::expm1(kC2 / (lambda * temperature_kelvin)); },
        Outside::kZero);
}

double Spectrum::operator()(double lambda_nm) const {
    if (lambda_nm_.empty()) return 0;
    if (lambda_nm < lambda_nm_.front()) return outside_ == Outside::kClamped ? value_.front() : 0;
    if (lambda_nm >= lambda_nm_.back()) return outside_ == Outside::kClamped || lambda_nm == lambda_nm_.back() ? value_.back() : 0;
    const std::size_t i = static_cast<std::size_t>(std::ranges::upper_bound(lambda_nm_, lambda_nm) - lambda_nm_.begin()) - 1;
    const double t = (lambda_nm - lambda_nm_[i]) / (lambda_nm_[i + 1] - lambda_nm_[i]);
    return value_[i] + t * (value_[i + 1] - value_[i]);
}

double Spectrum::max_value() const {
    const double within = value_.empty() ? 0 : *std::ranges::max_element(value_);
    return outside_ == Outside::kZero ? std::max(within, 0.0) : within;
}

double Spectrum::min_value() const {
    const double within = value_.empty() ? 0 : *std::ranges::min_element(value_);
    return outside_ == Outside::kZero ? std::min(within, 0.0) : within;
}

Spectrum Spectrum::scaled(double factor) const {
    Spectrum s = *this;
    for (double& value : s.value_) value *= factor;
    return s;
}

namespace {

// Value just right (side = +1) or just left (side = -1) of a wavelength: they differ where a spectrum that is zero outside ends.
double one_sided(const Spectrum& s, double lambda_nm, int side) {
    if (s.lambda_nm().empty()) return 0;
    const bool outside = side > 0 ? lambda_nm >= s.lambda_nm().back() : lambda_nm <= s.lambda_nm().front();
    return outside && s.outside() == Outside::kZero ? 0 : s(lambda_nm);
}

}  // namespace

double integral_of_product(const Spectrum& a, const Spectrum& b) {
    std::vector<double> knots{kLambdaMin, kLambdaMax};
    for (const Spectrum* s : {&a, &b}) {
        for (const double lambda : s->lambda_nm()) {
            if (lambda > kLambdaMin && lambda < kLambdaMax) knots.push_back(lambda);
        }
    }
    std::ranges::sort(knots);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double left = knots[i], right = knots[i + 1], middle = (left + right) / 2;
        sum += (right - left) / 6 *
               (one_sided(a, left, 1) * one_sided(b, left, 1) + 4 * a(middle) * b(middle) +
                one_sided(a, right, -1) * one_sided(b, right, -1));
    }
    return sum;
}

IntegerNmSpectrum sampled_at_integer_nm(const Spectrum& s) {
    IntegerNmSpectrum out;
    for (int i = 0; i < kIntegerNmCount; ++i) out.value[i] = static_cast<float>(s(kLambdaMin + i));
    return out;
}

}  // namespace latent::color
