// render/material/layers.h: the layer on a coated material, evaluated where a path meets it. docs/rendering.md, "Layers".
#pragma once

#include <cstdint>

#include "render/bsdf/coated.h"
#include "render/geometry/geometry.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"
#include "render/texture/textures.h"

namespace latent::render {

class LayerSource {
 public:
    // Its spectra go to `library`; `textures` outlive it.
    LayerSource(const LayerDescription& description, const Textures& textures, SpectrumLibrary& library);

    bool is_textured() const { return alpha_x_.texture || alpha_y_.texture || thickness_.texture || albedo_.texture || g_.texture; }
    Layer at(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const;
    // Of index `eta`, beside the layer instead of beside air.
    const SampledSpectrum& below(const SampledSpectrum& eta, SampledSpectra& spectra) const;

 private:
    bool dispersive_, scatters_, remap_roughness_;
    std::uint32_t eta_;  // in the library
    FloatSource alpha_x_, alpha_y_, thickness_, g_;
    SpectrumSource albedo_;
    std::uint32_t max_depth_, walks_;
};

}  // namespace latent::render
