#include "render/material/material.h"

#include <algorithm>
#include <cmath>

namespace latent::render {
namespace {

// What a texture gives may be anything: each of these is the nearest value that makes sense, and of no number the least.

// Within [0,1].
const SampledSpectrum& reflectance(const SpectrumSource& source, const TexturePoint& point) {
    const SampledSpectrum& given = source.at(point);
    if (source.texture == nullptr) return given;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = given.v[i] > 0 ? std::min(given.v[i], 1.0f) : 0;
    return out;
}
float at_least_zero(float x) { return x > 0 ? std::min(x, 1e6f) : 0; }
float fraction(const FloatSource& source, const TexturePoint& point) {
    const float x = source.at(point);
    return x > 0 ? std::min(x, 1.0f) : 0;
}
// GGX alpha.
float alpha(const FloatSource& source, bool remap, const TexturePoint& point) {
    if (source.texture == nullptr) return source.value;
    const float roughness = at_least_zero(source.at(point));
    return remap ? std::sqrt(roughness) : roughness;
}
// Of a conductor.
const SampledSpectrum& index(const SpectrumSource& source, float least, const TexturePoint& point) {
    const SampledSpectrum& given = source.at(point);
    if (source.texture == nullptr) return given;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = given.v[i] > least ? std::min(given.v[i], 1e6f) : least;
    return out;
}

// The metal of eta = 1 that reflects r at normal incidence: R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
Conductor metal_of(const SampledSpectrum& r, float alpha_x, float alpha_y, SampledSpectra& spectra) {
    SampledSpectrum& eta = spectra.allocate() = SampledSpectrum(1.0f);
    SampledSpectrum& k = spectra.allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float limited = std::min(r.v[i], 0.9999f);
        k.v[i] = 2 * std::sqrt(limited) / std::sqrt(1 - limited);
    }
    return {eta, k, alpha_x, alpha_y};
}

}  // namespace

FloatSource Material::source(const FloatInput& input, const Textures& textures) {
    is_textured_ |= input.is_textured();
    return textures.source(input);
}
SpectrumSource Material::source(const SpectrumInput& input, const Textures& textures, SpectrumLibrary& library) {
    is_textured_ |= input.is_textured();
    return textures.source(input, library);
}

Material::Material(const MaterialDescription& d, const Textures& textures, SpectrumLibrary& library)
    : kind_(d.kind),
      dispersive_(d.dispersive),
      remap_roughness_(d.remap_roughness),
      reflectance_(source(d.reflectance, textures, library)),
      specular_(source(d.specular, textures, library)),
      eta_(source(d.eta, textures, library)),
      k_(source(d.k, textures, library)),
      exponent_(source(d.exponent, textures)),
      alpha_x_(source(d.alpha_x, textures)),
      alpha_y_(source(d.alpha_y, textures)),
      roughness_(source(d.roughness, textures)),
      metallic_(source(d.metallic, textures)),
      coat_(source(d.coat, textures)),
      coat_roughness_(source(d.coat_roughness, textures)),
      f0_(d.f0),
      f90_(d.f90) {}

Bsdf Material::bsdf(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const {
    const float alpha_x = alpha(alpha_x_, remap_roughness_, point), alpha_y = alpha(alpha_y_, remap_roughness_, point);
    const Frame frame = alpha_x == alpha_y ? Frame::from_z(hit.ns) : Frame::from_z_x(hit.ns, hit.dpdu);
    const auto bsdf_of = [&](const auto& closure) { return Bsdf(frame, hit.ng, closure); };
    switch (kind_) {
        case MaterialKind::kDiffuse:
            return bsdf_of(Diffuse(reflectance(reflectance_, point)));
        case MaterialKind::kPhong:
            return bsdf_of(
                Phong(reflectance(reflectance_, point), reflectance(specular_, point), at_least_zero(exponent_.at(point))));
        case MaterialKind::kConductor:
            if (reflectance_.texture) return bsdf_of(metal_of(reflectance(reflectance_, point), alpha_x, alpha_y, *point.spectra));
            return bsdf_of(Conductor(index(eta_, 1e-3f, point), index(k_, 0, point), alpha_x, alpha_y));
        case MaterialKind::kDielectric:
            return bsdf_of(Dielectric(eta_.at(point), dispersive_, kept, alpha_x, alpha_y));
        case MaterialKind::kThinDielectric:
            return bsdf_of(ThinDielectric(eta_.at(point), dispersive_, kept));
        case MaterialKind::kMetallicRoughness: {
            const float roughness = fraction(roughness_, point), coat_roughness = fraction(coat_roughness_, point);
            return bsdf_of(MetallicRoughness(reflectance(reflectance_, point), {.metallic = fraction(metallic_, point),
                                                                                .alpha = roughness * roughness,
                                                                                .f0 = f0_,
                                                                                .f90 = f90_,
                                                                                .coat = fraction(coat_, point),
                                                                                .coat_alpha = coat_roughness * coat_roughness}));
        }
    }
    __builtin_unreachable();
}

}  // namespace latent::render
