// render/load/gltf/textures.h: the textures of glTF materials: pictures, in files of their own or in the file's buffers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/file.h"
#include "render/load/gltf/document.h"
#include "render/load/model/values.h"
#include "render/scene/texture.h"

namespace latent::render {

// Whether primitives of a material have colours at their vertices, which multiply its base colour.
enum class VertexColors : std::uint8_t { kAbsent, kRgb, kRgba };

class GltfTextures {
 public:
    // All of these, and the list, which grows, outlive it.
    GltfTextures(const GltfDocument& document, const ModelColors& colors, std::vector<TextureDescription>& textures)
        : document_(document), values_(colors, textures) {}

    // The first of the sets of texture coordinates is that of `first`, if there is such a textureInfo: it orients tangents.
    void begin_material(const GltfValue& first);
    // The TEXCOORD_N that the textures of the material use so far, in the order of MappingDescription::uv_set.
    const std::vector<std::uint32_t>& uv_sets() const { return uv_sets_; }

    // A value of a material: a factor, times the textureInfo if there is one, times the colours of vertices. Pictures of colours
    // are encoded like sRGB's, those of numbers are linear. If the texture cannot be read: an error, and the factor.
    SpectrumInput color(const GltfValue& info, const LinearRgb& factor, VertexColors vertices = VertexColors::kAbsent);
    FloatInput number(const GltfValue& info, PictureChannel channel, double factor, VertexColors vertices = VertexColors::kAbsent);
    // 1 minus a factor times the textureInfo.
    FloatInput inverted(const GltfValue& info, PictureChannel channel, double factor);
    // The largest of R, G and B of a factor times the textureInfo, which is of colours.
    FloatInput largest(const GltfValue& info, const LinearRgb& factor) { return values_.largest(read(info), factor); }
    // The index of the texture; kNone, with an error, if it cannot be read.
    std::uint32_t normal_map(const GltfValue& info);
    // Nothing if it is black, or with an error.
    std::optional<AreaLightDescription> emission(const GltfValue& info, const LinearRgb& factor);
    // From `low` to `high` as `value` goes from 0 to 1.
    FloatInput between(double low, double high, const FloatInput& value) { return values_.between(low, high, value); }
    FloatInput product(const FloatInput& a, const FloatInput& b) { return values_.product(a, b); }
    SpectrumInput product(const SpectrumInput& color, const FloatInput& share) { return values_.product(color, share); }
    // 1 where `value` reaches `threshold`, 0 elsewhere.
    FloatInput thresholded(const FloatInput& value, float threshold) { return values_.thresholded(value, threshold); }

    // Pictures out of buffers, as files without a name: textures find them as long as they are open.
    std::vector<File> take_embedded() { return std::move(embedded_); }

 private:
    std::optional<TextureDescription> read(const GltfValue& info);
    std::uint32_t index_of_set(const GltfValue& info);
    bool has_no_alpha(const std::string& path);
    const std::optional<PictureDescription>& picture(std::uint32_t image);
    std::optional<PictureDescription> embedded(const GltfValue& image, const std::string& bytes);

    const GltfDocument& document_;
    ModelValues values_;
    std::map<std::uint32_t, std::optional<PictureDescription>> pictures_;  // by index of /images
    std::map<std::string, bool> opaque_;                                   // by path
    std::vector<File> embedded_;
    std::vector<std::uint32_t> uv_sets_;
};

}  // namespace latent::render
