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
double fraction_of(const GltfValue& value, double fallback) { return value.factor(fallback, 0, 1); }

void read_emission(const GltfValue& material, GltfTextures& textures, GltfMaterial& out) {
    const LinearRgb rgb =
        material["emissiveFactor"].factors(LinearRgb{0, 0, 0}, 0, 1, "; KHR_materials_emissive_strength makes a surface brighter");
    const double strength = material.extension("KHR_materials_emissive_strength")["emissiveStrength"].factor(1, 0, kNoLimit);
    if (std::ranges::max(rgb) * strength == 0) return;
    out.emission = textures.emission(material["emissiveTexture"], rgb);
    if (!out.emission) return;
    out.emission->scale = strength;
    out.emission->two_sided = material["doubleSided"].flag(false);
    out.emission->name = material["name"].text();
    out.radiance = std::ranges::max(rgb) * strength;
}

// Glass: thin without a thickness, else with a medium inside.
void read_transmission(const GltfValue& material, const ModelColors& colors, double index, double roughness, GltfMaterial& out) {
    const GltfValue volume = material.extension("KHR_materials_volume");
    const bool is_thin = !(volume["thicknessFactor"].factor(0, 0, kNoLimit) > 0);
    const auto alpha = static_cast<float>(roughness * roughness);
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

void tell_of_ignored(const GltfValue& material) {
    if (const GltfValue occlusion = material["occlusionTexture"]; occlusion.exists())
        occlusion.note("is not used: occlusion is computed");
    const GltfValue specular = material.extension("KHR_materials_specular"), volume = material.extension("KHR_materials_volume"),
                    coat = material.extension("KHR_materials_clearcoat");
    for (const GltfValue& info : {specular["specularTexture"], specular["specularColorTexture"], volume["thicknessTexture"],
                                  coat["clearcoatNormalTexture"]}) {
        if (info.exists()) info.warn("is not supported, and is ignored");
    }
}

// Where its colour is not black.
void read_sheen(const GltfValue& material, GltfTextures& textures, MaterialDescription& surface) {
    const GltfValue sheen = material.extension("KHR_materials_sheen");
    const LinearRgb rgb = rgb_of(sheen["sheenColorFactor"], {0, 0, 0});
    if (std::ranges::max(rgb) == 0) return;
    if (surface.type != "metallicroughness") return sheen.warn("is ignored, since the material transmits light");
    surface.type = "sheen";
    surface.spectra["sheen.color"] = textures.color(sheen["sheenColorTexture"], rgb);
    surface.numbers["sheen.roughness"] =
        textures.number(sheen["sheenRoughnessTexture"], PictureChannel::kAlpha, fraction_of(sheen["sheenRoughnessFactor"], 0));
}

// The base colour's alpha: the share of the surface that is there, or, by a mask, whether it is.
void read_alpha(const GltfValue& material, double factor, VertexColors vertices, GltfTextures& textures, GltfMaterial& out) {
    const std::string mode = material["alphaMode"].text("OPAQUE");
    if (mode == "OPAQUE") return;
    if (mode != "MASK" && mode != "BLEND")
        return material["alphaMode"].warn(fmt::format("\"{}\" is unknown; the material is opaque", mode));
    out.alpha = textures.number(material["pbrMetallicRoughness"]["baseColorTexture"], PictureChannel::kAlpha, factor, vertices);
    if (mode == "MASK")
        out.alpha = textures.thresholded(out.alpha, static_cast<float>(material["alphaCutoff"].factor(0.5, 0, kNoLimit)));
}

}  // namespace

GltfMaterial read_material(const GltfValue& material, VertexColors vertices, const ModelColors& colors, GltfTextures& textures) {
    const GltfValue normal = material["normalTexture"];
    textures.begin_material(normal);
    GltfMaterial out;
    MaterialDescription& surface = out.surface;
    surface.name = material["name"].text();
    const GltfValue pbr = material["pbrMetallicRoughness"], rough = pbr["metallicRoughnessTexture"];
    const std::array<double, 4> base = pbr["baseColorFactor"].factors(std::array<double, 4>{1, 1, 1, 1}, 0, 1);
    const double roughness = fraction_of(pbr["roughnessFactor"], 1), metallic = fraction_of(pbr["metallicFactor"], 1);
    surface.type = "metallicroughness";
    const SpectrumInput base_color = textures.color(pbr["baseColorTexture"], {base[0], base[1], base[2]}, vertices);
    const GltfValue coat = material.extension("KHR_materials_clearcoat");
    surface.spectra = {{"base_color", base_color}};
    surface.numbers = {
        {"roughness", textures.number(rough, PictureChannel::kGreen, roughness)},
        {"metallic", textures.number(rough, PictureChannel::kBlue, metallic)},
        {"coat", textures.number(coat["clearcoatTexture"], PictureChannel::kRed, fraction_of(coat["clearcoatFactor"], 0))},
        {"coat_roughness", textures.number(coat["clearcoatRoughnessTexture"], PictureChannel::kGreen,
                                           fraction_of(coat["clearcoatRoughnessFactor"], 0))}};
    tell_of_ignored(material);

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

    double transmitted = transmission["transmissionFactor"].factor(0, 0, 1) * (1 - metallic);
    // Of most such materials, only a small part is glass.
    if (const GltfValue texture = transmission["transmissionTexture"]; texture.exists()) {
        texture.warn("is not supported; the material is opaque");
        transmitted = 0;
    }
    if (transmitted >= 0.5) {
        if (transmitted < 1) transmission.warn("is rendered as glass that transmits everything");
        read_transmission(material, colors, index > 0 ? index : 1.5, roughness, out);
        if (base_color.is_textured() || base[0] != 1 || base[1] != 1 || base[2] != 1) surface.spectra["transmittance"] = base_color;
    } else if (transmitted > 0) {
        transmission.warn("is ignored, since the material is mostly opaque");
    }
    read_sheen(material, textures, surface);
    const auto is_zero = [&](const char* name) { return !surface.number(name).is_textured() && surface.number(name).value == 0; };
    const bool is_matt = surface.type == "metallicroughness" && weight == 0 && is_zero("metallic") && is_zero("coat");
    if (is_matt || material.extension("KHR_materials_unlit").exists()) {
        surface = {.name = surface.name, .spectra = {{"reflectance", base_color}}};
    }
    if (material.extension("KHR_materials_unlit").exists()) material.warn("an unlit material is rendered as a matt one");
    if (normal.exists()) {
        surface.normal_map = textures.normal_map(normal);
        surface.normal_scale = static_cast<float>(normal["scale"].number(1, -1e6, 1e6));
        surface.normals_follow_v = true;
    }
    read_alpha(material, base[3], vertices, textures, out);
    for (const std::string& name : material["extensions"].keys()) {
        if (!is_known_extension(name)) material["extensions"][name].warn("is not supported, and is ignored");
    }
    read_emission(material, textures, out);
    out.uv_sets = textures.uv_sets();
    return out;
}

}  // namespace latent::render
