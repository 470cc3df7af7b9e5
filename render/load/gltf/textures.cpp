#include "render/load/gltf/textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/load/files/pictures.h"
#include "render/load/gltf/accessors.h"

namespace latent::render {

namespace {

constexpr std::uint64_t kNearest = 9728, kClamp = 33071, kMirror = 33648, kRepeat = 10497;

TextureWrap wrap_of(const GltfValue& mode) {
    switch (mode.count(kRepeat)) {
        case kClamp:
            return TextureWrap::kClamp;
        case kMirror:
            return TextureWrap::kMirror;
        case kRepeat:
            break;
        default:
            mode.warn("is unknown; the picture is repeated");
    }
    return TextureWrap::kRepeat;
}

void read_sampler(const GltfValue& sampler, PictureDescription& picture) {
    picture.wrap = {wrap_of(sampler["wrapS"]), wrap_of(sampler["wrapT"])};
    if (sampler["magFilter"].is_count() && sampler["magFilter"].count(0) == kNearest) picture.filter = TextureFilter::kPoint;
}

// KHR_texture_transform: (u, v) -> R S (u, v) + offset, with R = (cos, sin; -sin, cos), of coordinates whose v points down. Ours,
// w = 1 - v, points up.
void transform(const GltfValue& info, MappingDescription& mapping) {
    const GltfValue value = info.extension("KHR_texture_transform");
    if (!value.exists()) return;
    const std::array<double, 2> offset = value["offset"].numbers(std::array<double, 2>{0, 0}),
                                scale = value["scale"].numbers(std::array<double, 2>{1, 1});
    const double angle = value["rotation"].number(0), c = std::cos(angle), s = std::sin(angle);
    mapping.s = {c * scale[0], -s * scale[1]};
    mapping.t = {s * scale[0], c * scale[1]};
    mapping.delta_u = offset[0] + s * scale[1];
    mapping.delta_v = 1 - offset[1] - c * scale[1];
}

// Which TEXCOORD a textureInfo uses.
std::uint32_t uv_set_of(const GltfValue& info) {
    const GltfValue moved = info.extension("KHR_texture_transform")["texCoord"];
    return static_cast<std::uint32_t>(std::min<std::uint64_t>((moved.exists() ? moved : info["texCoord"]).count(0), 0xFFFFFF));
}

}  // namespace

void GltfTextures::begin_material(const GltfValue& first) {
    uv_sets_.clear();
    if (first.exists()) uv_sets_.push_back(uv_set_of(first));
}

std::uint32_t GltfTextures::index_of_set(const GltfValue& info) {
    const std::uint32_t set = uv_set_of(info);
    const auto known = std::ranges::find(uv_sets_, set);
    const auto index = static_cast<std::uint32_t>(known - uv_sets_.begin());
    if (known == uv_sets_.end()) uv_sets_.push_back(set);
    return index;
}

SpectrumInput GltfTextures::color(const GltfValue& info, const LinearRgb& factor, VertexColors vertices) {
    return values_.color(read(info), factor, vertices != VertexColors::kAbsent);
}

FloatInput GltfTextures::number(const GltfValue& info, PictureChannel channel, double factor, VertexColors vertices) {
    const bool by_vertices =
        channel == PictureChannel::kAlpha ? vertices == VertexColors::kRgba : vertices != VertexColors::kAbsent;
    std::optional<TextureDescription> picture = read(info);
    if (channel == PictureChannel::kAlpha && picture && has_no_alpha(picture->picture.path)) picture.reset();
    return values_.number(std::move(picture), channel, factor, by_vertices);
}

bool GltfTextures::has_no_alpha(const std::string& path) {
    const auto known = opaque_.find(path);
    return known != opaque_.end() ? known->second : opaque_.emplace(path, is_opaque(path)).first->second;
}

FloatInput GltfTextures::inverted(const GltfValue& info, PictureChannel channel, double factor) {
    std::optional<TextureDescription> picture = read(info);
    if (!picture) return static_cast<float>(1 - factor);
    picture->picture.scale = factor;
    picture->picture.invert = true;
    return values_.number(std::move(picture), channel, 1);
}

std::uint32_t GltfTextures::normal_map(const GltfValue& info) {
    std::optional<TextureDescription> picture = read(info);
    return picture ? values_.normal_map(std::move(*picture)) : kNone;
}

std::optional<AreaLightDescription> GltfTextures::emission(const GltfValue& info, const LinearRgb& factor) {
    std::optional<TextureDescription> picture = read(info);
    if (info.exists() && !picture) return std::nullopt;
    Result<std::optional<AreaLightDescription>> out = values_.emission(std::move(picture), factor);
    if (out) return std::move(*out);
    info.error(out.error().message);
    return std::nullopt;
}

std::optional<TextureDescription> GltfTextures::read(const GltfValue& info) {
    if (!info.exists()) return std::nullopt;
    const GltfValue textures = document_.root()["textures"];
    const std::optional<std::uint32_t> index = info["index"].index(textures);
    if (!index) return std::nullopt;
    const GltfValue texture = textures[*index];
    const GltfValue webp = texture.extension("EXT_texture_webp")["source"], source = webp.exists() ? webp : texture["source"];
    if (!source.exists() && !texture["extensions"].exists()) {
        texture.warn("is ignored: it has no source");
        return std::nullopt;
    }
    if (!source.exists()) texture.error("has no source that is supported");
    const std::optional<std::uint32_t> image = source.index(document_.root()["images"]);
    if (!image) return std::nullopt;
    const std::optional<PictureDescription>& known = picture(*image);
    if (!known) return std::nullopt;
    TextureDescription out{.kind = TextureKind::kImage};
    out.picture = *known;
    out.picture.filter = TextureFilter::kTrilinear;
    if (const auto sampler = texture["sampler"].index(document_.root()["samplers"]))
        read_sampler(document_.root()["samplers"][*sampler], out.picture);
    transform(info, out.mapping);
    out.mapping.uv_set = index_of_set(info);
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
        uri.error(fmt::format("\"{}\" is not a path; give that of a file beside this one", uri.text().substr(0, 80)));
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
