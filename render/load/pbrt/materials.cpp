#include "render/load/pbrt/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/named_spectra.h"
#include "render/load/pbrt/features.h"

namespace latent::render {

namespace {

// GGX alpha of "roughness", or of one axis where that is given; pbrt's remapping is alpha = sqrt(roughness). The names follow
// `prefix`, but for "remaproughness".
void read_roughness(const ParameterList& list, const std::string& prefix, SceneTextures& textures, FloatInput& alpha_x,
                    FloatInput& alpha_y, bool& remap_roughness) {
    const bool remap = list.flag("remaproughness", true);
    const double roughness = list.number(prefix + "roughness", 0, 0, 1e6);
    const std::optional<std::uint32_t> texture = textures.find_texture(list, prefix + "roughness");
    const auto axis = [&](const std::string& name) {
        const double own = list.number(name, roughness, 0, 1e6);
        const bool has_own = list.find(name, {"float", "integer"}) != nullptr;
        FloatInput alpha(static_cast<float>(remap ? std::sqrt(own) : own));
        alpha.texture = textures.find_texture(list, name).value_or(has_own ? kNone : texture.value_or(kNone));
        return alpha;
    };
    alpha_x = axis(prefix + "uroughness");
    alpha_y = axis(prefix + "vroughness");
    remap_roughness = remap && (alpha_x.is_textured() || alpha_y.is_textured());
}
void read_roughness(const ParameterList& list, const std::string& prefix, SceneTextures& textures, MaterialDescription& material) {
    read_roughness(list, prefix, textures, material.alpha_x, material.alpha_y, material.remap_roughness);
}

// A refractive index is positive wherever we look.
void check_index(const ParameterList& list, const std::string& name, const SpectrumInput& input) {
    if (input.is_textured()) return;
    const color::Spectrum& eta = input.value;
    bool positive = eta(color::kLambdaMin) > 0 && eta(color::kLambdaMax) > 0;
    for (const double lambda : eta.lambda_nm()) {
        if (lambda >= color::kLambdaMin && lambda <= color::kLambdaMax) positive &= eta(lambda) > 0;
    }
    if (positive) return;
    list.error(name +
               ": must be positive from 360 to 830 nm (an inline spectrum is 0 outside its samples: give values at both ends)");
}

color::Spectrum read_dielectric_index(const ParameterList& list, const std::string& name, SceneTextures& textures,
                                      bool& dispersive) {
    color::Spectrum eta = color::Spectrum::constant(list.number(name, 1.5, 1e-3, 1e3));
    if (const auto found = textures.find_value(list, name, SpectrumRole::kUnbounded)) eta = *found;
    check_index(list, name, eta);
    const double first = eta(color::kLambdaMin);
    for (double lambda = color::kLambdaMin; lambda <= color::kLambdaMax; ++lambda) dispersive |= eta(lambda) != first;
    return eta;
}

void read_conductor_index(const ParameterList& list, const std::string& prefix, SceneTextures& textures,
                          MaterialDescription& material) {
    const auto reflectance = textures.find_spectrum(list, "reflectance", SpectrumRole::kReflectance);
    const auto eta = textures.find_spectrum(list, prefix + "eta", SpectrumRole::kUnbounded),
               k = textures.find_spectrum(list, prefix + "k", SpectrumRole::kUnbounded);
    if (!reflectance) {
        material.eta = eta ? *eta : color::named_spectrum("metal-Cu-eta").value();
        material.k = k ? *k : color::named_spectrum("metal-Cu-k").value();
        check_index(list, prefix + "eta", material.eta);
        return;
    }
    if (eta || k) list.error(fmt::format("reflectance cannot be combined with {0}eta and {0}k", prefix));
    if (reflectance->is_textured()) {
        material.reflectance = *reflectance;
        return;
    }
    // At normal incidence R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2); eta = 1 leaves k = 2 sqrt(R / (1 - R)).
    material.eta = color::Spectrum::constant(1);
    const auto k_of = [&](double lambda) {
        const double r = std::min(reflectance->value(lambda), 0.9999);
        return 2 * std::sqrt(r) / std::sqrt(1 - r);
    };
    material.k = color::Spectrum::from_function(k_of, color::Outside::kClamped);
}

SpectrumInput read_reflectance(const ParameterList& list, const std::string& name, SceneTextures& textures, double otherwise) {
    SpectrumInput input = textures.spectrum(list, name, SpectrumRole::kReflectance, color::Spectrum::constant(otherwise));
    if (!input.is_textured() && input.value.max_value() > 1) list.warn(name + ": exceeds 1, so the surface creates energy");
    return input;
}

// The names of what belongs to its surface follow `prefix`.
void read_layer(const ParameterList& list, const std::string& prefix, SceneTextures& textures, LayerDescription& layer) {
    layer.eta = read_dielectric_index(list, prefix + "eta", textures, layer.dispersive);
    read_roughness(list, prefix, textures, layer.alpha_x, layer.alpha_y, layer.remap_roughness);
    layer.thickness = textures.number(list, "thickness", 0.01, 0, 1e6);
    layer.albedo = read_reflectance(list, "albedo", textures, 0);
    layer.g = textures.number(list, "g", 0, -1, 1);
    layer.g.value = std::clamp(layer.g.value, -0.9999f, 0.9999f);
    layer.max_depth = static_cast<std::uint32_t>(list.integer("maxdepth", 10, 0, 1 << 30));
    layer.walks = static_cast<std::uint32_t>(list.integer("nsamples", 1, 1, 100'000));
}

// Whether `scale` times two constants exceed 1 together at some wavelength.
bool makes_light(const SpectrumInput& a, const SpectrumInput& b, double scale) {
    if (a.is_textured() || b.is_textured()) return false;
    bool exceeds = false;
    for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm) exceeds |= scale * (a.value(nm) + b.value(nm)) > 1 + 1e-9;
    return exceeds;
}

void read_phong(const ParameterList& list, SceneTextures& textures, MaterialDescription& material) {
    const color::Spectrum quarter = color::Spectrum::constant(0.25);
    material.reflectance = textures.spectrum(list, "Kd", SpectrumRole::kReflectance, quarter);
    material.specular = textures.spectrum(list, "Ks", SpectrumRole::kReflectance, quarter);
    material.exponent = textures.number(list, "exponent", 20, 0, 1e5);
    const std::string lobe = list.string("latent:lobe").value_or("mirror");
    if (lobe != "mirror" && lobe != "retro") list.error(fmt::format("latent:lobe: \"{}\" is neither mirror nor retro", lobe));
    material.retro = lobe == "retro";
    if (makes_light(material.reflectance, material.specular, 1)) list.warn("Kd + Ks: exceeds 1, so the surface creates energy");
}

// Absorption by "sigma_a", by the colour of much hair, or by what colours hair: two kinds of melanin.
void read_hair(const ParameterList& list, SceneTextures& textures, HairDescription& hair) {
    hair.eta = textures.number(list, "eta", 1.55, 1.0001, 10);
    hair.beta_m = textures.number(list, "beta_m", 0.3, 0, 1);
    hair.beta_n = textures.number(list, "beta_n", 0.3, 0, 1);
    hair.alpha_degrees = textures.number(list, "alpha", 2, -45, 45);
    const auto sigma_a = textures.find_spectrum(list, "sigma_a", SpectrumRole::kUnbounded);
    const auto color = textures.find_spectrum(list, "reflectance", SpectrumRole::kReflectance);
    const bool has_melanin = list.find("eumelanin", {"float"}) != nullptr || list.find("pheomelanin", {"float"}) != nullptr;
    const double eumelanin = list.number("eumelanin", has_melanin ? 0 : 1.3, 0, 1e6),
                 pheomelanin = list.number("pheomelanin", 0, 0, 1e6);
    if (textures.find_texture(list, "eumelanin") || textures.find_texture(list, "pheomelanin"))
        list.error("eumelanin, pheomelanin: textures are not supported; give sigma_a or reflectance as a texture");
    if ((sigma_a ? 1 : 0) + (color ? 1 : 0) + (has_melanin ? 1 : 0) > 1)
        list.warn("sigma_a, reflectance, melanin: only the first of these that is given counts");
    if (sigma_a) {
        hair.sigma_a = *sigma_a;
    } else if (color) {
        hair.has_color = true;
        hair.color = *color;
    } else {
        hair.sigma_a = textures.unbounded({0.419 * eumelanin + 0.187 * pheomelanin, 0.697 * eumelanin + 0.4 * pheomelanin,
                                           1.37 * eumelanin + 1.05 * pheomelanin});
    }
}

}  // namespace

std::optional<MaterialDescription> read_material(const std::string& type, const ParameterList& list, SceneTextures& textures) {
    MaterialDescription material{.location = list.directive().where};
    if (type == "interface") {
        list.report_unused();
        return std::nullopt;
    }
    if (type == "diffuse") {
        material.kind = MaterialKind::kDiffuse;
        material.reflectance = read_reflectance(list, "reflectance", textures, 0.5);
    } else if (type == "phong") {
        material.kind = MaterialKind::kPhong;
        read_phong(list, textures, material);
    } else if (type == "conductor") {
        material.kind = MaterialKind::kConductor;
        read_conductor_index(list, "", textures, material);
        read_roughness(list, "", textures, material);
    } else if (type == "dielectric") {
        material.kind = MaterialKind::kDielectric;
        material.eta = read_dielectric_index(list, "eta", textures, material.dispersive);
        read_roughness(list, "", textures, material);
    } else if (type == "subsurface") {  // what is below: read_subsurface
        material.kind = MaterialKind::kDielectric;
        material.eta = color::Spectrum::constant(list.number("eta", 1.33, 1e-3, 1e3));
        read_roughness(list, "", textures, material);
    } else if (type == "thindielectric") {
        material.kind = MaterialKind::kThinDielectric;
        material.eta = read_dielectric_index(list, "eta", textures, material.dispersive);
    } else if (type == "diffusetransmission") {
        material.kind = MaterialKind::kDiffuseTransmission;
        const color::Spectrum quarter = color::Spectrum::constant(0.25);
        material.reflectance = textures.spectrum(list, "reflectance", SpectrumRole::kReflectance, quarter);
        material.specular = textures.spectrum(list, "transmittance", SpectrumRole::kReflectance, quarter);
        material.scale = static_cast<float>(list.number("scale", 1, 0, 1e6));
        if (makes_light(material.reflectance, material.specular, static_cast<double>(material.scale)))
            list.warn("reflectance + transmittance: exceeds 1, so the surface creates energy");
    } else if (type == "coateddiffuse") {
        material.kind = MaterialKind::kCoatedDiffuse;
        material.reflectance = read_reflectance(list, "reflectance", textures, 0.5);
        read_layer(list, "", textures, material.layer);
    } else if (type == "coatedconductor") {
        material.kind = MaterialKind::kCoatedConductor;
        read_conductor_index(list, "conductor.", textures, material);
        read_roughness(list, "conductor.", textures, material);
        read_layer(list, "interface.", textures, material.layer);
    } else if (type == "hair") {
        material.kind = MaterialKind::kHair;
        read_hair(list, textures, material.hair);
    } else {
        list.error(unsupported("Material", type));
        return std::nullopt;
    }
    material.displacement.texture = textures.find_texture(list, "displacement").value_or(kNone);
    material.normal_map = textures.normal_map(list);
    if (material.displacement.is_textured() && material.normal_map != kNone) {
        list.warn("normalmap: ignored, since there is a displacement");
        material.normal_map = kNone;
    }
    list.report_unused();
    return material;
}

}  // namespace latent::render
