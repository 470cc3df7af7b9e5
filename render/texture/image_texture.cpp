#include "render/texture/image_texture.h"

#include <algorithm>
#include <cmath>

namespace latent::render {

namespace {

// The square of an octahedral map continues across its edges turned by half a turn.
Vec2f wrapped_octahedron(Vec2f st) {
    const auto fold = [](float x, float& other) {
        if (x < 0) x = -x, other = 1 - other;
        if (x > 1) x = 2 - x, other = 1 - other;
        return x;
    };
    const auto near = [](float x) { return x - 2 * std::floor((x + 0.5f) / 2); };  // the map repeats with period 2
    st = {near(st.x), near(st.y)};
    st.x = fold(st.x, st.y);
    st.y = fold(st.y, st.x);
    return st;
}

image::PictureWrap wrap_of(TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::kRepeat:
            return image::PictureWrap::kRepeat;
        case TextureWrap::kBlack:
            return image::PictureWrap::kBlack;
        case TextureWrap::kClamp:
        case TextureWrap::kOctahedralSphere:
            break;
    }
    return image::PictureWrap::kClamp;
}

image::PictureFilter filter_of(TextureFilter filter) {
    switch (filter) {
        case TextureFilter::kPoint:
            return image::PictureFilter::kPoint;
        case TextureFilter::kBilinear:
            return image::PictureFilter::kBilinear;
        case TextureFilter::kTrilinear:
            return image::PictureFilter::kTrilinear;
        case TextureFilter::kQuartic:
            return image::PictureFilter::kQuartic;
        case TextureFilter::kEwa:
            break;
    }
    return image::PictureFilter::kEwa;
}

}  // namespace

ImageLookup::ImageLookup(const TextureDescription& d, const image::Pictures& pictures, const image::PictureInfo& info)
    : mapping_(d.mapping),
      pictures_(&pictures),
      info_(info),
      sampling_{wrap_of(d.picture.wrap), filter_of(d.picture.filter), static_cast<int>(d.picture.max_anisotropy)},
      octahedral_(d.picture.wrap == TextureWrap::kOctahedralSphere),
      invert_(d.picture.invert),
      scale_(static_cast<float>(d.picture.scale)) {}

std::array<float, 4> ImageLookup::at(const TexturePoint& point) const {
    const TextureCoordinates c = mapping_(point);
    std::array<float, 4> out;
    Vec2f st{c.st.x, 1 - c.st.y};
    if (octahedral_) st = wrapped_octahedron(st);
    pictures_->lookup(info_.index, sampling_, st.x, st.y, {c.dstdx.x, -c.dstdx.y}, {c.dstdy.x, -c.dstdy.y}, out);
    if (info_.channels < 4) out[3] = 1;
    for (float& x : out) {
        x = invert_ ? std::max(0.0f, 1 - scale_ * x) : scale_ * x;
        if (!std::isfinite(x)) x = 0;
    }
    return out;
}

float FloatImage::at(const TexturePoint& point) const {
    const std::array<float, 4> x = image_.at(point);
    const image::PictureInfo& info = image_.info();
    if (channel_ == 3) return x[3];
    if (info.channels == 1) return x[0];
    if (channel_ < info.channels) return x[channel_];
    return info.is_opaque ? (x[0] + x[1] + x[2]) / 3 : x[3];
}

SpectrumImage::SpectrumImage(const ImageLookup& image, SpectrumRole role, const color::Matrix3& srgb_from_file,
                             const RgbColors& colors)
    : image_(image), role_(role), convert_(false), colors_(colors) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            matrix_[i][j] = static_cast<float>(srgb_from_file.m[i][j]);
            convert_ |= std::abs(matrix_[i][j] - (i == j ? 1 : 0)) > 1e-5f;
        }
    }
}

const SampledSpectrum* SpectrumImage::at(const TexturePoint& point) const {
    const std::array<float, 4> x = image_.at(point);
    SampledSpectrum& out = point.spectra->allocate();
    if (image_.info().channels == 1) {
        const float grey = std::max(x[0], 0.0f);
        out = SampledSpectrum(role_ == SpectrumRole::kReflectance ? std::min(grey, 1.0f) : grey);
        return &out;
    }
    float rgb[3] = {std::max(x[0], 0.0f), std::max(x[1], 0.0f), std::max(x[2], 0.0f)};
    if (convert_) {
        const float own[3] = {rgb[0], rgb[1], rgb[2]};
        for (std::size_t i = 0; i < 3; ++i)
            rgb[i] = std::max(0.0f, matrix_[i][0] * own[0] + matrix_[i][1] * own[1] + matrix_[i][2] * own[2]);
    }
    colors_.evaluate(rgb, role_, *point.spectra, out);
    return &out;
}

}  // namespace latent::render
