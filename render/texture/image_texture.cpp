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
        case TextureWrap::kMirror:
            return image::PictureWrap::kMirror;
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
      sampling_{{wrap_of(d.picture.wrap[0]), wrap_of(d.picture.wrap[1])},
                filter_of(d.picture.filter),
                static_cast<int>(d.picture.max_anisotropy)},
      octahedral_(d.picture.wrap[0] == TextureWrap::kOctahedralSphere),
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

ColorProduct::ColorProduct(const TextureDescription& d, std::optional<ImageLookup> picture, const color::Matrix3& srgb_from_file)
    : picture_(picture),
      by_vertex_color_(d.by_vertex_color || d.kind == TextureKind::kVertexColor),
      is_tinted_(std::ranges::any_of(d.tint, [](double x) { return x != 1; })),
      convert_(false) {
    for (std::size_t i = 0; i < 4; ++i) tint_[i] = static_cast<float>(d.tint[i]);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            matrix_[i][j] = static_cast<float>(srgb_from_file.m[i][j]);
            convert_ |= std::abs(matrix_[i][j] - (i == j ? 1 : 0)) > 1e-5f;
        }
    }
}

std::array<float, 4> ColorProduct::at(const TexturePoint& point) const {
    std::array<float, 4> out{1, 1, 1, 1};
    if (picture_) {
        out = picture_->at(point);
        if (picture_->info().channels == 1) out = {out[0], out[0], out[0], 1};
    }
    if (convert_) {
        const float own[3] = {std::max(out[0], 0.0f), std::max(out[1], 0.0f), std::max(out[2], 0.0f)};
        for (std::size_t i = 0; i < 3; ++i)
            out[i] = std::max(0.0f, matrix_[i][0] * own[0] + matrix_[i][1] * own[1] + matrix_[i][2] * own[2]);
    }
    const auto times = [&](const std::array<float, 4>& factor) {
        for (std::size_t i = 0; i < 4; ++i) out[i] *= factor[i];
    };
    if (by_vertex_color_) times(point.vertices.color());
    if (is_tinted_) times(tint_);
    return out;
}

float FloatColor::at(const TexturePoint& point) const {
    const std::array<float, 4> x = color_.at(point);
    if (channel_ == 3) return x[3];
    if (color_.channels() == 1) return x[0];
    if (channel_ < color_.channels()) return x[channel_];
    if (channel_ == 254) return std::max({x[0], x[1], x[2]});
    return color_.is_opaque() ? (x[0] + x[1] + x[2]) / 3 : x[3];
}

const SampledSpectrum* SpectrumColor::at(const TexturePoint& point) const {
    const std::array<float, 4> x = color_.at(point);
    const float rgb[3] = {std::max(x[0], 0.0f), std::max(x[1], 0.0f), std::max(x[2], 0.0f)};
    SampledSpectrum& out = point.spectra->allocate();
    if (color_.is_grey() && rgb[0] == rgb[1] && rgb[1] == rgb[2]) {
        out = SampledSpectrum(role_ == SpectrumRole::kReflectance ? std::min(rgb[0], 1.0f) : rgb[0]);
    } else {
        colors_.evaluate(rgb, role_, *point.spectra, out);
    }
    return &out;
}

}  // namespace latent::render
