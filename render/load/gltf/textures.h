// render/load/gltf/textures.h: the textures of glTF materials: pictures, in files of their own or in the file's buffers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/file.h"
#include "render/load/gltf/document.h"
#include "render/scene/texture.h"

namespace latent::render {

enum class PictureChannel : std::uint8_t { kRed, kGreen, kBlue, kAlpha };

class GltfTextures {
 public:
    // The document and the list, which grows, outlive it.
    GltfTextures(const GltfDocument& document, std::vector<TextureDescription>& textures)
        : document_(document), textures_(textures) {}

    // Those of the materials that are read from now on are noted in `used`.
    void begin_material() { used_.clear(); }
    // The textureInfos since then that became textures, in their order.
    const std::vector<GltfValue>& used() const { return used_; }

    // A textureInfo of a material, times `scale`: the index of the texture that it becomes. kNone if there is none, if it is
    // scaled to nothing, or with an error. Colours are encoded like sRGB's, numbers are linear.
    std::uint32_t color(const GltfValue& info, double scale);
    std::uint32_t emission(const GltfValue& info);
    std::uint32_t normal_map(const GltfValue& info);
    std::uint32_t number(const GltfValue& info, PictureChannel channel, double scale);
    // Of a texture that is a picture. Errors: those of read_picture.
    Result<double> mean_luminance(std::uint32_t texture) const;
    // 1 where `value` reaches `threshold`, 0 elsewhere.
    FloatInput thresholded(const FloatInput& value, float threshold);

    // Pictures out of buffers, as files without a name: textures find them as long as they are open.
    std::vector<File> take_embedded() { return std::move(embedded_); }

 private:
    std::optional<TextureDescription> read(const GltfValue& info, double scale);
    const std::optional<PictureDescription>& picture(std::uint32_t image);
    std::optional<PictureDescription> embedded(const GltfValue& image, const std::string& bytes);

    const GltfDocument& document_;
    std::vector<TextureDescription>& textures_;
    std::map<std::uint32_t, std::optional<PictureDescription>> pictures_;  // by index of /images
    std::vector<File> embedded_;
    std::vector<GltfValue> used_;
};

// Which TEXCOORD a textureInfo uses.
std::uint32_t uv_set_of(const GltfValue& info);

}  // namespace latent::render
