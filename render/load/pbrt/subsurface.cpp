#include "render/load/pbrt/subsurface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/load/pbrt/measured_media.h"

namespace latent::render {

namespace {

// Mean reflectance of diffuse light that comes to a surface of index eta from below [Egan73].
double inner_reflectance(double eta) { return eta > 1 ? -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta : 0; }

// The single-scattering albedo, isotropic, of matter without end below a surface of index eta that gives back the share A of the
// light that enters. Without the surface it would give back a = A / (1 - F + F A), F the reflectance from below; this takes the
// albedo 1 - exp(-5.09406 a + 2.61188 a^2 - 4.31805 a^3) [ChiangKutz16].
double single_scattering_albedo(double reflectance, double eta) {
    const double inner = inner_reflectance(eta), a = reflectance / (1 - inner + inner * reflectance);
    return 1 - std::exp(a * (-5.09406 + a * (2.61188 - a * 4.31805)));
}

// Coefficients of matter with this reflectance and, where it scatters alike in all directions, this mean free path.
void invert(const color::Spectrum& reflectance, const color::Spectrum& mfp, double eta, MediumDescription& medium) {
    // Matter of mean cosine g is like isotropic matter of the albedo alpha (1 - g) / (1 - alpha g).
    const double g = medium.g, longer = std::max(medium.scale, 1e-12);
    const auto albedo = [&](double nm) {
        const double reduced = single_scattering_albedo(std::clamp(reflectance(nm), 0.0, 0.9999), eta);
        return reduced / (1 - g + g * reduced);
    };
    const auto sigma_t = [&](double nm) { return 1 / (longer * std::max(mfp(nm), 1e-12)); };
    const auto spectrum = [](auto&& f) { return color::Spectrum::from_function(f, color::Outside::kClamped); };
    medium.sigma_s = spectrum([&](double nm) { return albedo(nm) * sigma_t(nm); });
    medium.sigma_a = spectrum([&](double nm) { return (1 - albedo(nm)) * sigma_t(nm); });
    medium.scale = 1;
}

}  // namespace

MediumDescription read_subsurface(const ParameterList& list, SceneTextures& textures) {
    MediumDescription medium{.location = list.directive().where};
    const double eta = list.number("eta", 1.33, 1e-3, 1e3);
    medium.g = list.number("g", 0, -0.9999, 0.9999);
    medium.scale = list.number("scale", 1, 0, 1e12);
    const auto find = [&](const char* name, SpectrumRole role) -> std::optional<color::Spectrum> {
        const std::optional<SpectrumInput> input = textures.find_spectrum(list, name, role);
        if (!input) return std::nullopt;
        if (input->is_textured()) list.error(fmt::format("{}: textures are not supported here", name));
        return input->value;
    };
    const auto reflectance = find("reflectance", SpectrumRole::kReflectance), mfp = find("mfp", SpectrumRole::kUnbounded),
               sigma_a = find("sigma_a", SpectrumRole::kUnbounded), sigma_s = find("sigma_s", SpectrumRole::kUnbounded);
    const std::optional<std::string> name = list.string("name");
    if ((name ? 1 : 0) + (reflectance ? 1 : 0) + (sigma_a || sigma_s ? 1 : 0) > 1)
        list.error("subsurface: only one of name, reflectance, and sigma_a with sigma_s may be given");
    if (mfp && !reflectance) list.error("mfp: needs reflectance");
    if (sigma_a.has_value() != sigma_s.has_value()) list.error("sigma_a and sigma_s need each other");
    if (reflectance) {
        invert(*reflectance, mfp.value_or(color::Spectrum::constant(1)), eta, medium);
    } else if (sigma_a && sigma_s) {
        medium.sigma_a = *sigma_a;
        medium.sigma_s = *sigma_s;
    } else if (const std::optional<MeasuredMedium> known = measured_medium(name.value_or("Wholemilk"))) {
        medium.sigma_a = known->sigma_a;
        medium.sigma_s = known->sigma_s;
    } else {
        list.error(fmt::format("name: \"{}\" is not one of {}", *name, measured_media()));
    }
    return medium;
}

}  // namespace latent::render
