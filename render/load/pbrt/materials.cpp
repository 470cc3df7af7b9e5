#include "render/load/pbrt/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "color/named_spectra.h"
#include "render/load/brdf/measured.h"
#include "render/load/pbrt/features.h"

namespace latent::render {

namespace {

struct Reading {
    const ParameterList& list;
    SceneTextures& textures;
    const SceneFiles& files;
    PbrtMaterial& whole;
    MaterialDescription& material;  // whole.surface
};
// Reads one parameter of a material, or a few that belong together, into the inputs of its closure.
using Part = std::function<void(const Reading&)>;

// A number, or a texture of numbers.
Part number(const std::string& name, double otherwise, double low, double high, const std::string& input = "") {
    return [=](const Reading& r) {
        r.material.numbers[input.empty() ? name : input] = r.textures.number(r.list, name, otherwise, low, high);
    };
}

// Where no texture is possible.
Part constant(const std::string& name, double otherwise, double low, double high) {
    return [=](const Reading& r) { r.material.numbers[name] = static_cast<float>(r.list.number(name, otherwise, low, high)); };
}

Part count(const std::string& name, const std::string& input, std::int64_t otherwise, std::int64_t low, std::int64_t high) {
    return [=](const Reading& r) {
        r.material.options[input] = static_cast<std::uint32_t>(r.list.integer(name, otherwise, low, high));
    };
}

// A flag: the second of two words. The first is the default, and leaves it out.
Part either(const std::string& name, const std::string& first, const std::string& second, const std::string& input) {
    return [=](const Reading& r) {
        const std::string word = r.list.string(name).value_or(first);
        if (word == second) r.material.options[input] = 1;
        if (word != first && word != second)
            r.list.error(fmt::format("{}: \"{}\" is neither {} nor {}", name, word, first, second));
    };
}

// A flag that is false by default.
Part flag(const std::string& name, const std::string& input) {
    return [=](const Reading& r) {
        if (r.list.flag(name, false)) r.material.options[input] = 1;
    };
}

// One of several reflectances that share the light (see `conserving`).
Part share(const std::string& name, double otherwise) {
    return [=](const Reading& r) {
        r.material.spectra[name] =
            r.textures.spectrum(r.list, name, SpectrumRole::kReflectance, color::Spectrum::constant(otherwise));
    };
}

// Read after two shares, and "scale" if there is one: a warning, if the shares are constant and, times the scale, exceed 1
// together at some wavelength.
Part conserving(const std::string& a, const std::string& b) {
    return [=](const Reading& r) {
        const SpectrumInput &x = r.material.spectra.at(a), &y = r.material.spectra.at(b);
        if (x.is_textured() || y.is_textured()) return;
        const auto scale = static_cast<double>(r.material.number("scale", 1).value);
        bool exceeds = false;
        for (double nm = color::kLambdaMin; nm <= color::kLambdaMax; ++nm)
            exceeds |= scale * (x.value(nm) + y.value(nm)) > 1 + 1e-9;
        if (exceeds) r.list.warn(fmt::format("{} + {}: exceeds 1, so the surface creates energy", a, b));
    };
}

Part reflectance(const std::string& name, double otherwise, const std::string& input = "") {
    return [=](const Reading& r) {
        const SpectrumInput read =
            r.textures.spectrum(r.list, name, SpectrumRole::kReflectance, color::Spectrum::constant(otherwise));
        if (!read.is_textured() && read.value.max_value() > 1) r.list.warn(name + ": exceeds 1, so the surface creates energy");
        r.material.spectra[input.empty() ? name : input] = read;
    };
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

// The index of something clear, over that of air.
Part constant_index(const std::string& name, double otherwise) {
    return
        [=](const Reading& r) { r.material.spectra[name] = color::Spectrum::constant(r.list.number(name, otherwise, 1e-3, 1e3)); };
}
Part index(const std::string& name, const std::string& input = "eta") {
    return [=](const Reading& r) {
        color::Spectrum eta = color::Spectrum::constant(r.list.number(name, 1.5, 1e-3, 1e3));
        if (const auto found = r.textures.find_value(r.list, name, SpectrumRole::kUnbounded)) eta = *found;
        check_index(r.list, name, eta);
        r.material.spectra[input] = eta;
    };
}

// GGX alpha of "roughness", or of one axis where that is given; pbrt's remapping is alpha = sqrt(roughness). The names follow
// `prefix`, but for "remaproughness", and those of the inputs follow `input`.
Part roughness(const std::string& prefix = "", const std::string& input = "") {
    return [=](const Reading& r) {
        const bool remap = r.list.flag("remaproughness", true);
        const double both = r.list.number(prefix + "roughness", 0, 0, 1e6);
        const std::optional<std::uint32_t> texture = r.textures.find_texture(r.list, prefix + "roughness");
        const auto axis = [&](const std::string& name) {
            const double own = r.list.number(name, both, 0, 1e6);
            const bool has_own = r.list.find(name, {"float", "integer"}) != nullptr;
            FloatInput alpha(static_cast<float>(remap ? std::sqrt(own) : own));
            alpha.texture = r.textures.find_texture(r.list, name).value_or(has_own ? kNone : texture.value_or(kNone));
            r.material.remap_roughness |= remap && alpha.is_textured();
            return alpha;
        };
        r.material.numbers[input + "alpha_x"] = axis(prefix + "uroughness");
        r.material.numbers[input + "alpha_y"] = axis(prefix + "vroughness");
    };
}

// By both parts of its index, or by its reflectance at normal incidence.
Part metal(const std::string& prefix = "") {
    return [=](const Reading& r) {
        const auto reflectance = r.textures.find_spectrum(r.list, "reflectance", SpectrumRole::kReflectance);
        const auto eta = r.textures.find_spectrum(r.list, prefix + "eta", SpectrumRole::kUnbounded),
                   k = r.textures.find_spectrum(r.list, prefix + "k", SpectrumRole::kUnbounded);
        auto& spectra = r.material.spectra;
        if (reflectance && (eta || k)) r.list.error(fmt::format("reflectance cannot be combined with {0}eta and {0}k", prefix));
        if (reflectance && reflectance->is_textured()) {
            spectra["reflectance"] = *reflectance;
        } else if (reflectance) {
            // At normal incidence R = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2); eta = 1 leaves k = 2 sqrt(R / (1 - R)).
            const auto k_of = [&](double lambda) {
                const double limited = std::min(reflectance->value(lambda), 0.9999);
                return 2 * std::sqrt(limited) / std::sqrt(1 - limited);
            };
            spectra["eta"] = color::Spectrum::constant(1);
            spectra["k"] = color::Spectrum::from_function(k_of, color::Outside::kClamped);
        } else {
            spectra["eta"] = eta ? *eta : color::named_spectrum("metal-Cu-eta").value();
            spectra["k"] = k ? *k : color::named_spectrum("metal-Cu-k").value();
            check_index(r.list, prefix + "eta", spectra["eta"]);
        }
    };
}

// The albedo of a layer; without one, nothing scatters in it.
Part albedo() {
    return [](const Reading& r) {
        reflectance("albedo", 0, "layer.albedo")(r);
        const SpectrumInput& read = r.material.spectra["layer.albedo"];
        if (!read.is_textured() && !(read.value.max_value() > 0)) r.material.spectra.erase("layer.albedo");
    };
}

// Absorption by "sigma_a", by the colour of much hair ("reflectance", or "color" if that is missing), or by what colours hair: two
// kinds of melanin.
Part pigment() {
    return [](const Reading& r) {
        const ParameterList& list = r.list;
        const auto sigma_a = r.textures.find_spectrum(list, "sigma_a", SpectrumRole::kUnbounded);
        const auto reflectance = r.textures.find_spectrum(list, "reflectance", SpectrumRole::kReflectance),
                   same = r.textures.find_spectrum(list, "color", SpectrumRole::kReflectance),
                   color = reflectance ? reflectance : same;
        const bool has_melanin = list.find("eumelanin", {"float"}) != nullptr || list.find("pheomelanin", {"float"}) != nullptr;
        const double eumelanin = list.number("eumelanin", has_melanin ? 0 : 1.3, 0, 1e6),
                     pheomelanin = list.number("pheomelanin", 0, 0, 1e6);
        if (r.textures.find_texture(list, "eumelanin") || r.textures.find_texture(list, "pheomelanin"))
            list.error("eumelanin, pheomelanin: textures are not supported; give sigma_a or reflectance as a texture");
        if ((sigma_a ? 1 : 0) + (color ? 1 : 0) + (has_melanin ? 1 : 0) > 1)
            list.warn("sigma_a, reflectance, melanin: only the first of these that is given counts");
        if (color && !sigma_a) {
            r.material.spectra["color"] = *color;
        } else {
            r.material.spectra["sigma_a"] =
                sigma_a ? *sigma_a
                        : r.textures.unbounded({0.419 * eumelanin + 0.187 * pheomelanin, 0.697 * eumelanin + 0.4 * pheomelanin,
                                                1.37 * eumelanin + 1.05 * pheomelanin});
        }
    };
}

// A file of the RGL database.
Part measurement() {
    return [](const Reading& r) {
        const std::optional<std::string> name = r.list.string("filename");
        if (!name) return r.list.error("filename: is required");
        const Result<std::string> bytes = r.files.read(*name);
        if (!bytes) return r.list.unreadable(bytes.error());
        const auto brdf = read_measured_brdf(std::as_bytes(std::span(*bytes)));
        if (!brdf) return r.list.error(fmt::format("{}: {}", *name, brdf.error().message));
        r.material.measured = *brdf;
    };
}

// Inputs of Phong's two closures: the matt share, the share of the lobe, its exponent, and one more.
std::vector<Part> glossy(const Part& more) {
    return {share("Kd", 0.25), share("Ks", 0.25), number("exponent", 20, 0, 1e5), more, conserving("Kd", "Ks")};
}

// Facets and body of a Principled surface: f0 is that of the index at 587.6 nm, and f90 is 1, both times "specular".
Part mirror() {
    return [](const Reading& r) {
        index("eta")(r);
        const double n = r.material.spectra.at("eta").value(587.5618), root = (n - 1) / (n + 1),
                     weight = r.list.number("specular", 1, 0, 1);
        r.material.spectra.erase("eta");
        r.material.numbers["f0"] = static_cast<float>(std::min(root * root, 1.0) * weight);
        r.material.numbers["f90"] = static_cast<float>(weight);
        if (const auto color = r.textures.find_spectrum(r.list, "specularcolor", SpectrumRole::kReflectance))
            r.material.spectra["specular_color"] = *color;
    };
}

// Fibres above the surface, unless their colour is black.
Part sheen() {
    return [](const Reading& r) {
        const std::optional<SpectrumInput> color = r.textures.find_spectrum(r.list, "sheen", SpectrumRole::kReflectance);
        const FloatInput roughness = r.textures.number(r.list, "sheenroughness", 0.5, 0, 1);
        if (!color || (!color->is_textured() && !(color->value.max_value() > 0))) return;
        r.material.type = "sheen";
        r.material.spectra["sheen.color"] = *color;
        r.material.numbers["sheen.roughness"] = roughness;
    };
}

// The points of a Principled surface that light passes: of glass, or like paper. Metal is opaque.
Part passing() {
    return [](const Reading& r) {
        FloatInput& metallic = r.material.numbers.at("metallic");
        const auto share = [&](const char* name) {
            FloatInput given = r.textures.number(r.list, name, 0, 0, 1);
            if (given.is_textured() || given.value > 0) {
                if (metallic.is_textured() || (given.is_textured() && metallic.value > 0))
                    r.list.error(fmt::format("{}: needs a number for metallic; a texture for it needs metallic 0", name));
                given.value *= 1 - metallic.value;
            }
            return given;
        };
        const FloatInput clear = share("transmission"), matt = share("diffusetransmission");
        const bool is_thin = r.list.flag("thin", false), is_tinted = r.list.flag("tintedreflection", false),
                   is_clear = clear.is_textured() || clear.value > 0, is_matt = matt.is_textured() || matt.value > 0;
        const auto color = r.textures.find_spectrum(r.list, "diffusetransmissioncolor", SpectrumRole::kReflectance);
        if (is_clear && is_matt) r.list.error("transmission and diffusetransmission cannot be combined");
        r.whole.second_share = is_clear ? clear : matt;
        if (metallic.value > 0) metallic.value /= 1 - r.whole.second_share.value;  // as a share of the light that does not pass
        if (is_clear) {
            MaterialDescription glass{.type = is_thin ? "thindielectric" : "dielectric", .location = r.material.location};
            const SpectrumInput& base = r.material.spectra.at("base_color");
            const bool is_white = !base.is_textured() && base.value.min_value() == 1 && base.value.max_value() == 1;
            if (!is_white) glass.spectra["transmittance"] = base;
            if (!is_white && !is_thin && is_tinted) glass.spectra["reflectance"] = base;
            const FloatInput& rough = r.material.numbers.at("roughness");
            if (rough.is_textured()) r.list.error("roughness: of glass must be a number");
            glass.numbers["alpha_x"] = glass.numbers["alpha_y"] = rough.value * rough.value;
            if (!is_thin) glass.options = r.material.options;
            const Reading of_glass{r.list, r.textures, r.files, r.whole, glass};
            index("eta")(of_glass);
            r.whole.second = std::move(glass);
        } else if (is_matt) {
            r.whole.second = MaterialDescription{.type = "diffusetransmission",
                                                 .spectra = {{"transmittance", color.value_or(color::Spectrum::constant(1))}},
                                                 .location = r.material.location};
        }
    };
}

// A film on the surface and on its glass, and facets that are rougher in one direction.
Part film_and_direction() {
    return [](const Reading& r) {
        const FloatInput film = r.textures.number(r.list, "film", 0, 0, 1),
                         thickness = r.textures.number(r.list, "filmthickness", 400, 0, 1e6),
                         anisotropy = r.textures.number(r.list, "anisotropy", 0, 0, 1);
        const double eta = r.list.number("filmeta", 1.3, 1, 10), turns = r.list.number("anisotropyrotation", 0, -360, 360) / 360;
        const bool has_glass = r.whole.second && r.whole.second->type != "diffusetransmission";
        for (MaterialDescription* covered : {&r.material, has_glass ? &*r.whole.second : nullptr}) {
            if (covered == nullptr) continue;
            if (film.is_textured() || film.value > 0) {
                covered->numbers["film"] = film;
                covered->numbers["film_eta"] = static_cast<float>(eta);
                covered->numbers["film_thickness"] = thickness;
            }
            if (!anisotropy.is_textured() && anisotropy.value == 0) continue;
            covered->numbers["anisotropy"] = anisotropy;
            if (turns != 0) covered->numbers["anisotropy_turns"] = static_cast<float>(turns - std::floor(turns));
        }
    };
}

struct MaterialType {
    std::string name;
    std::vector<Part> parts;     // read in this order
    std::string closure = name;  // MaterialDescription::type
};

// The layer on a coated material; the names of what belongs to its surface follow `prefix`.
std::vector<Part> coated(std::vector<Part> base, const std::string& prefix) {
    for (Part& part :
         std::vector<Part>{index(prefix + "eta", "layer.eta"), roughness(prefix, "layer."),
                           number("thickness", 0.01, 0, 1e6, "layer.thickness"), albedo(), number("g", 0, -1, 1, "layer.g"),
                           count("maxdepth", "layer.max_depth", 10, 0, 1 << 30), count("nsamples", "layer.walks", 1, 1, 100'000)})
        base.push_back(std::move(part));
    return base;
}

// Every material that is made of a closure, and its parameters.
const std::vector<MaterialType>& types() {
    static const std::vector<MaterialType> table = {
        {"diffuse", {reflectance("reflectance", 0.5)}},
        {"phong", glossy(either("latent:lobe", "mirror", "retro", "retro"))},
        {"latent:phongtransmission", glossy(number("eta", 1, 1e-3, 1e3)), "phongtransmission"},
        {"conductor",
         {metal(), roughness(), either("latent:lobe", "mirror", "retro", "retro"), flag("latent:multiscatter", "multiscatter")}},
        {"dielectric", {index("eta"), roughness(), flag("latent:multiscatter", "multiscatter")}},
        {"thindielectric", {index("eta")}},
        {"diffusetransmission",
         {share("reflectance", 0.25), share("transmittance", 0.25), constant("scale", 1, 0, 1e6),
          conserving("reflectance", "transmittance")}},
        {"coateddiffuse", coated({reflectance("reflectance", 0.5)}, "")},
        {"coatedconductor", coated({metal("conductor."), roughness("conductor.")}, "interface.")},
        {"hair",
         {number("eta", 1.55, 1.0001, 10), number("beta_m", 0.3, 0, 1), number("beta_n", 0.3, 0, 1), number("alpha", 2, -45, 45),
          pigment()}},
        {"measured", {measurement()}},
        {"latent:principled",
         {reflectance("color", 0.8, "base_color"), number("metallic", 0, 0, 1), number("roughness", 0.5, 0, 1), mirror(),
          number("coat", 0, 0, 1), number("coatroughness", 0, 0, 1, "coat_roughness"), flag("multiscatter", "multiscatter"),
          sheen(), passing(), film_and_direction()},
         "metallicroughness"},
        {"subsurface", {constant_index("eta", 1.33), roughness()}, "dielectric"},  // what is below: read_subsurface
    };
    return table;
}

}  // namespace

std::vector<std::string_view> material_types() {
    std::vector<std::string_view> names;
    for (const MaterialType& type : types()) names.push_back(type.name);
    names.insert(names.end(), {"mix", "interface"});
    return names;
}

bool is_interface(std::string_view type) { return type == "interface" || type == "none" || type.empty(); }

std::optional<PbrtMaterial> read_material(const std::string& type, const ParameterList& list, SceneTextures& textures,
                                          const SceneFiles& files) {
    if (is_interface(type)) {
        if (type != "interface") list.note(fmt::format("Material \"{}\": an old name of \"interface\"", type));
        list.report_unused();
        return std::nullopt;
    }
    const auto found = std::ranges::find(types(), type, &MaterialType::name);
    if (found == types().end()) {
        list.error(unsupported("Material", type));
        return std::nullopt;
    }
    PbrtMaterial whole{.surface = {.type = found->closure, .location = list.directive().where}};
    MaterialDescription& material = whole.surface;
    for (const Part& read : found->parts) read({list, textures, files, whole, material});
    material.displacement.texture = textures.find_texture(list, "displacement").value_or(kNone);
    material.normal_map = textures.normal_map(list);
    if (material.displacement.is_textured() && material.normal_map != kNone) {
        list.warn("normalmap: ignored, since there is a displacement");
        material.normal_map = kNone;
    }
    if (whole.second) {
        whole.second->displacement = material.displacement;
        whole.second->normal_map = material.normal_map;
        if (!whole.second_share.is_textured() && whole.second_share.value == 1) {
            material = *std::exchange(whole.second, std::nullopt);
        }
    }
    list.report_unused();
    return whole;
}

}  // namespace latent::render
