#include "render/material/material.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/hash.h"
#include "render/material/values.h"

namespace latent::render {
namespace {

// The metal of eta = 1 that reflects r at normal incidence: R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
struct Metal {
    const SampledSpectrum &eta, &k;
};
Metal metal_of(const SampledSpectrum& r, SampledSpectra& spectra) {
    SampledSpectrum& eta = spectra.allocate() = SampledSpectrum(1.0f);
    SampledSpectrum& k = spectra.allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float limited = std::min(r.v[i], 0.9999f);
        k.v[i] = 2 * std::sqrt(limited) / std::sqrt(1 - limited);
    }
    return {eta, k};
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
      scale_(d.scale),
      exponent_(source(d.exponent, textures)),
      alpha_x_(source(d.alpha_x, textures)),
      alpha_y_(source(d.alpha_y, textures)),
      roughness_(source(d.roughness, textures)),
      metallic_(source(d.metallic, textures)),
      coat_(source(d.coat, textures)),
      coat_roughness_(source(d.coat_roughness, textures)),
      f0_(d.f0),
      f90_(d.f90),
      layer_(d.layer, textures, library),
      hair_(d.hair, textures, library),
      amount_(source(d.amount, textures)),
      mixed_(d.mixed),
      retro_(d.retro),
      relief_(d, textures) {
    if (d.selector) selector_ = source(*d.selector, textures, library);
    is_textured_ |= layer_.is_textured() || d.kind == MaterialKind::kHair || is_mixture() || !relief_.is_flat();
}

std::uint32_t Material::chosen(const TexturePoint& point, const SampledSpectrum*& weight) const {
    // No place is told from another one by less than its last bits, so this is as good as chance.
    std::byte bytes[12];
    store_le(bytes, std::bit_cast<std::uint32_t>(point.p.x));
    store_le(bytes + 4, std::bit_cast<std::uint32_t>(point.p.y));
    store_le(bytes + 8, std::bit_cast<std::uint32_t>(point.p.z));
    const float u = static_cast<float>(hash64(bytes) >> 40) * 0x1p-24f;
    if (!selector_) return mixed_[u < amount_.at(point) ? 1 : 0];
    // Wavelengths are drawn about as the eye sees them, so their mean is the selector's luminance [R06 5.3.5].
    const SampledSpectrum& share = reflectance(*selector_, point);
    const std::uint32_t k = point.spectra->wavelengths.k;
    float mean = 0;
    for (std::uint32_t i = 0; i < k; ++i) mean += share.v[i] / static_cast<float>(k);
    const bool second = u < mean;
    SampledSpectrum& out = point.spectra->allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        out.v[i] = (second ? share.v[i] / mean : (1 - share.v[i]) / (1 - mean)) * (weight != nullptr ? weight->v[i] : 1);
    }
    weight = &out;
    return mixed_[second ? 1 : 0];
}

Bsdf Material::bsdf(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const {
    const auto bsdf_of = [&](bool isotropic, const auto& closure) {
        return Bsdf(isotropic ? Frame::from_z(hit.ns) : Frame::from_z_x(hit.ns, hit.dpdu), hit.ng, closure);
    };
    const auto plain = [&](const auto& closure) { return bsdf_of(true, closure); };
    struct Alpha {
        float x, y;
    };
    const auto facets = [&] { return Alpha{alpha(alpha_x_, remap_roughness_, point), alpha(alpha_y_, remap_roughness_, point)}; };
    const auto metal = [&] {
        return reflectance_.texture ? metal_of(reflectance(reflectance_, point), *point.spectra)
                                    : Metal{within(eta_, 1e-3f, 1e6f, point), within(k_, 0, 1e6f, point)};
    };
    const auto coated = [&]<class Base>(bool isotropic, const Base& base) {
        const Layer layer = layer_.at(hit, point, kept);
        return bsdf_of(isotropic && layer.coat.facets.alpha_x == layer.coat.facets.alpha_y,
                       Coated<Base>(point.spectra->store<typename Coated<Base>::State>({layer, base})));
    };
    switch (kind_) {
        case MaterialKind::kDiffuse:
            return plain(Diffuse(reflectance(reflectance_, point)));
        case MaterialKind::kPhong:
            return plain(
                Phong(reflectance(reflectance_, point), reflectance(specular_, point), within(exponent_, 0, 1e6f, point), retro_));
        case MaterialKind::kConductor: {
            const Metal m = metal();
            const Alpha a = facets();
            return bsdf_of(a.x == a.y, Conductor(m.eta, m.k, a.x, a.y));
        }
        case MaterialKind::kDielectric: {
            const Alpha a = facets();
            return bsdf_of(a.x == a.y, Dielectric(eta_.at(point), dispersive_, kept, a.x, a.y));
        }
        case MaterialKind::kThinDielectric:
            return plain(ThinDielectric(eta_.at(point), dispersive_, kept));
        case MaterialKind::kMetallicRoughness: {
            const float roughness = fraction(roughness_, point), coat_roughness = fraction(coat_roughness_, point);
            return plain(MetallicRoughness(reflectance(reflectance_, point), {.metallic = fraction(metallic_, point),
                                                                              .alpha = roughness * roughness,
                                                                              .f0 = f0_,
                                                                              .f90 = f90_,
                                                                              .coat = fraction(coat_, point),
                                                                              .coat_alpha = coat_roughness * coat_roughness}));
        }
        case MaterialKind::kDiffuseTransmission:
            return plain(DiffuseTransmission(scaled(reflectance_, scale_, point), scaled(specular_, scale_, point)));
        case MaterialKind::kCoatedDiffuse:
            return coated(true, Diffuse(reflectance(reflectance_, point)));
        case MaterialKind::kCoatedConductor: {
            const Metal m = metal();
            const Alpha a = facets();
            return coated(a.x == a.y, Conductor(layer_.below(m.eta, *point.spectra), layer_.below(m.k, *point.spectra), a.x, a.y));
        }
        case MaterialKind::kHair:
            return bsdf_of(false,
                           Hair(point.spectra->store<Hair::State>({hair_.at(point), hit.ribbon, hit.ribbon ? hit.across : 0})));
        case MaterialKind::kMix:
            break;
    }
    __builtin_unreachable();
}

}  // namespace latent::render
