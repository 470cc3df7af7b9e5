// render/texture/textures.h: all textures of a scene, built from their descriptions.
#pragma once

#include <memory>
#include <vector>

#include "base/result.h"
#include "image/pictures.h"
#include "render/scene/description.h"
#include "render/texture/image_texture.h"
#include "render/texture/texture.h"

namespace latent::render {

struct TextureSettings {
    std::uint64_t cache_bytes = 0;        // for decoded pictures; 0: what those without tiles take, within bounds
    std::uint32_t width = 0, height = 0;  // pixels that footprints are shares of; 0: the scene's film
};

class Textures {
 public:
    // Constant spectra go to `library`. At most `cache_bytes` of pictures are kept in memory (0: from 256 MiB to a quarter of the
    // memory that the process may use, as much as those need that have no tiles and so are read best as a whole). Errors: those of
    // image::Pictures, one line for each file.
    static Result<Textures> build(const SceneDescription& scene, std::uint64_t cache_bytes, SpectrumLibrary& library);

    // The first error of a picture that could not be read when it was needed: what has been rendered since is wrong.
    Status status() const { return pictures_ ? pictures_->status() : Status{}; }
    // From the start: that the cache is small. Then also what `lookup` met in files.
    std::vector<std::string> warnings() const;

    // The parameter that `input` describes. Textures live as long as this.
    FloatSource source(const FloatInput& input) const;
    SpectrumSource source(const SpectrumInput& input, SpectrumLibrary& library) const;
    SpectrumSource spectrum(std::uint32_t texture) const { return {0, spectra_[texture].get()}; }
    const ImageLookup& image(std::uint32_t texture) const { return *images_[texture]; }  // a normal map

 private:
    struct Builder;

    std::unique_ptr<image::Pictures> pictures_;
    std::string shortage_{};  // why the cache is too small, in words
    // One for each description.
    std::vector<std::unique_ptr<FloatTexture>> floats_;
    std::vector<std::unique_ptr<SpectrumTexture>> spectra_;
    std::vector<std::unique_ptr<ImageLookup>> images_;
};

}  // namespace latent::render
