#include "render/texture/procedural.h"

#include "render/math/elementary.h"
#include "render/texture/noise.h"

namespace latent::render {

namespace {

// A wave that is 1 over [0,1) and -1 over [1,2), filtered by a triangle that reaches r to both sides: the second difference of its
// second integral, of which only the periodic part counts.
double filtered_wave(double x, double r) {
    const double cell = std::floor(x);
    if (!(r > 0) || std::floor(x - r) == std::floor(x + r)) return std::fmod(cell, 2) == 0 ? 1 : -1;
    if (!(r < 1e6)) return 0;
    const auto second_integral = [](double at) {
        const double y = at / 2 - std::floor(at / 2) - 0.5;
        return y * (1 - 2 * std::abs(y));
    };
    const double near = std::fmod(x, 2.0);
    return (second_integral(near + r) - 2 * second_integral(near) + second_integral(near - r)) / (r * r);
}
float fraction(float x) {
    const float part = x - std::floor(x);
    return part >= 0 && part < 1 ? part : 0;  // where floats end, too
}
double filtered_wave(float x, float dx, float dy) { return filtered_wave(x, 1.5 * std::max(std::abs(dx), std::abs(dy))); }

}  // namespace

float checkerboard(const TextureCoordinates& c) {
    return static_cast<float>(0.5 -
                              0.5 * filtered_wave(c.st.x, c.dstdx.x, c.dstdy.x) * filtered_wave(c.st.y, c.dstdx.y, c.dstdy.y));
}

float checkerboard(const SpacePoint& c) {
    return static_cast<float>(0.5 - 0.5 * filtered_wave(c.p.x, c.dpdx.x, c.dpdy.x) * filtered_wave(c.p.y, c.dpdx.y, c.dpdy.y) *
                                        filtered_wave(c.p.z, c.dpdx.z, c.dpdy.z));
}

bool inside_dot(Vec2f st) {
    constexpr float kRadius = 0.35f, kShift = 0.5f - kRadius;
    const float s = std::floor(st.x + 0.5f), t = std::floor(st.y + 0.5f);
    const auto draw = [&](float ds, float dt) { return noise({s + ds, t + dt, 0.5f}); };
    if (draw(0.5f, 0.5f) <= 0) return false;
    const float x = st.x - (s + kShift * draw(1.5f, 2.8f)), y = st.y - (t + kShift * draw(4.5f, 9.8f));
    return x * x + y * y < kRadius * kRadius;
}

std::array<float, 3> marble_colour(float t) {
    static constexpr float kControl[9][3] = {{.58f, .58f, .6f}, {.58f, .58f, .6f}, {.58f, .58f, .6f},
                                             {.5f, .5f, .5f},   {.6f, .59f, .58f}, {.58f, .58f, .6f},
                                             {.58f, .58f, .6f}, {.2f, .2f, .33f},  {.58f, .58f, .6f}};
    constexpr std::size_t kPieces = 6;  // cubic Bezier curves, each beginning one control point after the other
    const float along = (t > 0 ? std::min(t, 1.0f) : 0) * kPieces;  // 0 for NaN
    const std::size_t first = std::min(static_cast<std::size_t>(along), kPieces - 1);
    const float u = along - static_cast<float>(first), v = 1 - u;
    const float weight[4] = {v * v * v, 3 * v * v * u, 3 * v * u * u, u * u * u};
    std::array<float, 3> rgb{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += 1.5f * weight[i] * kControl[first + i][c];
    }
    return rgb;
}

float Noise::at(const TexturePoint& point) const {
    SpacePoint at = mapping_(point);
    if (scale_ != 1) at = {at.p * scale_, at.dpdx * scale_, at.dpdy * scale_};
    switch (kind_) {
        case NoiseKind::kFbm:
            return fractal_noise(at, omega_, octaves_);
        case NoiseKind::kWrinkled:
            return turbulence(at, omega_, octaves_);
        case NoiseKind::kVeins:
            return 0.5f + 0.5f * sincos_turns(fraction(disturbed(at.p.x, at))).sin;
        case NoiseKind::kWood:
            return fraction(disturbed(std::sqrt(at.p.x * at.p.x + at.p.z * at.p.z), at));
        case NoiseKind::kClouds:
            return 1 - exp_nonpositive(-variation_ * std::max(0.0f, fractal_noise(at, omega_, octaves_)));
        case NoiseKind::kWindy:
            break;
    }
    // Waves, whose height the strength of the wind over them varies.
    const float wind = fractal_noise({at.p * 0.1f, at.dpdx * 0.1f, at.dpdy * 0.1f}, 0.5f, 3);
    return std::abs(wind) * fractal_noise(at, 0.5f, 6);
}

const SampledSpectrum* Marble::at(const TexturePoint& point) const {
    SpacePoint at = mapping_(point);
    at = {at.p * scale_, at.dpdx * scale_, at.dpdy * scale_};
    const float phase = at.p.y + variation_ * fractal_noise(at, omega_, octaves_);
    SampledSpectrum& out = point.spectra->allocate();
    colors_.evaluate(marble_colour(0.5f + 0.5f * std::sin(phase)).data(), SpectrumRole::kReflectance, *point.spectra, out);
    return &out;
}

}  // namespace latent::render
