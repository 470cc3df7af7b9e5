#include "render/load/gltf/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
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

// n = B + C / lambda^2 with n_d = `index` and n_F - n_C = (n_d - 1) / V, V = 20 / dispersion the Abbe number
// [glTF2 KHR_materials_dispersion].
color::Spectrum index_of(double index, double dispersion) {
    if (dispersion == 0 || index <= 1) return color::Spectrum::constant(index);
    constexpr double kF = 486.1327, kD = 587.5618, kC = 656.2725;  // [nm]
    const double c = (index - 1) * dispersion / 20 / (1 / (kF * kF) - 1 / (kC * kC)), b = index - c / (kD * kD);
    return color::Spectrum::from_function([=](double nm) { return std::max(b + c / (nm * nm), 1.0); }, color::Outside::kClamped);
}

// Glass: thin without a thickness, else with a medium inside. `alpha`: of its facets.
MaterialDescription read_glass(const GltfValue& material, const ModelColors& colors, double index, const FloatInput& alpha,
                               GltfMaterial& out) {
    const GltfValue volume = material.extension("KHR_materials_volume");
    const bool is_thin = !(volume["thicknessFactor"].factor(0, 0, kNoLimit) > 0);
    const double dispersion = material.extension("KHR_materials_dispersion")["dispersion"].factor(0, 0, 1e3);
    MaterialDescription glass{.type = is_thin ? "thindielectric" : "dielectric",
                              .spectra = {{"eta", is_thin ? color::Spectrum::constant(index) : index_of(index, dispersion)}}};
    glass.numbers = {{"alpha_x", alpha}, {"alpha_y", alpha}};
    if (is_thin) return glass;
    const double distance = volume["attenuationDistance"].factor(0, 0, kNoLimit);
    const LinearRgb tint = rgb_of(volume["attenuationColor"], {1, 1, 1});
    if (distance == 0 || std::ranges::min(tint) >= 1) return glass;
    // What is left after `distance` is the attenuation colour: sigma = -ln(c) / distance.
    const color::Spectrum left = colors.reflectance(tint);
    const auto sigma = [&](double nm) { return -std::log(std::max(left(nm), 1e-6)) / distance; };
    out.inside = MediumDescription{.sigma_a = color::Spectrum::from_function(sigma, color::Outside::kClamped),
                                   .sigma_s = color::Spectrum::constant(0)};
    return glass;
}

// Where its colour is not black.
void read_sheen(const GltfValue& material, GltfTextures& textures, MaterialDescription& surface) {
    const GltfValue sheen = material.extension("KHR_materials_sheen");
    const LinearRgb rgb = rgb_of(sheen["sheenColorFactor"], {0, 0, 0});
    if (std::ranges::max(rgb) == 0) return;
    surface.type = "sheen";
    surface.spectra["sheen.color"] = textures.color(sheen["sheenColorTexture"], rgb);
    surface.numbers["sheen.roughness"] =
        textures.number(sheen["sheenRoughnessTexture"], PictureChannel::kAlpha, fraction_of(sheen["sheenRoughnessFactor"], 0));
}

// A film on it, where there is one.
std::map<std::string, FloatInput, std::less<>> read_film(const GltfValue& material, GltfTextures& textures) {
    const GltfValue film = material.extension("KHR_materials_iridescence");
    const double share = fraction_of(film["iridescenceFactor"], 0);
    if (share == 0) return {};
    const FloatInput thick = textures.number(film["iridescenceThicknessTexture"], PictureChannel::kGreen, 1);
    return {{"film", textures.number(film["iridescenceTexture"], PictureChannel::kRed, share)},
            {"film_eta", static_cast<float>(film["iridescenceIor"].factor(1.3, 1, 10))},
            {"film_thickness", textures.between(film["iridescenceThicknessMinimum"].factor(100, 0, 1e6),
                                                film["iridescenceThicknessMaximum"].factor(400, 0, 1e6), thick)}};
}

// Facets that are rougher in one direction.
void read_anisotropy(const GltfValue& material, GltfTextures& textures, MaterialDescription& surface) {
    const GltfValue anisotropy = material.extension("KHR_materials_anisotropy"), picture = anisotropy["anisotropyTexture"];
    const double strength = fraction_of(anisotropy["anisotropyStrength"], 0);
    if (strength == 0) return;
    surface.numbers["anisotropy"] = textures.number(picture, PictureChannel::kBlue, strength);
    if (picture.exists()) {
        surface.numbers["anisotropy_x"] = textures.number(picture, PictureChannel::kRed, 1);
        surface.numbers["anisotropy_y"] = textures.number(picture, PictureChannel::kGreen, 1);
    }
    const double turns = anisotropy["anisotropyRotation"].number(0, -1e6, 1e6) / (2 * std::numbers::pi);
    if (turns != 0) surface.numbers["anisotropy_turns"] = static_cast<float>(turns - std::floor(turns));
}

// The base colour's alpha: the share of the surface that is there, or, by a mask, whether it is.
void read_alpha(const GltfValue& material, const GltfValue& picture, double factor, VertexColors vertices, GltfTextures& textures,
                GltfMaterial& out) {
    const std::string mode = material["alphaMode"].text("OPAQUE");
    if (mode == "OPAQUE") return;
    if (mode != "MASK" && mode != "BLEND")
        return material["alphaMode"].warn(fmt::format("\"{}\" is unknown; the material is opaque", mode));
    out.alpha = textures.number(picture, PictureChannel::kAlpha, factor, vertices);
    if (mode == "MASK")
        out.alpha = textures.thresholded(out.alpha, static_cast<float>(material["alphaCutoff"].factor(0.5, 0, kNoLimit)));
}

// The colour of what a dielectric reflects, unless it is grey: `rgb` over its brightest component, times the picture. Returns that
// component.
double read_specular_color(const GltfValue& picture, const LinearRgb& rgb, GltfTextures& textures, MaterialDescription& surface) {
    const double bright = std::ranges::max(rgb);
    if (bright > 0 && (picture.exists() || std::ranges::min(rgb) != bright))
        surface.spectra["specular_color"] = textures.color(picture, {rgb[0] / bright, rgb[1] / bright, rgb[2] / bright});
    return bright;
}

// What of a material its two models say each in its own way.
struct Body {
    GltfValue picture;  // its colour and alpha
    std::array<double, 4> factor;
    double roughness, metallic;
};

Body read_metallic_roughness(const GltfValue& material, VertexColors vertices, GltfTextures& textures,
                             MaterialDescription& surface) {
    const GltfValue pbr = material["pbrMetallicRoughness"], rough = pbr["metallicRoughnessTexture"];
    const Body body{pbr["baseColorTexture"], pbr["baseColorFactor"].factors(std::array<double, 4>{1, 1, 1, 1}, 0, 1),
                    fraction_of(pbr["roughnessFactor"], 1), fraction_of(pbr["metallicFactor"], 1)};
    surface.spectra["base_color"] = textures.color(body.picture, {body.factor[0], body.factor[1], body.factor[2]}, vertices);
    surface.numbers["roughness"] = textures.number(rough, PictureChannel::kGreen, body.roughness);
    surface.numbers["metallic"] = textures.number(rough, PictureChannel::kBlue, body.metallic);
    const GltfValue specular = material.extension("KHR_materials_specular"), weight_picture = specular["specularTexture"];
    const GltfValue color_picture = specular["specularColorTexture"];
    // F0 of the index, 1.5 by default; an index of 0 stands for a perfect reflector. No colour makes it more than 1.
    const GltfValue ior = material.extension("KHR_materials_ior")["ior"];
    const double index = ior.number(1.5) == 0 ? 0 : ior.factor(1.5, 1, kNoLimit), root = (index - 1) / (index + 1);
    LinearRgb rgb = rgb_of(specular["specularColorFactor"], {1, 1, 1}, kNoLimit);
    for (double& x : rgb) x = root == 0 || color_picture.exists() ? x : std::min(x, 1 / (root * root));
    const double weight = specular["specularFactor"].factor(1, 0, 1),
                 bright = read_specular_color(color_picture, rgb, textures, surface);
    surface.numbers["f0"] = textures.number(weight_picture, PictureChannel::kAlpha, std::min(root * root * bright, 1.0) * weight);
    surface.numbers["f90"] = textures.number(weight_picture, PictureChannel::kAlpha, weight);
    return body;
}

// Colours of the diffuse body and of the mirror above it. Without a body it is a metal.
Body read_specular_glossiness(const GltfValue& glossy, VertexColors vertices, GltfTextures& textures,
                              MaterialDescription& surface) {
    const LinearRgb specular = rgb_of(glossy["specularFactor"], {1, 1, 1});
    const GltfValue picture = glossy["specularGlossinessTexture"];
    const double glossiness = fraction_of(glossy["glossinessFactor"], 1);
    Body body{glossy["diffuseTexture"], glossy["diffuseFactor"].factors(std::array<double, 4>{1, 1, 1, 1}, 0, 1), 1 - glossiness,
              0};
    // What the mirror leaves of light for the body, relative to a mirror of index 1.5.
    const double left = picture.exists() ? 1 : std::min((1 - std::ranges::max(specular)) / (1 - 0.04), 1.0);
    const LinearRgb diffuse{left * body.factor[0], left * body.factor[1], left * body.factor[2]};
    body.metallic = std::ranges::max(diffuse) == 0 ? 1 : 0;
    surface.numbers["roughness"] = textures.inverted(picture, PictureChannel::kAlpha, glossiness);
    surface.numbers["metallic"] = static_cast<float>(body.metallic);
    if (body.metallic == 1) {
        surface.spectra["base_color"] = textures.color(picture, specular);
    } else {
        SpectrumInput& color = surface.spectra["base_color"] = textures.color(body.picture, diffuse, vertices);
        if (picture.exists())
            color = textures.product(color, textures.between(1 / (1 - 0.04), 0, textures.largest(picture, specular)));
        surface.numbers["f0"] = static_cast<float>(read_specular_color(picture, specular, textures, surface));
    }
    return body;
}

// Adds the second material, which part of the surface is instead.
void read_second(const GltfValue& material, const Body& body, const ModelColors& colors, GltfTextures& textures,
                 GltfMaterial& out) {
    const GltfValue clear = material.extension("KHR_materials_transmission"),
                    diffuse = material.extension("KHR_materials_diffuse_transmission");
    FloatInput& metallic = out.surface.numbers.at("metallic");
    const double not_metal = metallic.is_textured() ? 1 : 1 - body.metallic,
                 transmitted = clear["transmissionFactor"].factor(0, 0, 1) * not_metal,
                 diffused = diffuse["diffuseTransmissionFactor"].factor(0, 0, 1) * not_metal;
    if (transmitted > 0) {
        if (diffused > 0) diffuse.warn("is ignored, since the material transmits light clearly, too");
        const double index = material.extension("KHR_materials_ior")["ior"].factor(1.5, 1, kNoLimit);
        const FloatInput& rough = out.surface.numbers.at("roughness");
        out.second = read_glass(
            material, colors, index,
            rough.is_textured() ? textures.product(rough, rough) : FloatInput(static_cast<float>(body.roughness * body.roughness)),
            out);
        const SpectrumInput& base = out.surface.spectra.at("base_color");
        const bool is_white = !base.is_textured() && body.factor[0] == 1 && body.factor[1] == 1 && body.factor[2] == 1;
        if (!is_white) out.second->spectra["transmittance"] = base;
        out.second_share = textures.number(clear["transmissionTexture"], PictureChannel::kRed, transmitted);
    } else if (diffused > 0) {
        const LinearRgb tint = rgb_of(diffuse["diffuseTransmissionColorFactor"], {1, 1, 1});
        out.second =
            MaterialDescription{.type = "diffusetransmission",
                                .spectra = {{"transmittance", textures.color(diffuse["diffuseTransmissionColorTexture"], tint)}}};
        out.second_share = textures.number(diffuse["diffuseTransmissionTexture"], PictureChannel::kAlpha, diffused);
    }
    if (metallic.is_textured() && out.second) {
        // Where light does not pass, all is metal, or, if light passes only part of what is none, as much as the picture says.
        const FloatInput whole = out.second_share;
        out.second_share = textures.product(whole, textures.between(1, 0, metallic));
        if (!whole.is_textured() && whole.value == 1) metallic = 1;
    } else if (metallic.value > 0 && !out.second_share.is_textured()) {
        metallic.value /= 1 - out.second_share.value;  // as a share of the light that does not pass
    }
}

}  // namespace

GltfMaterial read_material(const GltfValue& material, VertexColors vertices, const ModelColors& colors, GltfTextures& textures) {
    const GltfValue normal = material["normalTexture"], coat = material.extension("KHR_materials_clearcoat"),
                    glossy = material.extension("KHR_materials_pbrSpecularGlossiness");
    const GltfValue coat_normal = coat["clearcoatNormalTexture"];
    textures.begin_material(normal.exists()        ? normal
                            : coat_normal.exists() ? coat_normal
                                                   : material.extension("KHR_materials_anisotropy")["anisotropyTexture"]);
    GltfMaterial out;
    MaterialDescription& surface = out.surface;
    surface.name = material["name"].text();
    surface.type = "metallicroughness";
    const Body body = glossy.exists() ? read_specular_glossiness(glossy, vertices, textures, surface)
                                      : read_metallic_roughness(material, vertices, textures, surface);
    surface.numbers["coat"] =
        textures.number(coat["clearcoatTexture"], PictureChannel::kRed, fraction_of(coat["clearcoatFactor"], 0));
    surface.numbers["coat_roughness"] = textures.number(coat["clearcoatRoughnessTexture"], PictureChannel::kGreen,
                                                        fraction_of(coat["clearcoatRoughnessFactor"], 0));
    const SpectrumInput base_color = surface.spectra.at("base_color");
    if (material.extension("KHR_materials_unlit").exists()) {
        material.warn_of_kind("unlit", "an unlit material is rendered as a matt one");
        surface = {.name = surface.name, .spectra = {{"reflectance", base_color}}};
    } else {
        read_second(material, body, colors, textures, out);
        read_anisotropy(material, textures, surface);
        const auto film = read_film(material, textures);
        surface.numbers.insert(film.begin(), film.end());
        if (out.second && out.second->type != "diffusetransmission") {
            out.second->numbers.insert(film.begin(), film.end());
            for (const auto& [name, value] : surface.numbers) {
                if (name.starts_with("anisotropy")) out.second->numbers.emplace(name, value);
            }
        }
        read_sheen(material, textures, surface);
        const auto is_zero = [&](const char* name) {
            return !surface.number(name).is_textured() && surface.number(name, 1).value == 0;
        };
        if (surface.type == "metallicroughness" && is_zero("f90") && is_zero("metallic") && is_zero("coat") && film.empty())
            surface = {.name = surface.name, .spectra = {{"reflectance", base_color}}};
    }
    if (normal.exists()) {
        surface.normal_map = textures.normal_map(normal);
        surface.normal_scale = static_cast<float>(normal["scale"].number(1, -1e6, 1e6));
    }
    if (coat_normal.exists() && surface.numbers.contains("coat")) {
        surface.coat_normal_map = textures.normal_map(coat_normal);
        surface.coat_normal_scale = static_cast<float>(coat_normal["scale"].number(1, -1e6, 1e6));
    }
    surface.normals_follow_v = surface.normal_map != kNone || surface.coat_normal_map != kNone;
    if (out.second) {
        out.second->normal_map = surface.normal_map;
        out.second->normal_scale = surface.normal_scale;
        out.second->normals_follow_v = surface.normals_follow_v;
        out.second->name = surface.name;
        if (!out.second_share.is_textured() && out.second_share.value == 1) {
            surface = std::move(*out.second);
            out.second.reset();
        }
    }
    read_alpha(material, body.picture, body.factor[3], vertices, textures, out);
    for (const std::string& name : material["extensions"].keys()) {
        if (!is_known_extension(name)) material["extensions"][name].warn(unsupported_extension(name));
    }
    read_emission(material, textures, out);
    out.needs = {.uv_sets = textures.uv_sets(),
                 .tangents = normal.exists() || coat_normal.exists() || surface.numbers.contains("anisotropy")};
    return out;
}

}  // namespace latent::render
