#include "render/load/gltf/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "render/load/gltf/extensions.h"

namespace latent::render {

namespace {

constexpr double kNoLimit = GltfValue::kNoLimit;

LinearRgb rgb_of(const GltfValue& value, const LinearRgb& fallback, double most = 1) { return value.factors(fallback, 0, most); }
float fraction_of(const GltfValue& value, double fallback) { return static_cast<float>(value.factor(fallback, 0, 1)); }

void read_emission(const GltfValue& material, const ModelColors& colors, GltfTextures& textures, GltfMaterial& out) {
    const LinearRgb rgb =
        material["emissiveFactor"].factors(LinearRgb{0, 0, 0}, 0, 1, "; KHR_materials_emissive_strength makes a surface brighter");
    const double strength = material.extension("KHR_materials_emissive_strength")["emissiveStrength"].factor(1, 0, kNoLimit);
    if (std::ranges::max(rgb) * strength == 0) return;
    AreaLightDescription emission{.spectrum = colors.emission(rgb),
                                  .scale = strength,
                                  .two_sided = material["doubleSided"].flag(false),
                                  .name = material["name"].text()};
    if (const GltfValue info = material["emissiveTexture"]; info.exists()) {
        const std::uint32_t picture = textures.emission(info);
        if (picture == kNone) return;
        const Result<double> mean = textures.mean_luminance(picture);
        if (!mean) return info.error(mean.error().message);
        if (*mean == 0) return;
        emission.picture = picture;
        emission.mean_luminance = *mean;
    }
    out.emission = std::move(emission);
    out.radiance = std::ranges::max(rgb) * strength;
}

// Glass: thin without a thickness, else with a medium inside.
void read_transmission(const GltfValue& material, const ModelColors& colors, double index, GltfMaterial& out) {
    const GltfValue volume = material.extension("KHR_materials_volume");
    const bool is_thin = !(volume["thicknessFactor"].factor(0, 0, kNoLimit) > 0);
    const float roughness = out.surface.number("roughness").value, alpha = roughness * roughness;
    out.surface = {.type = is_thin ? "thindielectric" : "dielectric",
                   .name = out.surface.name,
                   .spectra = {{"eta", color::Spectrum::constant(index)}}};
    if (is_thin && alpha > 0) material.warn("thin glass is rendered without its roughness");
    if (is_thin) return;
    out.surface.numbers = {{"alpha_x", alpha}, {"alpha_y", alpha}};
    const double distance = volume["attenuationDistance"].factor(0, 0, kNoLimit);
    const LinearRgb tint = rgb_of(volume["attenuationColor"], {1, 1, 1});
    if (distance == 0 || std::ranges::min(tint) >= 1) return;
    // What is left after `distance` is the attenuation colour: sigma = -ln(c) / distance.
    const color::Spectrum left = colors.reflectance(tint);
    const auto sigma = [&](double nm) { return -std::log(std::max(left(nm), 1e-6)) / distance; };
    out.inside = MediumDescription{.sigma_a = color::Spectrum::from_function(sigma, color::Outside::kClamped),
                                   .sigma_s = color::Spectrum::constant(0)};
}

// Where a texture gives a value, the factor scales the texture.
void read_textures(const GltfValue& material, const std::array<double, 4>& base, GltfTextures& textures, GltfMaterial& out) {
    const GltfValue pbr = material["pbrMetallicRoughness"], color = pbr["baseColorTexture"],
                    rough = pbr["metallicRoughnessTexture"], coat = material.extension("KHR_materials_clearcoat");
    const double brightest = std::max({base[0], base[1], base[2]});
    if (color.exists() && (base[0] != brightest || base[1] != brightest || base[2] != brightest))
        pbr["baseColorFactor"].warn("only its brightest component scales the texture");
    out.surface.spectra.at("base_color").texture = textures.color(color, brightest);
    auto& numbers = out.surface.numbers;
    const auto read = [&](const char* name, const GltfValue& info, PictureChannel channel) {
        FloatInput& input = numbers.at(name);
        input.texture = textures.number(info, channel, static_cast<double>(input.value));
    };
    read("roughness", rough, PictureChannel::kGreen);
    read("metallic", rough, PictureChannel::kBlue);
    read("coat", coat["clearcoatTexture"], PictureChannel::kRed);
    read("coat_roughness", coat["clearcoatRoughnessTexture"], PictureChannel::kGreen);
    if (material["occlusionTexture"].exists()) material["occlusionTexture"].warn("is ignored, since occlusion is computed");
    const GltfValue specular = material.extension("KHR_materials_specular"), volume = material.extension("KHR_materials_volume");
    for (const GltfValue& info : {specular["specularTexture"], specular["specularColorTexture"], volume["thicknessTexture"],
                                  coat["clearcoatNormalTexture"]}) {
        if (info.exists()) info.warn("is not supported, and is ignored");
    }
}

// The first texture's, for all of them.
std::optional<std::uint32_t> read_uv_set(const GltfTextures& textures) {
    if (textures.used().empty()) return std::nullopt;
    const std::uint32_t set = uv_set_of(textures.used().front());
    for (const GltfValue& info : textures.used()) {
        if (uv_set_of(info) != set) info.warn("its texture coordinates are replaced by those of the first texture");
    }
    return set;
}

// Where its colour is not black.
void read_sheen(const GltfValue& material, const ModelColors& colors, GltfTextures& textures, MaterialDescription& surface) {
    const GltfValue sheen = material.extension("KHR_materials_sheen");
    const LinearRgb rgb = rgb_of(sheen["sheenColorFactor"], {0, 0, 0});
    const double brightest = std::ranges::max(rgb);
    if (brightest == 0) return;
    if (surface.type != "metallicroughness") return sheen.warn("is ignored, since the material transmits light");
    surface.type = "sheen";
    SpectrumInput& color = surface.spectra["sheen.color"] = colors.reflectance(rgb);
    FloatInput& roughness = surface.numbers["sheen.roughness"] = fraction_of(sheen["sheenRoughnessFactor"], 0);
    color.texture = textures.color(sheen["sheenColorTexture"], brightest);
    if (color.is_textured() && std::ranges::min(rgb) != brightest)
        sheen["sheenColorFactor"].warn("only its brightest component scales the texture");
    roughness.texture =
        textures.number(sheen["sheenRoughnessTexture"], PictureChannel::kAlpha, static_cast<double>(roughness.value));
}

// The base colour's alpha: the share of the surface that is there, or, by a mask, whether it is.
void read_alpha(const GltfValue& material, double factor, GltfTextures& textures, GltfMaterial& out) {
    const std::string mode = material["alphaMode"].text("OPAQUE");
    if (mode == "OPAQUE") return;
    if (mode != "MASK" && mode != "BLEND")
        return material["alphaMode"].warn(fmt::format("\"{}\" is unknown; the material is opaque", mode));
    out.alpha = static_cast<float>(factor);
    out.alpha.texture = textures.number(material["pbrMetallicRoughness"]["baseColorTexture"], PictureChannel::kAlpha, factor);
    if (mode == "MASK")
        out.alpha = textures.thresholded(out.alpha, static_cast<float>(material["alphaCutoff"].factor(0.5, 0, kNoLimit)));
}

}  // namespace

GltfMaterial read_material(const GltfValue& material, const ModelColors& colors, GltfTextures& textures) {
    textures.begin_material();
    GltfMaterial out;
    MaterialDescription& surface = out.surface;
    surface.name = material["name"].text();
    const GltfValue pbr = material["pbrMetallicRoughness"];
    const std::array<double, 4> base = pbr["baseColorFactor"].factors(std::array<double, 4>{1, 1, 1, 1}, 0, 1);
    surface.type = "metallicroughness";
    surface.spectra = {{"base_color", colors.reflectance({base[0], base[1], base[2]})}};
    const GltfValue coat = material.extension("KHR_materials_clearcoat");
    surface.numbers = {{"roughness", fraction_of(pbr["roughnessFactor"], 1)},
                       {"metallic", fraction_of(pbr["metallicFactor"], 1)},
                       {"coat", fraction_of(coat["clearcoatFactor"], 0)},
                       {"coat_roughness", fraction_of(coat["clearcoatRoughnessFactor"], 0)}};

    read_textures(material, base, textures, out);

    const GltfValue specular = material.extension("KHR_materials_specular"),
                    transmission = material.extension("KHR_materials_transmission");
    // F0 of the index, 1.5 by default; an index of 0 stands for a perfect reflector.
    const GltfValue ior = material.extension("KHR_materials_ior")["ior"];
    const double index = ior.number(1.5) == 0 ? 0 : ior.factor(1.5, 1, kNoLimit);
    const double root = (index - 1) / (index + 1), weight = specular["specularFactor"].factor(1, 0, 1);
    const LinearRgb tint = rgb_of(specular["specularColorFactor"], {1, 1, 1}, kNoLimit);
    const double bright = std::ranges::max(tint);
    if (std::ranges::min(tint) != bright) specular["specularColorFactor"].warn("only its brightest component is used");
    surface.numbers["f0"] = static_cast<float>(std::min(root * root * bright, 1.0) * weight);
    surface.numbers["f90"] = static_cast<float>(weight);

    const SpectrumInput base_color = surface.spectra["base_color"];
    double transmitted =
        transmission["transmissionFactor"].factor(0, 0, 1) * (1 - static_cast<double>(surface.number("metallic").value));
    // Of most such materials, only a small part is glass.
    if (const GltfValue texture = transmission["transmissionTexture"]; texture.exists()) {
        texture.warn("is not supported; the material is opaque");
        transmitted = 0;
    }
    if (transmitted >= 0.5) {
        if (transmitted < 1) transmission.warn("is rendered as glass that transmits everything");
        read_transmission(material, colors, index > 0 ? index : 1.5, out);
        if (base_color.is_textured() || base[0] != 1 || base[1] != 1 || base[2] != 1) surface.spectra["transmittance"] = base_color;
    } else if (transmitted > 0) {
        transmission.warn("is ignored, since the material is mostly opaque");
    }
    read_sheen(material, colors, textures, surface);
    const bool is_matt = surface.type == "metallicroughness" && weight == 0 && surface.number("metallic").value == 0 &&
                         surface.number("coat").value == 0;
    if (is_matt || material.extension("KHR_materials_unlit").exists()) {
        surface = {.name = surface.name, .spectra = {{"reflectance", base_color}}};
    }
    if (material.extension("KHR_materials_unlit").exists()) material.warn("an unlit material is rendered as a matt one");
    if (const GltfValue normal = material["normalTexture"]; normal.exists()) {
        surface.normal_map = textures.normal_map(normal);
        if (normal["scale"].number(1) != 1) normal["scale"].warn("is ignored");
    }
    read_alpha(material, base[3], textures, out);
    for (const std::string& name : material["extensions"].keys()) {
        if (!is_known_extension(name)) material["extensions"][name].warn("is not supported, and is ignored");
    }
    read_emission(material, colors, textures, out);
    out.uv_set = read_uv_set(textures);
    return out;
}

}  // namespace latent::render
