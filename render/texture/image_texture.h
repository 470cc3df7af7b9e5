// render/texture/image_texture.h: textures that are pictures or colours of vertices.
#pragma once

#include <optional>

#include "color/tristimulus.h"
#include "image/pictures.h"
#include "render/texture/mapping.h"
#include "render/texture/rgb_spectrum.h"

namespace latent::render {

class ImageLookup {
 public:
    // `pictures` outlives it.
    ImageLookup(const TextureDescription& description, const image::Pictures& pictures, const image::PictureInfo& info);

    const image::PictureInfo& info() const { return info_; }
    // scale x, or max(0, 1 - scale x), of each channel. Without a channel for alpha, x = 1 there.
    std::array<float, 4> at(const TexturePoint& point) const;

 private:
    Mapping mapping_;
    const image::Pictures* pictures_;
    image::PictureInfo info_;
    image::PictureSampling sampling_;
    bool octahedral_, invert_;
    float scale_;
};

// A factor times a picture, times the colours of the mesh's vertices: R, G, B and alpha, each of which a texture may lack.
class ColorProduct {
 public:
    // Without a picture: the colours of the vertices.
    ColorProduct(const TextureDescription& description, std::optional<ImageLookup> picture, const color::Matrix3& srgb_from_file);

    std::array<float, 4> at(const TexturePoint& point) const;
    // Whether a spectrum of equal R, G and B is constant: if the picture is of colours, it becomes one as any other does.
    bool is_grey() const { return !picture_ || picture_->info().channels == 1; }
    std::uint32_t channels() const { return by_vertex_color_ ? 4 : picture_->info().channels; }
    bool is_opaque() const { return !picture_ || picture_->info().is_opaque; }

 private:
    std::optional<ImageLookup> picture_;
    bool by_vertex_color_, is_tinted_, convert_;
    std::array<float, 4> tint_;
    float matrix_[3][3];
};

// One channel (3: alpha), or the largest of them (254), or the mean of them, or alpha if it varies.
class FloatColor final : public FloatTexture {
 public:
    FloatColor(const ColorProduct& color, std::uint8_t channel) : color_(color), channel_(channel) {}
    float at(const TexturePoint& point) const override;

 private:
    ColorProduct color_;
    std::uint8_t channel_;
};

// Colours are made spectral after filtering.
class SpectrumColor final : public SpectrumTexture {
 public:
    SpectrumColor(const ColorProduct& color, SpectrumRole role, const RgbColors& colors)
        : color_(color), role_(role), colors_(colors) {}
    const SampledSpectrum* at(const TexturePoint& point) const override;

 private:
    ColorProduct color_;
    SpectrumRole role_;
    RgbColors colors_;
};

}  // namespace latent::render
