#include "render/load/gltf/textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/load/files/pictures.h"
#include "render/load/gltf/accessors.h"

namespace latent::render {

namespace {

constexpr std::uint64_t kClamp = 33071, kMirror = 33648, kRepeat = 10497;

TextureWrap wrap_of(const GltfValue& sampler) {
    const std::uint64_t s = sampler["wrapS"].count(kRepeat), t = sampler["wrapT"].count(kRepeat);
    if (s == kMirror || t == kMirror || s != t)
        sampler.warn("mirrored and mixed wrapping are not supported; the picture is repeated");
    return s == kClamp && t == kClamp ? TextureWrap::kClamp : TextureWrap::kRepeat;
}

// KHR_texture_transform moves coordinates whose v points down; ours points up.
void transform(const GltfValue& info, MappingDescription& mapping) {
    const GltfValue value = info.extension("KHR_texture_transform");
    if (!value.exists()) return;
    const std::array<double, 2> offset = value["offset"].numbers(std::array<double, 2>{0, 0}),
                                scale = value["scale"].numbers(std::array<double, 2>{1, 1});
    if (value["rotation"].number(0) != 0) value["rotation"].warn("is ignored");
    mapping.scale_u = scale[0];
    mapping.scale_v = scale[1];
    mapping.delta_u = offset[0];
    mapping.delta_v = 1 - offset[1] - scale[1];
}

}  // namespace

std::uint32_t uv_set_of(const GltfValue& info) {
    const GltfValue moved = info.extension("KHR_texture_transform")["texCoord"];
    return static_cast<std::uint32_t>(std::min<std::uint64_t>((moved.exists() ? moved : info["texCoord"]).count(0), 0xFFFFFF));
}

std::uint32_t GltfTextures::color(const GltfValue& info, double scale) {
    std::optional<TextureDescription> texture = read(info, scale);
    if (!texture) return kNone;
    texture->is_spectrum = true;
    textures_.push_back(std::move(*texture));
    return static_cast<std::uint32_t>(textures_.size() - 1);
}

std::uint32_t GltfTextures::emission(const GltfValue& info) {
    const std::uint32_t i = color(info, 1);
    if (i != kNone) textures_[i].role = SpectrumRole::kUnbounded;
    return i;
}

Result<double> GltfTextures::mean_luminance(std::uint32_t texture) const {
    const Result<LoadedPicture> picture = read_picture(textures_[texture].picture.path);
    if (!picture) return picture.error();
    return render::mean_luminance(picture->image);
}

std::uint32_t GltfTextures::normal_map(const GltfValue& info) {
    const std::uint32_t i = number(info, PictureChannel::kRed, 1);
    if (i != kNone) textures_[i].kind = TextureKind::kNormalMap;
    return i;
}

std::uint32_t GltfTextures::number(const GltfValue& info, PictureChannel channel, double scale) {
    if (scale == 0) return kNone;
    std::optional<TextureDescription> texture = read(info, scale);
    if (!texture) return kNone;
    texture->picture.is_srgb = false;
    texture->picture.channel = static_cast<std::uint8_t>(channel);
    textures_.push_back(std::move(*texture));
    return static_cast<std::uint32_t>(textures_.size() - 1);
}

FloatInput GltfTextures::thresholded(const FloatInput& value, float threshold) {
    if (!value.is_textured()) return value.value >= threshold ? 1.0f : 0.0f;
    TextureDescription texture{.kind = TextureKind::kThreshold};
    texture.numbers[0] = value;
    texture.amount = threshold;
    textures_.push_back(std::move(texture));
    FloatInput out;
    out.texture = static_cast<std::uint32_t>(textures_.size() - 1);
    return out;
}

std::optional<TextureDescription> GltfTextures::read(const GltfValue& info, double scale) {
    if (!info.exists()) return std::nullopt;
    const GltfValue textures = document_.root()["textures"];
    const std::optional<std::uint32_t> index = info["index"].index(textures);
    if (!index) return std::nullopt;
    const GltfValue texture = textures[*index];
    if (!texture["source"].exists()) texture.error("has no source that is supported");
    const std::optional<std::uint32_t> image = texture["source"].index(document_.root()["images"]);
    if (!image) return std::nullopt;
    const std::optional<PictureDescription>& known = picture(*image);
    if (!known) return std::nullopt;
    TextureDescription out{.kind = TextureKind::kImage};
    out.picture = *known;
    out.picture.scale = scale;
    out.picture.filter = TextureFilter::kTrilinear;
    if (const auto sampler = texture["sampler"].index(document_.root()["samplers"]))
        out.picture.wrap = wrap_of(document_.root()["samplers"][*sampler]);
    transform(info, out.mapping);
    if (std::ranges::find(used_, info.path(), &GltfValue::path) == used_.end()) used_.push_back(info);
    return out;
}

const std::optional<PictureDescription>& GltfTextures::picture(std::uint32_t index) {
    const auto [entry, is_new] = pictures_.try_emplace(index);
    if (!is_new) return entry->second;
    const GltfValue image = document_.root()["images"][index], uri = image["uri"];
    if (!uri.exists()) {
        const std::optional<std::string> bytes = buffer_view(document_, image["bufferView"]);
        if (bytes) entry->second = embedded(image, *bytes);
        if (!image["bufferView"].exists()) image.error("has neither a uri nor a bufferView");
    } else if (uri.text().starts_with("data:")) {
        if (const std::optional<std::string> bytes = document_.resource(uri)) entry->second = embedded(image, *bytes);
    } else if (const std::optional<std::string> name = file_of_uri(uri.text())) {
        const Result<Hash128> content = document_.files().hash(*name);
        if (!content) uri.error(content.error().message);
        const std::string path = document_.files().resolve(*name).string();
        if (content) entry->second = PictureDescription{.path = path, .name = uri.path() + ": " + path, .content = *content};
    } else {
        uri.error(fmt::format("\"{}\" is not a file; nothing is loaded from a network", uri.text().substr(0, 80)));
    }
    return entry->second;
}

std::optional<PictureDescription> GltfTextures::embedded(const GltfValue& image, const std::string& bytes) {
    Result<File> file = File::create_unnamed(std::filesystem::temp_directory_path());
    const ByteSpan content = std::as_bytes(std::span(bytes));
    const Status written = file ? file->write_all(0, content) : Status(file.error());
    if (!written) {
        image.error(written.error().message);
        return std::nullopt;
    }
    embedded_.push_back(std::move(*file));
    return PictureDescription{
        .path = fmt::format("/proc/self/fd/{}", embedded_.back().descriptor()), .name = image.path(), .content = hash128(content)};
}

}  // namespace latent::render
