#include "render/load/pbrt/spectra.h"

#include <fmt/format.h>

#include <algorithm>

#include "color/light_spectrum.h"
#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::render {

namespace {

std::string space_of(const std::string& pbrt_name) {
    if (pbrt_name == "aces2065-1") return "0.7347,0.2653,0,1,0.0001,-0.077,0.32168,0.33767";
    return pbrt_name == "dci-p3" ? "display-p3" : pbrt_name;
}

color::Spectrum clamped(const std::function<double(double)>& f) {
    return color::Spectrum::from_function(f, color::Outside::kClamped);
}

bool is_grey(std::span<const double> rgb) { return rgb[0] == rgb[1] && rgb[1] == rgb[2]; }

// The same light with Y = 1.
color::Spectrum normalised(const color::Spectrum& light) { return light.scaled(1 / color::photometric_sum(light)); }

}  // namespace

bool SceneSpectra::set_color_space(const std::string& name) {
    if (name != "srgb" && name != "dci-p3" && name != "rec2020" && name != "aces2065-1") return false;
    color_space_ = name;
    return true;
}

const color::RgbToSpectrum& SceneSpectra::rgb() {
    const auto known = rgb_.find(color_space_);
    if (known != rgb_.end()) return known->second;
    const color::RgbSpace space = color::RgbSpace::parse(space_of(color_space_)).value();
    const color::Spectrum white =
        color_space_ == "aces2065-1" ? color::named_spectrum("illum-acesD60").value() : color::illuminant_d65();
    return rgb_.emplace(color_space_, color::RgbToSpectrum(space, white)).first->second;
}

// Colours that sRGB does not have lose their negative components.
color::Rgb SceneSpectra::to_srgb(const color::Rgb& rgb) const {
    if (color_space_ == "srgb") return rgb;
    const color::RgbSpace space = color::RgbSpace::parse(space_of(color_space_)).value();
    const std::array<double, 3> srgb =
        color::RgbSpace::srgb().rgb_from_xyz * (space.xyz_from_rgb * std::array<double, 3>{rgb.r, rgb.g, rgb.b});
    return {std::max(srgb[0], 0.0), std::max(srgb[1], 0.0), std::max(srgb[2], 0.0)};
}

color::Spectrum SceneSpectra::spectrum_of(const color::Rgb& value, SpectrumRole role) {
    const bool reflects = role == SpectrumRole::kReflectance;
    if (is_basis()) {
        const auto limited = [&](double x) { return reflects ? std::min(x, 1.0) : x; };
        const color::Rgb srgb = to_srgb(value);
        return color::rgb_basis_spectrum({limited(srgb.r), limited(srgb.g), limited(srgb.b)});
    }
    const color::SigmoidSpectrum s = reflects ? rgb().reflectance(value) : rgb().unbounded(value);
    return clamped([s](double l) { return s(static_cast<float>(l)); });
}

std::array<float, 4> SceneSpectra::voxel_of(const color::Rgb& value) {
    if (is_basis()) {
        const color::Rgb srgb = to_srgb(value);
        return {static_cast<float>(srgb.r), static_cast<float>(srgb.g), static_cast<float>(srgb.b), 1};
    }
    const color::SigmoidSpectrum s = rgb().unbounded(value);
    return {s.c0, s.c1, s.c2, s.scale};
}

color::Spectrum SceneSpectra::unbounded(const std::array<double, 3>& value) {
    if (is_grey(value)) return color::Spectrum::constant(value[0]);
    const color::Rgb rgb{value[0], value[1], value[2]};
    if (is_basis()) return color::rgb_basis_spectrum(rgb);
    static const color::RgbToSpectrum srgb(color::RgbSpace::srgb(), color::illuminant_d65());
    return clamped([s = srgb.unbounded(rgb)](double l) { return s(static_cast<float>(l)); });
}

color::Spectrum SceneSpectra::white() { return normalised(rgb().illuminant()); }

color::Spectrum SceneSpectra::white_of_pictures() { return normalised(color::illuminant_d65()); }

std::optional<color::Spectrum> SceneSpectra::find(const ParameterList& list, std::string_view name, SpectrumRole role) {
    const Parameter* p = parameter(list, name);
    if (p == nullptr) return std::nullopt;
    std::optional<color::Spectrum> spectrum = resolve(list, *p, role);
    if (spectrum && spectrum->min_value() < 0) {
        list.error(*p, "has negative values");
        return std::nullopt;
    }
    return spectrum;
}

color::Spectrum SceneSpectra::emission(const ParameterList& list, std::string_view name) {
    const Parameter* p = parameter(list, name);
    if (p == nullptr) return white();
    const std::optional<color::Spectrum> spectrum = find(list, name, SpectrumRole::kUnbounded);
    if (!spectrum) return {};
    if (p->type == "rgb") {
        const color::Spectrum illuminant = white();
        return clamped([&](double lambda) { return (*spectrum)(lambda)*illuminant(lambda); });
    }
    if (spectrum->max_value() == 0) return {};
    const color::Spectrum emitted = with_lines_widened(*spectrum);
    const double y = luminance(emitted);
    if (y > 0) return emitted.scaled(1 / y);
    list.error(*p, "has no visible part, so it cannot be normalised to a luminance");
    return {};
}

std::optional<color::Spectrum> SceneSpectra::resolve(const ParameterList& list, const Parameter& p, SpectrumRole role) {
    if (p.type == "blackbody" || p.type == "latent:daylight") {
        if (p.numbers.size() != 1) {
            list.error(p, "must be one temperature in kelvin");
            return std::nullopt;
        }
        Result<color::Spectrum> spectrum =
            p.type == "blackbody" ? color::Spectrum::blackbody(p.numbers[0]) : color::daylight(p.numbers[0]);
        if (spectrum) return *spectrum;
        list.error(p, spectrum.error().message);
        return std::nullopt;
    }
    if (p.type == "rgb") {
        if (p.numbers.size() != 3 || *std::min_element(p.numbers.begin(), p.numbers.end()) < 0) {
            list.error(p, "must be three non-negative numbers");
            return std::nullopt;
        }
        if (is_grey(p.numbers)) {
            if (role == SpectrumRole::kUnbounded || p.numbers[0] <= 1) return color::Spectrum::constant(p.numbers[0]);
        }
        const color::Rgb value{p.numbers[0], p.numbers[1], p.numbers[2]};
        if (role == SpectrumRole::kUnbounded) return spectrum_of(value, role);
        if (*std::max_element(p.numbers.begin(), p.numbers.end()) > 1) {
            list.error(p, "a reflectance must not exceed 1");
            return std::nullopt;
        }
        return spectrum_of(value, role);
    }
    if (p.strings.empty()) return from_pairs(list, p, p.numbers);
    if (p.strings.size() > 1) {
        list.error(p, "must be one name");
        return std::nullopt;
    }
    if (Result<color::Spectrum> named = color::named_spectrum(p.strings[0])) return *named;
    return from_file(list, p);
}

std::optional<color::Spectrum> SceneSpectra::from_pairs(const ParameterList& list, const Parameter& p,
                                                        std::span<const double> pairs) {
    if (pairs.empty() || pairs.size() % 2 != 0) {
        list.error(p, "must be pairs of wavelength and value");
        return std::nullopt;
    }
    std::vector<double> lambda, value;
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
        lambda.push_back(pairs[i]);
        value.push_back(pairs[i + 1]);
    }
    Result<color::Spectrum> spectrum = color::Spectrum::from_samples(std::move(lambda), std::move(value), color::Outside::kZero);
    if (spectrum) return *spectrum;
    list.error(p, spectrum.error().message);
    return std::nullopt;
}

std::optional<color::Spectrum> SceneSpectra::from_file(const ParameterList& list, const Parameter& p) {
    const Result<std::string> text = files_.read(p.strings[0]);
    if (!text) {
        const bool missing = text.error().code == ErrorCode::kNotFound;
        list.error(p, missing ? fmt::format("\"{}\" is neither a known spectrum nor a file", p.strings[0]) : text.error().message);
        return std::nullopt;
    }
    std::vector<double> pairs;
    Tokenizer words(*text, 0);
    while (true) {
        const auto token = words.next();
        if (token && !*token) break;
        const std::optional<double> value = token ? parse_number((*token)->text) : std::nullopt;
        if (!value) {
            const std::uint32_t line = token ? (*token)->where.line : token.error().where.line;
            list.error(p, fmt::format("{}: line {}: not a number", p.strings[0], line));
            return std::nullopt;
        }
        pairs.push_back(*value);
    }
    return from_pairs(list, p, pairs);
}

}  // namespace latent::render
