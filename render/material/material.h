// render/material/material.h: what a surface is made of, evaluated where a path meets it. docs/rendering.md, "Surfaces".
#pragma once

#include <array>
#include <cstdint>

#include "render/bsdf/bsdf.h"
#include "render/geometry/geometry.h"
#include "render/material/fibre.h"
#include "render/material/layers.h"
#include "render/material/relief.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"
#include "render/texture/textures.h"

namespace latent::render {

class Material {
 public:
    // Its spectra go to `library`; `textures` outlive it.
    Material(const MaterialDescription& description, const Textures& textures, SpectrumLibrary& library);

    // Whether the point that `bsdf` is given must be filled in; otherwise its spectra are enough.
    bool is_textured() const { return is_textured_; }

    // The surface at `hit`, in the wavelengths of point.spectra, of which a dispersed path keeps `kept`. Valid as long as
    // these stay at this sample: values that vary over the surface are allocated there.
    Bsdf bsdf(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const;

    // Of a mixture: the material at this point, one of two by a hash of the place, in the shares that it describes. So a mixture is
    // one surface, whichever path comes there. If the shares vary with wavelength, the choice is made by their mean, and `weight`
    // (null: 1) is multiplied by the share over its probability.
    bool is_mixture() const { return kind_ == MaterialKind::kMix; }
    std::uint32_t chosen(const TexturePoint& point, const SampledSpectrum*& weight) const;

    const Relief& relief() const { return relief_; }

 private:
    FloatSource source(const FloatInput& input, const Textures& textures);
    SpectrumSource source(const SpectrumInput& input, const Textures& textures, SpectrumLibrary& library);

    bool is_textured_ = false;
    MaterialKind kind_;
    bool dispersive_, remap_roughness_;
    SpectrumSource reflectance_, specular_, eta_, k_;
    float scale_;
    FloatSource exponent_, alpha_x_, alpha_y_;
    FloatSource roughness_, metallic_, coat_, coat_roughness_;
    float f0_, f90_;
    LayerSource layer_;
    HairSource hair_;
    FloatSource amount_;
    std::array<std::uint32_t, 2> mixed_;
    std::optional<SpectrumSource> selector_;
    bool retro_;
    Relief relief_;
};

}  // namespace latent::render
