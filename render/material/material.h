// render/material/material.h: what a surface is made of, evaluated where a path meets it. docs/rendering.md, "Surfaces".
#pragma once

#include <cstdint>

#include "render/bsdf/bsdf.h"
#include "render/geometry/geometry.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"

namespace latent::render {

class Material {
 public:
    // Its spectra go to `library`.
    Material(const MaterialDescription& description, SpectrumLibrary& library);

    // The surface at `hit`, in the wavelengths of `spectra`, of which a dispersed path keeps lane `kept`. Valid as long as
    // `spectra` stays at this sample: values that vary over the surface are allocated there.
    Bsdf bsdf(const SurfaceHit& hit, SampledSpectra& spectra, std::uint32_t kept) const;

 private:
    MaterialKind kind_;
    bool dispersive_;
    std::uint32_t reflectance_, specular_, eta_, k_;  // in the library
    float exponent_, alpha_x_, alpha_y_;
};

}  // namespace latent::render
