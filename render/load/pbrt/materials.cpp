#include "render/load/pbrt/materials.h"

#include <fmt/format.h>

#include <cmath>

#include "color/named_spectra.h"

namespace latent::render {

namespace {

// GGX alpha of "roughness", or of one axis where that is given; pbrt's remapping is alpha = sqrt(roughness).
void read_roughness(const ParameterList& list, SceneTextures& textures, MaterialDescription& material) {
    const bool remap = list.flag("remaproughness", true);
    const double roughness = list.number("roughness", 0, 0, 1e6);
    const std::optional<std::uint32_t> texture = textures.find_texture(list, "roughness");
    const auto axis = [&](std::string_view name) {
        const double own = list.number(name, roughness, 0, 1e6);
        const bool has_own = list.find(name, {"float", "integer"}) != nullptr;
        FloatInput alpha(static_cast<float>(remap ? std::sqrt(own) : own));
        alpha.texture = textures.find_texture(list, name).value_or(has_own ? kNone : texture.value_or(kNone));
        return alpha;
    };
    material.alpha_x = axis("uroughness");
    material.alpha_y = axis("vroughness");
    material.remap_roughness = remap && (material.alpha_x.is_textured() || material.alpha_y.is_textured());
}

// A refractive index is positive wherever we look.
void check_index(const ParameterList& list, const SpectrumInput& input) {
    if (input.is_textured()) return;
    const color::Spectrum& eta = input.value;
    bool positive = eta(color::kLambdaMin) > 0 && eta(color::kLambdaMax) > 0;
    for (const double lambda : eta.lambda_nm()) {
        if (lambda >= color::kLambdaMin && lambda <= color::kLambdaMax) positive &= eta(lambda) > 0;
    }
    if (positive) return;
    list.error("eta: must be positive from 360 to 830 nm (an inline spectrum is 0 outside its samples: give values at both ends)");
}

void read_dielectric_index(const ParameterList& list, SceneTextures& textures, MaterialDescription& material) {
    material.eta = color::Spectrum::constant(list.number("eta", 1.5, 1e-3, 1e3));
    if (const auto eta = textures.find_value(list, "eta", SpectrumRole::kUnbounded)) material.eta = *eta;
    check_index(list, material.eta);
    const color::Spectrum& eta = material.eta.value;
    const double first = eta(color::kLambdaMin);
    for (double lambda = color::kLambdaMin; lambda <= color::kLambdaMax; ++lambda) material.dispersive |= eta(lambda) != first;
}

void read_conductor_index(const ParameterList& list, SceneTextures& textures, MaterialDescription& material) {
    const auto reflectance = textures.find_spectrum(list, "reflectance", SpectrumRole::kReflectance);
    const auto eta = textures.find_spectrum(list, "eta", SpectrumRole::kUnbounded),
               k = textures.find_spectrum(list, "k", SpectrumRole::kUnbounded);
    if (!reflectance) {
        material.eta = eta ? *eta : color::named_spectrum("metal-Cu-eta").value();
        material.k = k ? *k : color::named_spectrum("metal-Cu-k").value();
        check_index(list, material.eta);
        return;
    }
    if (eta || k) list.error("reflectance cannot be combined with eta and k");
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

void read_phong(const ParameterList& list, SceneTextures& textures, MaterialDescription& material) {
    const color::Spectrum quarter = color::Spectrum::constant(0.25);
    material.reflectance = textures.spectrum(list, "Kd", SpectrumRole::kReflectance, quarter);
    material.specular = textures.spectrum(list, "Ks", SpectrumRole::kReflectance, quarter);
    material.exponent = textures.number(list, "exponent", 20, 0, 1e5);
    if (material.reflectance.is_textured() || material.specular.is_textured()) return;
    bool makes_light = false;
    for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm)
        makes_light |= material.reflectance.value(nm) + material.specular.value(nm) > 1 + 1e-9;
    if (makes_light) list.warn("Kd + Ks: exceeds 1, so the surface creates energy");
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
        material.reflectance = textures.spectrum(list, "reflectance", SpectrumRole::kReflectance, color::Spectrum::constant(0.5));
        if (!material.reflectance.is_textured() && material.reflectance.value.max_value() > 1)
            list.warn("reflectance: exceeds 1, so the surface creates energy");
    } else if (type == "phong") {
        material.kind = MaterialKind::kPhong;
        read_phong(list, textures, material);
    } else if (type == "conductor") {
        material.kind = MaterialKind::kConductor;
        read_conductor_index(list, textures, material);
        read_roughness(list, textures, material);
    } else if (type == "dielectric") {
        material.kind = MaterialKind::kDielectric;
        read_dielectric_index(list, textures, material);
        read_roughness(list, textures, material);
    } else if (type == "thindielectric") {
        material.kind = MaterialKind::kThinDielectric;
        read_dielectric_index(list, textures, material);
    } else {
        list.error(fmt::format(
            "Material \"{}\" is not supported (diffuse, phong, conductor, dielectric, thindielectric, interface)", type));
        return std::nullopt;
    }
    list.report_unused();
    return material;
}

}  // namespace latent::render
