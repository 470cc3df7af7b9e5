// render/texture/textures.h: all textures of a scene, built from their descriptions.
#pragma once

#include <memory>
#include <vector>

#include "base/result.h"
#include "render/scene/description.h"
#include "render/texture/texture.h"

namespace latent::render {

class Textures {
 public:
    // Constant spectra go to `library`.
    static Result<Textures> build(const SceneDescription& scene, SpectrumLibrary& library);

    // The parameter that `input` describes. Textures live as long as this.
    FloatSource source(const FloatInput& input) const;
    SpectrumSource source(const SpectrumInput& input, SpectrumLibrary& library) const;

 private:
    struct Builder;

    // Of each description, the one or the other.
    std::vector<std::unique_ptr<FloatTexture>> floats_;
    std::vector<std::unique_ptr<SpectrumTexture>> spectra_;
};

}  // namespace latent::render
