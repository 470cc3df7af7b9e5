#include "render/material/layers.h"

#include "render/material/values.h"
#include "render/sampling/random.h"

namespace latent::render {

LayerSource::LayerSource(const LayerDescription& d, const Textures& textures, SpectrumLibrary& library)
    : dispersive_(d.dispersive),
      scatters_(d.albedo.is_textured() || d.albedo.value.max_value() > 0),
      remap_roughness_(d.remap_roughness),
      eta_(library.add(d.eta, Lookup::kLinear)),
      alpha_x_(textures.source(d.alpha_x)),
      alpha_y_(textures.source(d.alpha_y)),
      thickness_(textures.source(d.thickness)),
      g_(textures.source(d.g)),
      albedo_(textures.source(d.albedo, library)),
      max_depth_(d.max_depth),
      walks_(d.walks) {}

// The key: point and first wavelength tell its vertex from all others, of this sample and of others.
Layer LayerSource::at(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const {
    SampledSpectra& spectra = *point.spectra;
    const SampledSpectrum& eta = spectra[eta_];
    return {.coat = {Microfacets::of_alpha(alpha(alpha_x_, remap_roughness_, point), alpha(alpha_y_, remap_roughness_, point)),
                     eta[kept]},
            .eta = dispersive_ ? &eta : nullptr,
            .thickness = within(thickness_, 0, 1e6f, point),
            .albedo = scatters_ ? &reflectance(albedo_, point) : nullptr,
            .g = within(g_, -0.9999f, 0.9999f, point),
            .max_depth = max_depth_,
            .walks = walks_,
            .key = mix(spectra.wavelengths.xi, hit.p)};
}

const SampledSpectrum& LayerSource::below(const SampledSpectrum& eta, SampledSpectra& spectra) const {
    const SampledSpectrum& layer = spectra[eta_];
    SampledSpectrum& out = spectra.allocate();
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = eta.v[i] / layer.v[i];
    return out;
}

}  // namespace latent::render
