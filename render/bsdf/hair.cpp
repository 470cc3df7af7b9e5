#include "render/bsdf/hair.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {

namespace {

constexpr float kPerTurn = 1 / (2 * kPi);

float root(float x) { return x > 0 ? std::sqrt(x) : 0; }
float square(float x) { return x * x; }
float power(float x, int n) {
    float result = 1;
    for (int i = 0; i < n; ++i) result *= x;
    return result;
}

// In turns, -1/2 to 1/2.
float arcsine(float sine, float cosine) {
    const float turns = angle_in_turns(cosine, std::abs(sine));
    return sine < 0 ? -turns : turns;
}
float wrapped(float turns) { return turns - std::floor(turns + 0.5f); }

// ln I_0(x), x >= 0, of the modified Bessel function.
float log_bessel(float x) {
    if (x > 12) return x + 0.5f * log_positive(kPerTurn / x) + log_positive(1 + (1 + 1.125f / x) / (8 * x));
    float sum = 1, term = 1;
    for (int i = 1; i < 24; ++i) {
        term *= square(x / (2 * static_cast<float>(i)));
        sum += term;
    }
    return log_positive(sum);
}

// Density of sin(theta) after scattering, over the sphere but for the azimuth [dEon11 eq. 7].
float longitudinal(float sin_i, float cos_i, float sin_o, float cos_o, float v) {
    const float exponent = log_bessel(cos_i * cos_o / v) - sin_i * sin_o / v - 1 / v;
    return exp_nonpositive(std::min(exponent, 0.0f)) / (v * (1 - exp_nonpositive(-2 / v)));
}

// The density of the logistic distribution, per turn; then its integral up to x.
float logistic(float x, float scale) {
    const float e = exp_nonpositive(-std::abs(x) / scale);
    return e / (scale * square(1 + e));
}
float logistic_below(float x, float scale) {
    const float e = exp_nonpositive(-std::abs(x) / scale);
    return x < 0 ? e / (1 + e) : 1 / (1 + e);
}

}  // namespace

Hair::Hair(const Values<Hair>& v) {
    Fibre fibre{.sigma_a = v.find("sigma_a"),
                .eta = v.number("eta"),
                .beta_m = v.number("beta_m"),
                .beta_n = v.number("beta_n"),
                .tilt_turns = v.number("alpha") / 360};
    if (const SampledSpectrum* color = v.find("color")) {
        // Such that much hair together has this colour [Chiang16 eq. 9].
        const float n = fibre.beta_n;
        const float slope = 5.969f + n * (-0.215f + n * (2.532f + n * (-10.73f + n * (5.574f + n * 0.245f))));
        SampledSpectrum& sigma_a = v.site.spectra.allocate();
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i)
            sigma_a.v[i] = square(log_positive(std::max(color->v[i], 1e-6f)) / slope);
        fibre.sigma_a = &sigma_a;
    }
    state_ = &v.site.spectra.store<State>({fibre, v.site.ribbon, v.site.across});
}

Hair::State::State(const Fibre& given, bool ribbon, float place) : fibre(given), is_ribbon(ribbon), across(place) {
    const float m = fibre.beta_m, n = fibre.beta_n;
    variance[0] = std::max(square(0.726f * m + 0.812f * square(m) + 3.7f * power(m, 20)), 1e-5f);
    variance[1] = 0.25f * variance[0];
    variance[2] = variance[3] = 4 * variance[0];
    scale = std::max(0.626657069f * (0.265f * n + 1.194f * square(n) + 5.372f * power(n, 22)), 1e-3f) * kPerTurn;
    all = 1 - 2 * logistic_below(-0.5f, scale);
    const SinCos tilt = sincos_turns(fibre.tilt_turns);
    sin_tilt[0] = tilt.sin, cos_tilt[0] = tilt.cos;
    for (std::size_t i = 1; i < 3; ++i) {
        sin_tilt[i] = 2 * cos_tilt[i - 1] * sin_tilt[i - 1];
        cos_tilt[i] = square(cos_tilt[i - 1]) - square(sin_tilt[i - 1]);
    }
}

Hair::View::View(const State& state, const Vec3f& seen_from)
    : w(seen_from), sin(std::clamp(w.x, -1.0f, 1.0f)), cos(root(1 - square(sin))) {
    const float radius = std::sqrt(square(w.y) + square(w.z));
    phi = radius > 0 ? arcsine(w.z, w.y) : 0.25f;
    float h = radius > 0 ? -w.y / radius : 0;
    if (state.is_ribbon) h = w.z < 0 ? -state.across : state.across;
    h = std::clamp(h, -0.999999f, 0.999999f);
    const float eta = state.fibre.eta, cos_o = root(1 - square(h));
    const float sin_t = sin / eta, cos_t = root(1 - square(sin_t));
    const float across_eta = root(square(eta) - square(sin)) / std::max(cos, 1e-6f);  // that of the projection
    const float h_t = std::clamp(h / across_eta, -1.0f, 1.0f), cos_h = root(1 - square(h_t));
    gamma_o = arcsine(h, cos_o);
    gamma_t = arcsine(h_t, cos_h);
    reflectance = fresnel_dielectric(cos * cos_o, eta);
    path = 2 * cos_h / std::max(cos_t, 1e-6f);
    // Scales turn what is reflected by -2 alpha, what passes by alpha, what is reflected inside by 4 alpha.
    const std::array<float, kTerms> s = {-state.sin_tilt[1], state.sin_tilt[0], state.sin_tilt[2], 0},
                                    c = {state.cos_tilt[1], state.cos_tilt[0], state.cos_tilt[2], 1};
    for (std::size_t p = 0; p < kTerms; ++p) {
        sin_term[p] = sin * c[p] + cos * s[p];
        cos_term[p] = std::abs(cos * c[p] - sin * s[p]);
    }
    probability = {};
    float total = 0;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        transmittance[i] = exp_nonpositive(-state.fibre.sigma_a->v[i] * path);
        const std::array<float, kTerms> a = attenuation(transmittance[i]);
        for (std::size_t p = 0; p < kTerms; ++p) probability[p] += a[p], total += a[p];
    }
    for (float& x : probability) x /= total;
}

std::array<float, Hair::kTerms> Hair::View::attenuation(float by) const {
    std::array<float, kTerms> a;
    const float again = reflectance * by;
    a[0] = reflectance;
    a[1] = square(1 - reflectance) * by;
    a[2] = a[1] * again;
    a[3] = again < 1 ? a[2] * again / (1 - again) : 0;
    return a;
}

const std::array<float, Hair::kTerms>& Hair::View::lobes(const State& state, const Vec3f& wi) {
    if (wi_ == wi) return lobes_;
    wi_ = wi;
    const float sin_i = std::clamp(wi.x, -1.0f, 1.0f), cos_i = root(1 - square(sin_i));
    const float turned = square(wi.y) + square(wi.z) > 0 ? arcsine(wi.z, wi.y) - phi : 0;
    for (int p = 0; p < kTerms; ++p) {
        const auto i = static_cast<std::size_t>(p);
        const float around = p + 1 < kTerms ? logistic(wrapped(turned - turn(p)), state.scale) / state.all : 1;
        lobes_[i] = longitudinal(sin_i, cos_i, sin_term[i], cos_term[i], state.variance[i]) * around * kPerTurn;
    }
    return lobes_;
}

Hair::View& Hair::seen_from(const Vec3f& w) const {
    std::optional<View>& last = state_->last;
    if (!last || last->w != w) last.emplace(*state_, w);
    return *last;
}

// The multiple scattering in hair of this absorption [Chiang16 eq. 9], the other way.
SampledSpectrum Hair::albedo() const {
    const float n = state_->fibre.beta_n;
    const float slope =
        5.969f - 0.215f * n + 2.532f * square(n) - 10.73f * power(n, 3) + 5.574f * power(n, 4) + 0.245f * power(n, 5);
    return spectrum_of([&](std::uint32_t i) { return exp_nonpositive(-root(state_->fibre.sigma_a->v[i]) * slope); });
}

void Hair::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    View& view = seen_from(w_camera);
    const std::array<float, kTerms>& lobes = view.lobes(*state_, w_light);
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const std::array<float, kTerms> a = view.attenuation(view.transmittance[i]);
        value.v[i] *= a[0] * lobes[0] + a[1] * lobes[1] + a[2] * lobes[2] + a[3] * lobes[3];
    }
}

float Hair::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    View& view = seen_from(wo);
    const std::array<float, kTerms>& lobes = view.lobes(*state_, wi);
    float sum = 0;
    for (std::size_t p = 0; p < kTerms; ++p) sum += view.probability[p] * lobes[p];
    return sum;
}

// The number that chooses the term also draws the azimuth.
bool Hair::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    const View& view = seen_from(wo);
    const std::array<float, kTerms>& probability = view.probability;
    std::size_t p = 0;
    while (p + 1 < kTerms && u_lobe >= probability[p]) u_lobe -= probability[p++];
    const float rest = std::clamp(u_lobe / std::max(probability[p], 1e-20f), 0.0f, 0x1.fffffep-1f);

    const float variance = state_->variance[p];
    const float least = exp_nonpositive(-2 / variance);
    const float along = std::clamp(1 + variance * log_positive(std::max(u + (1 - u) * least, 1e-30f)), -1.0f, 1.0f);
    const float sin_i =
        std::clamp(-along * view.sin_term[p] + root(1 - square(along)) * sincos_turns(v).cos * view.cos_term[p], -1.0f, 1.0f);
    float turned = rest;
    if (p + 1 < kTerms) {
        const float below = logistic_below(-0.5f, state_->scale), share = below + rest * state_->all;
        turned = view.turn(static_cast<int>(p)) + state_->scale * log_positive(share / std::max(1 - share, 1e-30f));
    }
    const SinCos phi = sincos_turns(view.phi + turned);
    const float cos_i = root(1 - square(sin_i));
    out.wi = {sin_i, cos_i * phi.cos, cos_i * phi.sin};
    return true;
}

}  // namespace latent::render
