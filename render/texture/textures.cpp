#include "render/texture/textures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "base/memory.h"
#include "base/size.h"
#include "color/to_srgb.h"
#include "render/texture/combine.h"
#include "render/texture/procedural.h"

namespace latent::render {

namespace {
constexpr std::uint64_t kMinCache = std::uint64_t{256} << 20;
}

// Builds each texture after its inputs, which render/scene/check.h has found to form no circle.
struct Textures::Builder {
    const SceneDescription& scene;
    std::uint64_t cache_bytes;
    SpectrumLibrary& library;
    Textures& out;
    std::map<std::tuple<std::string, bool, double>, Result<image::PictureInfo>> opened{};  // by path and encoding
    std::vector<std::string> errors{};
    std::optional<RgbColors> known_colors{};

    const RgbColors& colors() {  // the scene's, made when first needed
        if (!known_colors) known_colors.emplace(scene.rgb_spectra, library);
        return *known_colors;
    }

    FloatSource source(const FloatInput& input) {
        if (input.is_textured()) build(input.texture);
        return out.source(input);
    }
    SpectrumSource source(const SpectrumInput& input) {
        if (input.is_textured()) build(input.texture);
        return out.source(input, library);
    }
    FloatSource input_of(float, const TextureDescription& d, std::size_t i) { return source(d.numbers[i]); }
    SpectrumSource input_of(const SampledSpectrum*, const TextureDescription& d, std::size_t i) { return source(d.spectra[i]); }

    // Opens a file once, though several textures may show it, each with its own wrap and filter.
    const Result<image::PictureInfo>& open(const PictureDescription& d) {
        const auto [at, is_new] = opened.try_emplace({d.path, d.is_srgb, d.gamma}, Error{});
        if (!is_new) return at->second;
        if (!out.pictures_) {
            Result<std::unique_ptr<image::Pictures>> created = image::Pictures::create(cache_bytes > 0 ? cache_bytes : kMinCache);
            if (!created) {
                if (errors.empty()) errors.push_back(created.error().at(d.name).message);
                return at->second = created.error();
            }
            out.pictures_ = std::move(*created);
        }
        at->second = out.pictures_->open(d.path, d.name, {d.is_srgb, static_cast<float>(d.gamma)});
        if (!at->second && std::ranges::find(errors, at->second.error().message) == errors.end())  // in another encoding
            errors.push_back(at->second.error().message);
        return at->second;
    }
    std::unique_ptr<FloatTexture> make_color(float, const TextureDescription& d, const std::optional<ImageLookup>& picture) {
        return std::make_unique<FloatColor>(ColorProduct(d, picture, {}), d.picture.channel);
    }
    std::unique_ptr<SpectrumTexture> make_color(const SampledSpectrum*, const TextureDescription& d,
                                                const std::optional<ImageLookup>& picture) {
        color::Matrix3 to_srgb;
        if (picture && picture->info().chromaticities) {
            const Result<color::Matrix3> matrix =
                color::srgb_from(*picture->info().chromaticities, picture->info().is_white_neutral);
            if (matrix) to_srgb = *matrix;
            if (!matrix) errors.push_back(matrix.error().at(d.picture.name).message);
        }
        return std::make_unique<SpectrumColor>(ColorProduct(d, picture, to_srgb), d.role, colors());
    }
    std::unique_ptr<FloatTexture> make_noise(float, const TextureDescription& d) {
        const NoiseKind kind = d.kind == TextureKind::kFbm        ? NoiseKind::kFbm
                               : d.kind == TextureKind::kWrinkled ? NoiseKind::kWrinkled
                               : d.kind == TextureKind::kVeins    ? NoiseKind::kVeins
                               : d.kind == TextureKind::kWood     ? NoiseKind::kWood
                               : d.kind == TextureKind::kClouds   ? NoiseKind::kClouds
                                                                  : NoiseKind::kWindy;
        return std::make_unique<Noise>(kind, d.mapping, static_cast<float>(d.roughness), static_cast<int>(d.octaves),
                                       static_cast<float>(d.scale), static_cast<float>(d.variation));
    }
    std::unique_ptr<SpectrumTexture> make_noise(const SampledSpectrum*, const TextureDescription& d) {
        return std::make_unique<Marble>(d.mapping, static_cast<float>(d.roughness), static_cast<int>(d.octaves),
                                        static_cast<float>(d.scale), static_cast<float>(d.variation), colors());
    }

    template <class Value>
    std::unique_ptr<Texture<Value>> make(const TextureDescription& d) {
        const auto input = [&](std::size_t i) { return input_of(Value{}, d, i); };
        switch (d.kind) {
            case TextureKind::kConstant:
            case TextureKind::kNormalMap:
                break;
            case TextureKind::kScale:
                return std::make_unique<Scale<Value>>(input(0), source(d.amount));
            case TextureKind::kMix:
                return std::make_unique<Mix<Value>>(input(0), input(1), source(d.amount));
            case TextureKind::kThreshold:
                if constexpr (std::is_same_v<Value, float>) return std::make_unique<Threshold>(input(0), source(d.amount));
                break;
            case TextureKind::kImage:
                if (const Result<image::PictureInfo>& info = open(d.picture))
                    return make_color(Value{}, d, ImageLookup(d, *out.pictures_, *info));
                break;
            case TextureKind::kVertexColor:
                return make_color(Value{}, d, std::nullopt);
            case TextureKind::kCheckerboard:
                return std::make_unique<Checkerboard<Value>>(d.mapping, d.is_solid, input(0), input(1));
            case TextureKind::kDots:
                return std::make_unique<Dots<Value>>(d.mapping, input(0), input(1));
            case TextureKind::kBilerp:
                return std::make_unique<Bilerp<Value>>(d.mapping, input(0), input(1), input(2), input(3));
            case TextureKind::kDirectionMix:
                return std::make_unique<DirectionMix<Value>>(Vec3f(d.direction), input(0), input(1));
            case TextureKind::kFbm:
            case TextureKind::kWrinkled:
            case TextureKind::kWindy:
            case TextureKind::kMarble:
            case TextureKind::kVeins:
            case TextureKind::kWood:
            case TextureKind::kClouds:
                return make_noise(Value{}, d);
        }
        return std::make_unique<Constant<Value>>(input(0));
    }
    // Parts of a file without tiles are read again and again unless all of it is kept.
    void fit_cache() {
        std::uint64_t needed = 0;
        std::size_t count = 0;
        for (const auto& [key, info] : opened) {
            needed += info->whole_bytes;
            count += info->whole_bytes > 0 ? 1 : 0;
        }
        if (count == 0) return;
        needed += needed / 8;  // rows beyond the edges of tiles
        const std::uint64_t kept =
            cache_bytes > 0 ? cache_bytes : std::clamp(needed, kMinCache, std::max(kMinCache, usable_memory() / 4));
        out.pictures_->set_cache_bytes(kept);
        if (kept < needed)
            out.shortage_ = fmt::format(
                "textures: {} without tiles may need {} when decoded, more than --texture-cache ({}), and are then read again and "
                "again; raise it, or convert them to tiled files (maketx)",
                counted(count, "picture"), format_size(needed), format_size(kept));
    }
    void build(std::uint32_t i) {
        const TextureDescription& d = scene.textures[i];
        if (d.kind == TextureKind::kNormalMap) {
            if (const Result<image::PictureInfo>& info = open(d.picture))
                out.images_[i] = std::make_unique<ImageLookup>(d, *out.pictures_, *info);
            return;
        }
        if (d.is_spectrum && !out.spectra_[i]) out.spectra_[i] = make<const SampledSpectrum*>(d);
        if (!d.is_spectrum && !out.floats_[i]) out.floats_[i] = make<float>(d);
    }
};

Result<Textures> Textures::build(const SceneDescription& scene, std::uint64_t cache_bytes, SpectrumLibrary& library) {
    Textures out;
    out.floats_.resize(scene.textures.size());
    out.spectra_.resize(scene.textures.size());
    out.images_.resize(scene.textures.size());
    Builder builder{scene, cache_bytes, library, out};
    for (std::uint32_t i = 0; i < scene.textures.size(); ++i) builder.build(i);
    if (!builder.errors.empty()) return Error{ErrorCode::kCorrupt, fmt::format("{}", fmt::join(builder.errors, "\n"))};
    builder.fit_cache();
    return out;
}

std::vector<std::string> Textures::warnings() const {
    std::vector<std::string> all;
    if (!shortage_.empty()) all.push_back(shortage_);
    if (pictures_) {
        for (std::string& met : pictures_->warnings()) all.push_back(std::move(met));
    }
    return all;
}

FloatSource Textures::source(const FloatInput& input) const {
    if (!input.is_textured()) return {input.value, nullptr};
    return {0, floats_[input.texture].get()};
}

SpectrumSource Textures::source(const SpectrumInput& input, SpectrumLibrary& library) const {
    if (!input.is_textured()) return {library.add(input.value, Lookup::kLinear), nullptr};
    return {0, spectra_[input.texture].get()};
}

}  // namespace latent::render
