#include "render/load/model/values.h"

#include <algorithm>

#include "render/load/files/pictures.h"

namespace latent::render {

std::uint32_t ModelValues::add(TextureDescription texture) {
    textures_.push_back(std::move(texture));
    return static_cast<std::uint32_t>(textures_.size() - 1);
}

SpectrumInput ModelValues::color(std::optional<TextureDescription> picture, const LinearRgb& factor, bool by_vertex_color) {
    if ((!picture && !by_vertex_color) || std::ranges::max(factor) == 0) return colors_.reflectance(factor);
    TextureDescription texture = picture ? std::move(*picture) : TextureDescription{.kind = TextureKind::kVertexColor};
    texture.is_spectrum = true;
    texture.tint = {factor[0], factor[1], factor[2], 1};
    texture.by_vertex_color = by_vertex_color;
    SpectrumInput out;
    out.texture = add(std::move(texture));
    return out;
}

FloatInput ModelValues::number(std::optional<TextureDescription> picture, PictureChannel channel, double factor,
                               bool by_vertex_color) {
    if ((!picture && !by_vertex_color) || factor == 0) return static_cast<float>(factor);
    TextureDescription texture = picture ? std::move(*picture) : TextureDescription{.kind = TextureKind::kVertexColor};
    texture.picture.is_srgb = false;
    texture.picture.channel = static_cast<std::uint8_t>(channel);
    texture.tint.fill(factor);
    texture.by_vertex_color = by_vertex_color;
    FloatInput out;
    out.texture = add(std::move(texture));
    return out;
}

FloatInput ModelValues::largest(std::optional<TextureDescription> picture, const LinearRgb& factor) {
    if (!picture || std::ranges::max(factor) == 0) return static_cast<float>(std::ranges::max(factor));
    picture->picture.channel = static_cast<std::uint8_t>(PictureChannel::kLargest);
    picture->tint = {factor[0], factor[1], factor[2], 1};
    FloatInput out;
    out.texture = add(std::move(*picture));
    return out;
}

Result<std::optional<AreaLightDescription>> ModelValues::emission(std::optional<TextureDescription> picture,
                                                                  const LinearRgb& factor) {
    AreaLightDescription out{.spectrum = colors_.emission(factor)};
    if (std::ranges::max(factor) == 0) return std::optional<AreaLightDescription>{};
    if (!picture) return std::optional(std::move(out));
    const Result<LoadedPicture> pixels = read_picture(picture->picture.path, picture->picture.name);
    if (!pixels) return pixels.error();
    out.mean_luminance = mean_luminance(pixels->image, factor);
    if (out.mean_luminance == 0) return std::optional<AreaLightDescription>{};
    picture->is_spectrum = true;
    picture->role = SpectrumRole::kUnbounded;
    picture->tint = {factor[0], factor[1], factor[2], 1};
    out.picture = add(std::move(*picture));
    out.spectrum = colors_.emission({1, 1, 1});
    return std::optional(std::move(out));
}

std::uint32_t ModelValues::normal_map(TextureDescription picture, bool is_srgb) {
    picture.kind = TextureKind::kNormalMap;
    picture.picture.is_srgb = is_srgb;
    return add(std::move(picture));
}

FloatInput ModelValues::between(double low, double high, const FloatInput& value) {
    if (!value.is_textured()) return static_cast<float>(low + (high - low) * static_cast<double>(value.value));
    TextureDescription texture{.kind = TextureKind::kMix};
    texture.numbers[0] = static_cast<float>(low);
    texture.numbers[1] = static_cast<float>(high);
    texture.amount = value;
    FloatInput out;
    out.texture = add(std::move(texture));
    return out;
}

SpectrumInput ModelValues::between(const SpectrumInput& low, const SpectrumInput& high, double share) {
    TextureDescription texture{.kind = TextureKind::kMix};
    texture.is_spectrum = true;
    texture.spectra[0] = low;
    texture.spectra[1] = high;
    texture.amount = static_cast<float>(share);
    SpectrumInput out;
    out.texture = add(std::move(texture));
    return out;
}

FloatInput ModelValues::product(const FloatInput& a, const FloatInput& b) {
    if (!a.is_textured() && !b.is_textured()) return a.value * b.value;
    TextureDescription texture{.kind = TextureKind::kScale};
    texture.numbers[0] = a;
    texture.amount = b;
    FloatInput out;
    out.texture = add(std::move(texture));
    return out;
}

SpectrumInput ModelValues::product(const SpectrumInput& color, const FloatInput& share) {
    TextureDescription texture{.kind = TextureKind::kScale};
    texture.is_spectrum = true;
    texture.spectra[0] = color;
    texture.amount = share;
    SpectrumInput out;
    out.texture = add(std::move(texture));
    return out;
}

FloatInput ModelValues::thresholded(const FloatInput& value, float threshold) {
    if (!value.is_textured()) return value.value >= threshold ? 1.0f : 0.0f;
    TextureDescription texture{.kind = TextureKind::kThreshold};
    texture.numbers[0] = value;
    texture.amount = threshold;
    FloatInput out;
    out.texture = add(std::move(texture));
    return out;
}

}  // namespace latent::render
