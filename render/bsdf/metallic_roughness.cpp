#include "render/bsdf/metallic_roughness.h"

#include <algorithm>
#include <cmath>

#include "render/bsdf/fresnel.h"
#include "render/math/elementary.h"
#include "render/sampling/warp.h"

namespace latent::render {

namespace {

constexpr float kCoatF0 = 0.04f;  // index 1.5

float alpha_of(float roughness) { return roughness * roughness; }

Microfacets facets_of(float alpha, const Brushing& brushing = {}) {
    return {std::max(brushing.alpha_along(alpha), MetallicRoughness::kMinAlpha), std::max(alpha, MetallicRoughness::kMinAlpha)};
}

// D G / (4 |a.z| |b.z|), for the half vector m.
float facets_over_cosines(const Microfacets& facets, const Vec3f& a, const Vec3f& b, const Vec3f& m) {
    return facets.density(m) * facets.masking_shadowing(a, b) / (4 * std::abs(a.z * b.z));
}

}  // namespace

MetallicRoughness::MetallicRoughness(const Values<MetallicRoughness>& v)
    : MetallicRoughness(v.spectrum("base_color"),
                        {.metallic = v.number("metallic"),
                         .alpha = alpha_of(v.number("roughness")),
                         .f0 = v.number("f0"),
                         .f90 = v.number("f90"),
                         .coat = v.number("coat"),
                         .coat_alpha = alpha_of(v.number("coat_roughness")),
                         .brushing = Brushing::of(v),
                         .film = ThinFilm::of(v),
                         .multiscatter = v.option("multiscatter") != 0},
                        v.find("specular_color"), &v.site.spectra) {}

MetallicRoughness::MetallicRoughness(const SampledSpectrum& base, const Parameters& p, const SampledSpectrum* specular_color,
                                     SampledSpectra* spectra)
    : base_(&base),
      specular_color_(specular_color),
      multiscatter_(p.multiscatter && p.film.share == 0),
      mirrors_(p.metallic >= 1 && p.coat <= 0 && Microfacets{p.brushing.alpha_along(p.alpha), p.alpha}.are_smooth()),
      brightest_(base.max()),
      metallic_(p.metallic),
      f0_(p.f0),
      f90_(p.f90),
      coat_(p.coat),
      alpha_(facets_of(p.alpha, p.brushing).mean_alpha()),
      brushing_(p.brushing),
      facets_(facets_of(p.alpha, p.brushing)),
      coat_facets_(facets_of(p.coat_alpha)),
      metal_albedo_(brightest_, 1, alpha_, multiscatter_),
      albedo_(specular_color != nullptr ? p.f0 * specular_color->max() : p.f0, p.f90, alpha_, multiscatter_),
      min_albedo_(specular_color != nullptr ? p.f0 * std::ranges::min(specular_color->v) : p.f0, p.f90, alpha_, multiscatter_),
      coat_albedo_(kCoatF0, 1, coat_facets_.alpha_x) {
    if (p.film.share > 0) filmed_ = &spectra->store(filmed(p.film, spectra->wavelengths));
}

MetallicRoughness::Filmed MetallicRoughness::filmed(const ThinFilm& film, const Wavelengths& wavelengths) const {
    Filmed out;
    out.film = film;
    out.lambda_nm = wavelengths.lambda_nm;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        out.f0.v[i] = f0_ * (specular_color_ != nullptr ? specular_color_->v[i] : 1);
        out.dielectric_eta.v[i] = index_of_reflectance(out.f0.v[i]);
        out.metal_eta.v[i] = index_of_reflectance(base_->v[i]);
    }
    for (int j = 0; j < FacetWeights::kNodes; ++j) {
        const float c = FacetWeights::node(j), rise = schlick_rise(c);
        const ThinFilm::Ray ray(film, c);
        out.mean_at_node[j] = 0;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float bare = out.f0.v[i] + (f90_ - out.f0.v[i]) * rise;
            out.at_node[j].v[i] = bare + film.share * (ray.reflectance(out.dielectric_eta.v[i], wavelengths.lambda_nm[i]) - bare);
            if (i < wavelengths.k) out.mean_at_node[j] += out.at_node[j].v[i] / static_cast<float>(wavelengths.k);
        }
    }
    return out;
}

SampledSpectrum MetallicRoughness::filmed_albedo(const FacetWeights& weights) const {
    SampledSpectrum out(0.0f);
    for (int j = 0; j < FacetWeights::kNodes; ++j) out += filmed_->at_node[j] * weights.weight[static_cast<std::size_t>(j)];
    return out;
}

SampledSpectrum MetallicRoughness::filmed_surface(float mu, float mu_light, float c, float d) const {
    const Filmed& f = *filmed_;
    const ThinFilm::Ray ray(f.film, c);
    const float rise = schlick_rise(c);
    const SampledSpectrum e = filmed_albedo(FacetWeights::at(mu, alpha_)),
                          e_light = filmed_albedo(FacetWeights::at(mu_light, alpha_)),
                          mean = filmed_albedo(FacetWeights::mean(alpha_));
    return spectrum_of([&](std::uint32_t i) {
        const auto covered = [&](float f0, float f90, float eta) {
            const float bare = f0 + (f90 - f0) * rise;
            return bare + f.film.share * (ray.reflectance(eta, f.lambda_nm[i]) - bare);
        };
        const float body = base_->v[i] * kInvPi * (1 - e.v[i]) * (1 - e_light.v[i]) / std::max(1 - mean.v[i], 1e-6f);
        return (1 - metallic_) * (body + d * covered(f.f0.v[i], f90_, f.dielectric_eta.v[i])) +
               metallic_ * d * covered(base_->v[i], 1, f.metal_eta.v[i]);
    });
}

SampledSpectrum MetallicRoughness::reflectance(float c) const {
    if (filmed_ != nullptr) return filmed_surface(c, c, c, 1);
    const float rise = schlick_rise(c);
    return spectrum_of([&](std::uint32_t i) { return base_->v[i] + (1 - base_->v[i]) * rise; });
}

SampledSpectrum MetallicRoughness::multiscatter_surface(float mu, float mu_light, float c, float d) const {
    const FacetGain gain(alpha_);
    const float gained = gain(mu, mu_light), rise = schlick_rise(c);
    const auto reflected = [&](float f0, float f90) {
        return d * (f0 + (f90 - f0) * rise) * (1 + gain.returned(schlick_mean(f0, f90)) * gained);
    };
    return spectrum_of([&](std::uint32_t i) {
        const float f0 = f0_ * (specular_color_ != nullptr ? specular_color_->v[i] : 1);
        const SchlickAlbedo e = specular_color_ != nullptr ? SchlickAlbedo(f0, f90_, alpha_, true) : albedo_;
        const float body = base_->v[i] * kInvPi * (1 - e(mu)) * (1 - e(mu_light)) / std::max(1 - e.mean(), 1e-6f);
        return (1 - metallic_) * (body + reflected(f0, f90_)) + metallic_ * reflected(base_->v[i], 1);
    });
}

void MetallicRoughness::multiply_f_cos(const Vec3f& camera, const Vec3f& light, SampledSpectrum& value) const {
    const Vec3f w_camera = brushing_.to_facets(camera), w_light = brushing_.to_facets(light);
    const float mu = std::abs(w_camera.z), mu_light = std::abs(w_light.z);
    Vec3f m;
    float below = camera.z * light.z > 0 ? 1.0f : 0.0f, coat_cos = 0;  // below: what the coat passes, twice
    if (coat_ > 0) {
        const Frame frame = coat_frame();
        const Vec3f a = frame.to_local(camera), b = frame.to_local(light);
        below *= (1 - coat_ * coat_albedo_(std::abs(a.z))) * (1 - coat_ * coat_albedo_(std::abs(b.z)));
        if (half_vector(a, b, 1, m))
            coat_cos = coat_ * (kCoatF0 + (1 - kCoatF0) * schlick_rise(abs_dot(a, m))) *
                       facets_over_cosines(coat_facets_, a, b, m) * std::abs(b.z);
    }
    float times_base = (1 - metallic_) * kInvPi * (1 - albedo_(mu)) * (1 - albedo_(mu_light)) / std::max(1 - albedo_.mean(), 1e-6f),
          constant = 0;
    float rise = 0, d = 0, c = 1;
    if (half_vector(w_camera, w_light, 1, m)) {
        c = abs_dot(w_camera, m), rise = schlick_rise(c), d = facets_over_cosines(facets_, w_camera, w_light, m);
        times_base += metallic_ * (1 - rise) * d;
        constant = (metallic_ * rise + (1 - metallic_) * (f0_ + (f90_ - f0_) * rise)) * d;
    }
    if (filmed_ != nullptr || multiscatter_) {
        const SampledSpectrum surface =
            multiscatter_ ? multiscatter_surface(mu, mu_light, c, d) : filmed_surface(mu, mu_light, c, d);
        value *= spectrum_of([&](std::uint32_t i) { return below * surface.v[i] * mu_light + coat_cos; });
        return;
    }
    if (specular_color_ != nullptr) {  // body and facets differ with wavelength: E = f0 c e0 + e90
        const SchlickAlbedo e0(1, 0, alpha_), e90(0, f90_, alpha_);
        const float e = e0(mu), e_light = e0(mu_light), mean = e0.mean(), rest = 1 - e90(mu), rest_light = 1 - e90(mu_light),
                    rest_mean = 1 - e90.mean();
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            const float f0 = f0_ * specular_color_->v[i],
                        body = kInvPi * (rest - f0 * e) * (rest_light - f0 * e_light) / std::max(rest_mean - f0 * mean, 1e-6f),
                        dielectric = body * base_->v[i] + (f0 + (f90_ - f0) * rise) * d,
                        metal = (base_->v[i] + (1 - base_->v[i]) * rise) * d;
            value.v[i] *= below * ((1 - metallic_) * dielectric + metallic_ * metal) * mu_light + coat_cos;
        }
        return;
    }
    times_base *= below * mu_light;
    constant = constant * below * mu_light + coat_cos;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= times_base * base_->v[i] + constant;
}

MetallicRoughness::Lobes MetallicRoughness::lobes(const Vec3f& wo) const {
    const float mu = std::abs(wo.z), coat = coat_ > 0 ? coat_ * coat_albedo_(abs_dot(wo, coat_n_)) : 0;
    float e = albedo_(mu);
    if (filmed_ != nullptr) {
        const FacetWeights weights = FacetWeights::at(mu, alpha_);
        e = 0;
        for (std::size_t j = 0; j < weights.weight.size(); ++j) e += weights.weight[j] * filmed_->mean_at_node[j];
    }
    const float facets = (1 - coat) * (metallic_ * metal_albedo_(mu) + (1 - metallic_) * e),
                diffuse = (1 - coat) * (1 - metallic_) * brightest_ *
                          (1 - (specular_color_ != nullptr && filmed_ == nullptr ? min_albedo_(mu) : e)),
                sum = coat + facets + diffuse;
    if (!(sum > 0)) return {0, 0};
    return {coat / sum, facets / sum};
}

float MetallicRoughness::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const Lobes p = lobes(wo);
    const auto mirrored = [](const Microfacets& facets, const Vec3f& a, const Vec3f& b) {
        Vec3f m;
        return half_vector(a, b, 1, m) ? facets.visible_density(a, m) / (4 * abs_dot(a, m)) : 0;
    };
    float pdf = 0;
    if (wo.z * wi.z > 0)
        pdf = std::max(1 - p.coat - p.facets, 0.0f) * kInvPi * std::abs(wi.z) +
              p.facets * mirrored(facets_, brushing_.to_facets(wo), brushing_.to_facets(wi));
    if (p.coat > 0) {
        const Frame frame = coat_frame();
        pdf += p.coat * mirrored(coat_facets_, frame.to_local(wo), frame.to_local(wi));
    }
    return pdf;
}

bool MetallicRoughness::sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const {
    if (mirrors_) {
        out.wi = {-wo.x, -wo.y, wo.z};
        out.delta = true;
        out.probability = out.probability_reverse = 1;
        weight *= reflectance(std::abs(wo.z));
        return true;
    }
    const Lobes p = lobes(wo);
    const auto mirrored = [&](const Microfacets& facets, const Vec3f& w) {
        const Vec3f m = facets.sample_visible(w, u, v);
        return m * (2 * dot(w, m)) - w;
    };
    if (u_lobe < p.coat) {
        const Frame frame = coat_frame();
        const Vec3f w = frame.to_local(wo), wi = mirrored(coat_facets_, w);
        out.wi = frame.to_world(wi);
        return wi.z * w.z > 0;
    }
    if (u_lobe < p.coat + p.facets) {
        out.wi = brushing_.from_facets(mirrored(facets_, brushing_.to_facets(wo)));
    } else {
        out.wi = sample_cosine_hemisphere(u, v);
        if (wo.z < 0) out.wi.z = -out.wi.z;
    }
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
