#include "color/rgb_to_spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "color/observer.h"

namespace latent::color {
namespace {

constexpr double kCentre = (kLambdaMin + kLambdaMax) / 2, kHalfWidth = (kLambdaMax - kLambdaMin) / 2;

using Vector3 = std::array<double, 3>;

double squared_length(const Vector3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

}  // namespace

float SigmoidSpectrum::operator()(float lambda_nm) const {
    const float t = (lambda_nm - static_cast<float>(kCentre)) * static_cast<float>(1 / kHalfWidth);
    const float x = (c0 * t + c1) * t + c2;
    // S(-|x|) = 1 / (2 w (w + |x|)), w = sqrt(1 + x^2): without cancellation.
    const float w = std::sqrt(1 + x * x), low = 0.5F / (w * (w + std::abs(x)));
    return scale * (x < 0 ? low : 1 - low);
}

float SigmoidSpectrum::max_value() const {
    const float first = (*this)(static_cast<float>(kLambdaMin)), last = (*this)(static_cast<float>(kLambdaMax));
    const float apex = std::clamp(c0 != 0 ? -c1 / (2 * c0) : 0.0F, -1.0F, 1.0F);  // where the parabola has its apex, in t
    return std::max({first, last, (*this)(static_cast<float>(kCentre) + static_cast<float>(kHalfWidth) * apex)});
}

RgbToSpectrum::RgbToSpectrum(const RgbSpace& space, const Spectrum& illuminant) : illuminant_(illuminant) {
    // The space's own white is rounded to four decimals; the illuminant's chromaticity makes a constant 1 exactly (1,1,1).
    const Observer& cie = Observer::cie1931();
    Xyz white;
    for (int i = 0; i < kIntegerNmCount; ++i) {
        const double power = illuminant(kLambdaMin + i);
        const auto& response = cie.responses()[i];
        weight_[i] = {response[0] * power, response[1] * power, response[2] * power};
        white = {white.x + weight_[i][0], white.y + weight_[i][1], white.z + weight_[i][2]};
    }
    Primaries primaries = space.primaries;
    primaries.white = chromaticity(white);
    const auto exact = RgbSpace::from_primaries(space.name, primaries, space.transfer);
    assert(exact);
    const Matrix3 rgb_from_power = exact->rgb_from_xyz * (1 / white.y);
    for (Vector3& weight : weight_) weight = rgb_from_power * weight;
}

SigmoidSpectrum RgbToSpectrum::reflectance(Rgb rgb) const {
    const auto clamped = [](double v) { return v > 0 ? std::min(v, 1.0) : 0.0; };
    const Rgb inside{clamped(rgb.r), clamped(rgb.g), clamped(rgb.b)};
    return spectrum_of(inside, std::min(1.0, 2 * std::max({inside.r, inside.g, inside.b})));
}

SigmoidSpectrum RgbToSpectrum::unbounded(Rgb rgb) const {
    const auto clamped = [](double v) { return v > 0 ? std::min(v, 1e30) : 0.0; };
    const Rgb inside{clamped(rgb.r), clamped(rgb.g), clamped(rgb.b)};
    return spectrum_of(inside, 2 * std::max({inside.r, inside.g, inside.b}));
}

SigmoidSpectrum RgbToSpectrum::spectrum_of(Rgb rgb, double scale) const {
    if (scale == 0) return {};
    if (rgb.r == rgb.g && rgb.g == rgb.b) return {.scale = static_cast<float>(2 * rgb.r)};  // S(0) = 1/2, exactly
    const Vector3 c = coefficients_of({rgb.r / scale, rgb.g / scale, rgb.b / scale});
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), static_cast<float>(scale)};
}

RgbToSpectrum::Linearised RgbToSpectrum::linearised_at(const Vector3& c) const {
    Linearised out{{}, Matrix3{{}}};
    for (int i = 0; i < kIntegerNmCount; ++i) {
        const double t = (kLambdaMin + i - kCentre) / kHalfWidth;
        const double x = (c[0] * t + c[1]) * t + c[2], w = std::sqrt(1 + x * x);
        const double s = 0.5 + 0.5 * x / w, slope = 0.5 / (w * w * w);
        for (int k = 0; k < 3; ++k) {
            const double d = weight_[i][k] * slope;
            out.rgb[k] += weight_[i][k] * s;
            out.jacobian.m[k][0] += d * t * t;
            out.jacobian.m[k][1] += d * t;
            out.jacobian.m[k][2] += d;
        }
    }
    return out;
}

// Levenberg-Marquardt from the grey of the same mean. Every colour of sRGB is met to 1e-6 within 20 steps; what no reflectance of
// this family can be (corners of wide gamuts) ends at the step limit with the nearest one found.
std::array<double, 3> RgbToSpectrum::coefficients_of(const Vector3& target) const {
    constexpr int kMaxSteps = 60;
    constexpr double kTolerance = 1e-6, kLargestCoefficient = 1e6;
    const double grey = std::clamp((target[0] + target[1] + target[2]) / 3, 0.02, 0.98);
    Vector3 c{0, 0, (grey - 0.5) / std::sqrt(grey * (1 - grey))};  // S(c2) = grey
    const auto error_of = [&](const Vector3& rgb) { return Vector3{rgb[0] - target[0], rgb[1] - target[1], rgb[2] - target[2]}; };
    Linearised here = linearised_at(c);
    double damping = 1e-3;
    for (int step = 0; step < kMaxSteps; ++step) {
        const Vector3 error = error_of(here.rgb);
        if (squared_length(error) < kTolerance * kTolerance) break;
        const Matrix3 transposed = here.jacobian.transposed();
        Matrix3 normal = transposed * here.jacobian;
        for (int a = 0; a < 3; ++a) normal.m[a][a] *= 1 + damping;
        damping *= 10;  // if this step fails
        if (!normal.invertible()) continue;
        const Vector3 delta = normal.inverse() * (transposed * error);
        const Vector3 next{c[0] - delta[0], c[1] - delta[1], c[2] - delta[2]};
        if (squared_length(next) > kLargestCoefficient * kLargestCoefficient) continue;
        const Linearised there = linearised_at(next);
        if (squared_length(error_of(there.rgb)) >= squared_length(error)) continue;
        c = next;
        here = there;
        damping = std::max(damping / 100, 1e-9);
    }
    return c;
}

Rgb RgbToSpectrum::rgb_of(const SigmoidSpectrum& s) const {
    Vector3 rgb{};
    for (int i = 0; i < kIntegerNmCount; ++i) {
        const double value = s(static_cast<float>(kLambdaMin + i));
        for (int k = 0; k < 3; ++k) rgb[k] += weight_[i][k] * value;
    }
    return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace latent::color
