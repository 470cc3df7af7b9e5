// render/load/model/values.h: the values of a model's materials: a factor, times a picture, times the colours of vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.h"
#include "render/load/model/colors.h"
#include "render/scene/description.h"

namespace latent::render {

// kMean: of R, G and B, or alpha if it varies. kLargest: of R, G and B.
enum class PictureChannel : std::uint8_t { kRed, kGreen, kBlue, kAlpha, kLargest = 254, kMean = 255 };

class ModelValues {
 public:
    // Both outlive it; the list grows.
    ModelValues(const ModelColors& colors, std::vector<TextureDescription>& textures) : colors_(colors), textures_(textures) {}

    // `picture`: of kind kImage, without a tint. Pictures of colours are encoded like sRGB's, those of numbers are linear.
    SpectrumInput color(std::optional<TextureDescription> picture, const LinearRgb& factor, bool by_vertex_color = false);
    FloatInput number(std::optional<TextureDescription> picture, PictureChannel channel, double factor,
                      bool by_vertex_color = false);
    // The largest of R, G and B of a colour.
    FloatInput largest(std::optional<TextureDescription> picture, const LinearRgb& factor);
    // What a surface emits: nothing if it is black everywhere. Errors: those of read_picture.
    Result<std::optional<AreaLightDescription>> emission(std::optional<TextureDescription> picture, const LinearRgb& factor);
    // The index of the texture. `is_srgb`: its normals are encoded as if they were colours.
    std::uint32_t normal_map(TextureDescription picture, bool is_srgb = false);
    // From `low` to `high` as `value` goes from 0 to 1.
    FloatInput between(double low, double high, const FloatInput& value);
    // The same of colours, at a `share` of the way.
    SpectrumInput between(const SpectrumInput& low, const SpectrumInput& high, double share);
    FloatInput product(const FloatInput& a, const FloatInput& b);
    // The product of a reflectance with a share; above 1 it is 1.
    SpectrumInput product(const SpectrumInput& color, const FloatInput& share);
    // 1 where `value` reaches `threshold`, 0 elsewhere.
    FloatInput thresholded(const FloatInput& value, float threshold);

 private:
    std::uint32_t add(TextureDescription texture);

    const ModelColors& colors_;
    std::vector<TextureDescription>& textures_;
};

}  // namespace latent::render
