// render/texture/image_texture.h: textures that are pictures.
#pragma once

#include "color/tristimulus.h"
#include "image/pictures.h"
#include "render/texture/mapping.h"
#include "render/texture/rgb_spectrum.h"

namespace latent::render {

// What both kinds of texture look up.
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

// One channel (3: alpha), or the mean of them, or alpha if it varies.
class FloatImage final : public FloatTexture {
 public:
    FloatImage(const ImageLookup& image, std::uint8_t channel) : image_(image), channel_(channel) {}
    float at(const TexturePoint& point) const override;

 private:
    ImageLookup image_;
    std::uint8_t channel_;
};

// Colours are made spectral after filtering.
class SpectrumImage final : public SpectrumTexture {
 public:
    SpectrumImage(const ImageLookup& image, SpectrumRole role, const color::Matrix3& srgb_from_file, const RgbColors& colors);
    const SampledSpectrum* at(const TexturePoint& point) const override;

 private:
    ImageLookup image_;
    SpectrumRole role_;
    bool convert_;
    float matrix_[3][3];
    RgbColors colors_;
};

}  // namespace latent::render
