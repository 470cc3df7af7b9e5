// render/material/fibre.h: what a hair is made of, evaluated where a path meets it. docs/rendering.md, "Hair".
#pragma once

#include "render/bsdf/hair.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"
#include "render/texture/textures.h"

namespace latent::render {

class HairSource {
 public:
    // Its spectra go to `library`; `textures` outlive it.
    HairSource(const HairDescription& description, const Textures& textures, SpectrumLibrary& library);

    Fibre at(const TexturePoint& point) const;

 private:
    bool has_color_;
    SpectrumSource sigma_a_, color_;
    FloatSource eta_, beta_m_, beta_n_, alpha_degrees_;
};

}  // namespace latent::render
