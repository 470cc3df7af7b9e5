#include "render/bsdf/coated.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/phase.h"
#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {
namespace {

float transmittance(float thickness, float cosine) { return exp_nonpositive(-thickness / std::abs(cosine)); }

float squared_share(float a, float b) {  // the power heuristic's weight of a beside b; b is 0 if there is no other way
    const float r = b / a;
    return 1 / (1 + r * r);
}

// 1 + q + .. + q^(n - 1), by doubling n.
SampledSpectrum geometric_sum(const SampledSpectrum& q, std::uint32_t n) {
    SampledSpectrum sum(0.0f), power(1.0f);
    for (std::uint32_t bit = n == 0 ? 0 : std::uint32_t{1} << (31 - __builtin_clz(n)); bit != 0; bit >>= 1) {
        const bool one_more = (n & bit) != 0;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            sum.v[i] *= 1 + power.v[i];
            power.v[i] *= power.v[i];
            if (!one_more) continue;
            sum.v[i] = 1 + q.v[i] * sum.v[i];
            power.v[i] *= q.v[i];
        }
    }
    return sum;
}

// Scatterings by the base among `max_depth`, half of which are reflections by the coat.
std::uint32_t base_scatterings(std::uint32_t max_depth) { return max_depth / 2 + max_depth % 2; }

// Mean of f(x) over 0 < x < 1 by Gauss and Legendre's formula with 8 points.
template <class F>
float mean_over_unit(F&& f) {
    constexpr float kAt[] = {0.183434642f, 0.525532410f, 0.796666477f, 0.960289856f};
    constexpr float kWeight[] = {0.181341892f, 0.156853323f, 0.111190517f, 0.0506142681f};
    float sum = 0;
    for (int i = 0; i < 4; ++i) sum += kWeight[i] * (f(0.5f + 0.5f * kAt[i]) + f(0.5f - 0.5f * kAt[i]));
    return sum;
}

// Share of diffuse light from below that a smooth coat and the layer return: the integral of 2 c F(c) e^(-2 t / c) over cosines c
// below the coat. Above the critical angle they are counted by the cosine c' above it, 1 - c'^2 = eta^2 (1 - c^2), where F is
// smooth; below it F is 1.
float returned_by_smooth(float eta, float thickness) {
    const auto twice_through = [&](float c) { return thickness > 0 ? transmittance(2 * thickness, c) : 1; };
    if (!(eta > 1)) {
        return mean_over_unit([&](float c) { return 2 * c * fresnel_dielectric(c, 1 / eta) * twice_through(c); });
    }
    const float critical = std::sqrt(1 - 1 / (eta * eta));
    const float total = critical * critical * mean_over_unit([&](float x) {
                            return 4 * x * x * x * twice_through(critical * x * x);
                        });  // cosines critical x^2
    const float partial = mean_over_unit(
        [&](float c) { return 2 * c * fresnel_dielectric(c, eta) * twice_through(std::sqrt(1 - (1 - c * c) / (eta * eta))); });
    return total + partial / (eta * eta);
}

// What a smooth coat and the layer pass of light from above at cosine c, once.
float passed_by_smooth(float c, float eta, float thickness) {
    const float sin2 = (1 - c * c) / (eta * eta);
    return sin2 < 1 ? (1 - fresnel_dielectric(c, eta)) * transmittance(thickness, std::sqrt(1 - sin2)) : 0;
}

// A base as it is beneath the layer.
Diffuse beneath(const Diffuse& base, const SampledSpectrum&, SampledSpectra&) { return base; }
Conductor beneath(const Conductor& base, const SampledSpectrum& eta, SampledSpectra& spectra) { return base.beneath(eta, spectra); }

bool is_smooth(const Diffuse&) { return false; }
bool is_smooth(const Conductor& metal) { return metal.is_delta(); }

// w, turned over with `side` if that points down.
Vec3f face_forward_z(const Vec3f& w, const Vec3f& side) { return side.z < 0 ? -w : w; }

}  // namespace

template <class Base>
Coated<Base>::State::State(const Layer& l, const Base& b)
    : layer(l), base(b), smooth_coat(l.coat.is_smooth()), smooth_base(is_smooth(b)) {
    const float scattered = layer.albedo ? layer.albedo->max() * (1 - exp_nonpositive(-2 * layer.thickness)) : 0;
    if constexpr (std::is_same_v<Base, Diffuse>) {
        brightness = std::max(base.reflectance().max(), scattered);
        if (smooth_coat && !layer.albedo) returned = returned_by_smooth(layer.coat.eta, layer.thickness);
    } else {
        brightness = 1;
        cosine_share = 0.1f + 0.8f * scattered;
        if (smooth_coat && smooth_base) cosine_share = 1;
        // Two passages through facets of the coat turn a direction as if the base were rougher.
        const Microfacets own = base.facets(), coat = layer.coat.facets;
        const float turn = smooth_coat ? 0 : 1 - 1 / layer.coat.eta;
        const auto joined = [&](float below, float above) { return std::sqrt(below * below + above * above * turn * turn); };
        lobe = Microfacets::of_alpha(joined(own.alpha_x, coat.alpha_x), joined(own.alpha_y, coat.alpha_y));
    }
}

// The key: point and first wavelength tell its vertex from all others, of this sample and of others.
template <class Base>
Coated<Base>::Coated(const Values<Coated>& v) {
    const SampledSpectrum& eta = v.spectrum("layer.eta");
    const Layer layer{
        .coat = {Microfacets::of_alpha(v.number("layer.alpha_x"), v.number("layer.alpha_y")), eta[v.site.kept]},
        .eta = v.varies("layer.eta") ? &eta : nullptr,
        .thickness = v.number("layer.thickness"),
        .albedo = v.find("layer.albedo"),
        .g = v.number("layer.g"),
        .max_depth = v.option("layer.max_depth"),
        .walks = v.option("layer.walks"),
        .key = mix(v.site.spectra.wavelengths.xi, v.site.p),
    };
    const Base base(v.template of<Base>());
    state_ = &v.site.spectra.template store<State>({layer, beneath(base, eta, v.site.spectra)});
}

template <class Base>
bool Coated<Base>::is_isotropic(const Values<Coated>& v) {
    const Microfacets coat = Microfacets::of_alpha(v.number("layer.alpha_x"), v.number("layer.alpha_y"));
    if constexpr (std::is_same_v<Base, Conductor>) {
        if (!Base::is_isotropic(v.template of<Base>())) return false;
    }
    return coat.alpha_x == coat.alpha_y;
}

template <class Base>
bool Coated<Base>::is_exact() const {
    return state_->smooth_coat && !state_->layer.albedo && (std::is_same_v<Base, Diffuse> || state_->smooth_base);
}

template <class Base>
float Coated<Base>::coat_probability(float c) const {
    const float f = fresnel_dielectric(c, state_->layer.coat.eta);
    if (state_->smooth_coat && state_->smooth_base) {
        return state_->layer.albedo ? f + (1 - f) * transmittance(2 * state_->layer.thickness, c) : 1;
    }
    const float within = (1 - f) * state_->brightness;
    return f > 0 ? f / (f + within) : 0;
}

template <class Base>
SampledSpectrum Coated<Base>::mirrored(float c) const {
    const Layer& layer = state_->layer;
    const auto eta = [&](std::uint32_t i) { return layer.eta ? (*layer.eta)[i] : layer.coat.eta; };
    SampledSpectrum f = spectrum_of([&](std::uint32_t i) { return fresnel_dielectric(c, eta(i)); });
    if constexpr (!std::is_same_v<Base, Diffuse>) {
        if (!state_->smooth_base) return f;
        // T^2 A sum over j of (A F)^j,  A what the base and two ways through the layer leave.
        const SampledSpectrum a = spectrum_of([&](std::uint32_t i) {
            const float below = std::sqrt(std::max(1e-12f, 1 - (1 - c * c) / (eta(i) * eta(i))));
            return transmittance(2 * layer.thickness, below) * state_->base.reflectance(below, i);
        });
        const SampledSpectrum sum = geometric_sum(a * f, base_scatterings(layer.max_depth));
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) f.v[i] += (1 - f.v[i]) * (1 - f.v[i]) * a.v[i] * sum.v[i];
    }
    return f;
}

// f = R / (pi eta^2) E(a) E(b) sum over j of (R r)^j,   E what passes from above to the base,   r what comes back to it.
template <class Base>
SampledSpectrum Coated<Base>::diffuse_exactly(const Vec3f& a, const Vec3f& b) const {
    if constexpr (std::is_same_v<Base, Diffuse>) {
        const Layer& layer = state_->layer;
        const SampledSpectrum& r = state_->base.reflectance();
        const auto passed_twice = [&](float eta) {
            return passed_by_smooth(a.z, eta, layer.thickness) * passed_by_smooth(b.z, eta, layer.thickness) * kInvPi / (eta * eta);
        };
        const std::uint32_t n = base_scatterings(layer.max_depth);
        if (!layer.eta) return r * geometric_sum(r * state_->returned, n) * passed_twice(layer.coat.eta);
        const SampledSpectrum& eta = *layer.eta;
        const SampledSpectrum returned = spectrum_of([&](std::uint32_t i) { return returned_by_smooth(eta[i], layer.thickness); });
        return r * geometric_sum(r * returned, n) * spectrum_of([&](std::uint32_t i) { return passed_twice(eta[i]); });
    } else {
        return SampledSpectrum(0.0f);
    }
}

// The same, of a rough coat: E and each r are independent estimates.
template <class Base>
SampledSpectrum Coated<Base>::diffuse_walk(const Vec3f& a, const Vec3f& b, Random& number) const {
    if constexpr (std::is_same_v<Base, Diffuse>) {
        const Layer& layer = state_->layer;
        const SampledSpectrum& r = state_->base.reflectance();
        const auto passed = [&](const Vec3f& w) {
            const float u = number(), v = number();
            const Coat::Refracted in = layer.coat.sample_refraction(w, u, v);
            return in.weight > 0 ? in.weight * transmittance(layer.thickness, in.up.z) : 0;
        };
        const float at_a = passed(a), at_b = passed(b);
        SampledSpectrum sum(0.0f), term = r * (at_a * at_b * kInvPi / (layer.coat.eta * layer.coat.eta));
        if (!(at_a * at_b > 0)) return sum;
        const std::uint32_t n = base_scatterings(layer.max_depth);
        float left = 1;  // share of the light that first reached the base, over the probability to go on
        for (std::uint32_t j = 0;;) {
            sum += term;
            if (++j == n) break;
            const float u = number(), v = number(), x = number(), y = number();
            const Vec3f up = sample_cosine_hemisphere(u, v);
            Vec3f down;
            float returned = layer.coat.sample_reflection_below(up, x, y, down);
            if (!(returned > 0)) break;
            returned *= transmittance(layer.thickness, up.z) * transmittance(layer.thickness, down.z);
            left *= returned * state_->brightness;
            if (j >= 3 && left < 0.25f) {
                if (number() >= left) break;
                returned /= left;
                left = 1;
            }
            term *= r * returned;
        }
        return sum;
    } else {
        return SampledSpectrum(0.0f);
    }
}

// A walk through the layer from a, joined at each scattering to a direction in which light from b has entered, and, below a rough
// coat, to b through the coat; the two weighed by the power heuristic [GHZ18], [PBRT4 14.3].
template <class Base>
SampledSpectrum Coated<Base>::walk(const Vec3f& a, const Vec3f& b, Random& number) const {
    const Layer& layer = state_->layer;
    const Coat& coat = layer.coat;
    const Base& base = state_->base;
    const PhaseFunction phase{layer.g};
    const float t = layer.thickness;
    const auto refracted = [&](const Vec3f& w) {
        const float u = number(), v = number();
        return coat.sample_refraction(w, u, v);
    };
    const Coat::Refracted from = refracted(a), to = refracted(b);
    SampledSpectrum sum(0.0f), beta(from.weight);
    if (!(from.weight > 0)) return sum;
    const auto add = [&](SampledSpectrum value, float factor) {
        value *= factor;
        sum += value;
    };
    // Leaves through the rough coat; `pdf`: of the direction d, which counts in `value`; 0 of a delta function.
    const auto leave = [&](const SampledSpectrum& value, const Vec3f& d, float way, float pdf) {
        if (state_->smooth_coat) return;
        const Coat::Refracted out = coat.refraction(b, d);
        if (out.weight > 0)
            add(value, out.weight * out.pdf / d.z * transmittance(way, d.z) * (pdf > 0 ? squared_share(pdf, out.pdf) : 1));
    };
    // Between a smooth coat and a smooth base nothing else joins a scattering to b than all their reflections.
    const bool mirrors = state_->smooth_coat && state_->smooth_base && to.weight > 0;
    SampledSpectrum below(1.0f),
        between(1.0f);  // reflection by the base alone; by the base and the coat, with two ways through the layer
    if (mirrors) {
        ClosureSample unused;
        base.sample(to.up, 0, 0, 0, unused, below);
        between = below * (transmittance(2 * t, to.up.z) * fresnel_dielectric(to.up.z, 1 / coat.eta));
    }
    // The share of the other way: joined to `to`, which may be a delta function's.
    const auto joined_share = [&](float pdf) { return to.pdf > 0 ? squared_share(to.pdf, pdf) : 1; };

    Vec3f d = -from.up;
    float z = t;
    for (std::uint32_t depth = 0; depth < layer.max_depth && d.z != 0; ++depth) {
        if (depth > 3) {
            const float left = beta.max();
            if (left < 0.25f) {
                if (number() >= left) break;
                beta *= 1 / left;
            }
        }
        if (layer.albedo) {
            const float step = -log_one_minus(number()) * d.z;
            if (0 < z + step && z + step < t) {
                z += step;
                beta *= *layer.albedo;
                if (to.weight > 0) {
                    const float p = phase(-d, to.up), through = to.weight / to.up.z;
                    if (mirrors) {
                        const Vec3f down{to.up.x, to.up.y, -to.up.z};
                        const std::uint32_t left = layer.max_depth - depth - 1;
                        add(beta * geometric_sum(between, left / 2 + 1), p * through * transmittance(t - z, to.up.z));
                        add(beta * below * geometric_sum(between, (left + 1) / 2),
                            phase(-d, down) * through * transmittance(t + z, to.up.z));
                    } else {
                        add(beta, p * through * transmittance(t - z, to.up.z) * joined_share(p));
                    }
                }
                const float u = number(), v = number();
                const Vec3f wo = -d;
                d = phase.sample(wo, u, v);
                if (d.z > 0) leave(beta, d, t - z, phase(wo, d));
                continue;
            }
        } else {
            beta *= transmittance(t, d.z);
        }
        if (d.z > 0) {
            z = t;
            const Vec3f up = d;
            const float u = number(), v = number(), weight = coat.sample_reflection_below(up, u, v, d);
            if (!(weight > 0)) break;
            beta *= weight;
            continue;
        }
        z = 0;
        const Vec3f wo = -d;
        if (!state_->smooth_base && to.weight > 0) {
            SampledSpectrum value = beta;
            base.multiply_f_cos(wo, to.up, value);
            add(value, to.weight / to.up.z * transmittance(t, to.up.z) * joined_share(base.pdf_omega(wo, to.up)));
        }
        ClosureSample next;
        const float u = number(), v = number();
        if (!base.sample(wo, 0, u, v, next, beta)) break;
        float pdf = 0;
        if (!next.delta) {
            pdf = base.pdf_omega(wo, next.wi);
            if (!(pdf > 0)) break;
            base.multiply_f_cos(wo, next.wi, beta);
            beta *= 1 / pdf;
        }
        d = next.wi;
        leave(beta, d, t, pdf);
    }
    return sum * (1 / (coat.eta * coat.eta));
}

template <class Base>
SampledSpectrum Coated<Base>::from_within(const Vec3f& a, const Vec3f& b) const {
    const Layer& layer = state_->layer;
    if (layer.max_depth == 0) return SampledSpectrum(0.0f);
    if (is_exact()) return diffuse_exactly(a, b);
    const bool in_order = a.z != b.z ? a.z < b.z : a.x != b.x ? a.x < b.x : a.y < b.y;
    const Vec3f &first = in_order ? a : b, &second = in_order ? b : a;
    Random number(mix(mix(layer.key, first), second));
    SampledSpectrum sum(0.0f);
    for (std::uint32_t i = 0; i < layer.walks; ++i) {
        sum += std::is_same_v<Base, Diffuse> && !layer.albedo ? diffuse_walk(first, second, number) : walk(first, second, number);
    }
    return layer.walks == 1 ? sum : sum * (1 / static_cast<float>(layer.walks));
}

template <class Base>
void Coated<Base>::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const Vec3f a = face_forward_z(w_camera, w_camera), b = face_forward_z(w_light, w_camera);
    SampledSpectrum f = from_within(a, b);
    const float reflected = state_->layer.coat.reflection(a, b);
    for (float& lane : f.v) lane += reflected;
    value *= f;
    value *= b.z;
}

template <class Base>
float Coated<Base>::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const Layer& layer = state_->layer;
    const Vec3f a = face_forward_z(wo, wo), b = face_forward_z(wi, wo);
    const float p = coat_probability(a.z), share = state_->cosine_share;
    float within = share * kInvPi * b.z;
    Vec3f in, out, m;
    if (share < 1 && layer.coat.refract_in(a, in) && layer.coat.refract_in(b, out) && half_vector(in, out, 1, m)) {
        const float to_above = b.z / (layer.coat.eta * layer.coat.eta * out.z);  // solid angles
        within += (1 - share) * state_->lobe.visible_density(in, m) / (4 * dot(in, m)) * to_above;
    }
    return (1 - p) * within + (state_->smooth_coat ? 0 : p * layer.coat.pdf_reflection(a, b));
}

template <class Base>
bool Coated<Base>::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    const Layer& layer = state_->layer;
    const Vec3f a = face_forward_z(wo, wo);
    const float p = coat_probability(a.z), share = state_->cosine_share;
    if (u_lobe < p) {
        if (state_->smooth_coat) {
            out.delta = true;
            out.wi = {-wo.x, -wo.y, wo.z};
            out.probability = out.probability_reverse = p;
            weight *= mirrored(a.z);
            weight *= 1 / p;
            return true;
        }
        const Vec3f m = layer.coat.facets.sample_visible(a, u, v);
        out.wi = m * (2 * dot(a, m)) - a;
    } else if (u_lobe - p < share * (1 - p)) {
        out.wi = sample_cosine_hemisphere(u, v);
    } else {
        Vec3f in;
        if (!layer.coat.refract_in(a, in)) return false;
        const Vec3f m = state_->lobe.sample_visible(in, u, v);
        const Vec3f up = m * (2 * dot(in, m)) - in;
        if (!(up.z > 0) || !layer.coat.refract_out(up, out.wi)) return false;
    }
    if (!(out.wi.z > 0)) return false;
    if (wo.z < 0) out.wi = -out.wi;
    return true;
}

template class Coated<Diffuse>;
template class Coated<Conductor>;

}  // namespace latent::render
