// render/material/material.h: what a surface is made of, evaluated where a path hits it. docs/rendering.md, "Surfaces".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "render/bsdf/bsdf.h"
#include "render/geometry/geometry.h"
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
    // Whether it refracts wavelengths into different directions.
    bool disperses() const { return disperses_; }

    // The surface at `hit`, in the wavelengths of point.spectra, of which a dispersed path keeps `kept`. Valid as long as
    // these stay at this sample: values that vary over the surface are allocated there.
    Bsdf bsdf(const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept) const { return make_(*this, hit, point, kept); }

    // The material of a mixture at this point: one of two, by a hash of the place, in the shares that it describes. So a mixture is
    // one surface, whichever path comes there. If the shares vary with wavelength, the choice is made by their mean, and `weight`
    // (null: 1) is multiplied by the share over its probability. `depth`: how many mixtures this one is within; each has a hash of
    // its own, so that their choices are independent.
    bool is_mixture() const { return make_ == nullptr; }
    std::uint32_t chosen(const TexturePoint& point, std::uint32_t depth, const SampledSpectrum*& weight) const;

    const Relief& relief() const { return relief_; }
    const Relief& coat_relief() const { return coat_relief_; }

 private:
    // An input, ready to be evaluated: one of these by its role.
    struct Source {
        SpectrumSource spectrum{};
        FloatSource number{};
        std::uint32_t option = 0;
        float factor = 1;       // multiplies the spectrum
        bool is_there = false;  // the spectrum
        bool varies = false;    // the index, with wavelength
        bool is_root = false;   // alpha is the root of what the texture gives
    };
    Source source(const Input& input, const MaterialDescription& description, const Textures& textures, SpectrumLibrary& library);
    static const SampledSpectrum& spectrum(const Input& input, const Source& source, const TexturePoint& point);
    static float number(const Input& input, const Source& source, const TexturePoint& point);
    template <Closure C>
    static Bsdf make(const Material& material, const SurfaceHit& hit, const TexturePoint& point, std::uint32_t kept);

    bool is_textured_ = false, disperses_ = false;
    Bsdf (*make_)(const Material&, const SurfaceHit&, const TexturePoint&, std::uint32_t) = nullptr;
    std::vector<Source> sources_;                     // where the closure's inputs come from
    std::unique_ptr<const MeasuredTables> measured_;  // null: it was not measured
    std::array<std::uint32_t, 2> mixed_;
    Relief relief_, coat_relief_;
};

}  // namespace latent::render
