#include "render/load/pbrt/textures.h"

#include <fmt/format.h>

#include "render/scene/check.h"

namespace latent::render {

namespace {

const color::Spectrum kZero = color::Spectrum::constant(0), kOne = color::Spectrum::constant(1);

}  // namespace

void SceneTextures::define(const Directive& directive, const std::vector<Parameter>& inherited, const Affined& ctm,
                           const std::string& color_space) {
    const std::string &name = directive.strings[0], &type = directive.strings[1];
    if (type != "float" && type != "spectrum")
        return diagnostics_.error(directive.where,
                                  fmt::format("Texture \"{}\": the type is \"{}\", not float or spectrum", name, type));
    const auto [at, is_new] =
        definitions_.try_emplace({type == "spectrum", name}, Definition{directive, inherited, ctm, color_space});
    if (!is_new)
        diagnostics_.error(directive.where,
                           fmt::format("Texture \"{}\": defined before, on line {}", name, at->second.directive.where.line));
}

std::uint32_t SceneTextures::use(const ParameterList& list, const Parameter& p, bool is_spectrum, SpectrumRole role) {
    if (p.strings.size() != 1) {
        list.error(p, "must be the name of one texture");
        return kNone;
    }
    const auto next = static_cast<std::uint32_t>(uses_.size());
    const auto [at, is_new] = used_.try_emplace({is_spectrum, role, p.strings[0]}, next);
    if (is_new) uses_.push_back({is_spectrum, role, p.strings[0], p.where});
    return at->second;
}

std::optional<std::uint32_t> SceneTextures::find_texture(const ParameterList& list, std::string_view name) {
    const Parameter* p = list.find(name, {"texture"});
    if (p == nullptr) return std::nullopt;
    return use(list, *p, false, SpectrumRole::kUnbounded);
}

FloatInput SceneTextures::number(const ParameterList& list, std::string_view name, double otherwise, double low, double high) {
    FloatInput input(static_cast<float>(list.number(name, otherwise, low, high)));
    input.texture = find_texture(list, name).value_or(kNone);
    return input;
}

std::optional<SpectrumInput> SceneTextures::find_spectrum(const ParameterList& list, std::string_view name, SpectrumRole role) {
    if (const Parameter* p = list.find(name, {"texture"})) {
        SpectrumInput input;
        input.texture = use(list, *p, true, role);
        return input;
    }
    if (std::optional<color::Spectrum> value = spectra_.find(list, name, role)) return SpectrumInput(std::move(*value));
    return std::nullopt;
}

SpectrumInput SceneTextures::spectrum(const ParameterList& list, std::string_view name, SpectrumRole role,
                                      const color::Spectrum& otherwise) {
    return find_spectrum(list, name, role).value_or(SpectrumInput(otherwise));
}

TextureDescription SceneTextures::read(const Definition& definition, const Use& use) {
    const ParameterList list(definition.directive, definition.inherited, diagnostics_);
    spectra_.set_color_space(definition.color_space);
    TextureDescription texture{.is_spectrum = use.is_spectrum, .role = use.role, .location = definition.directive.where};
    const auto input = [&](int i, std::string_view name, double otherwise) {
        if (use.is_spectrum) {
            texture.spectra[i] = spectrum(list, name, use.role, otherwise == 0 ? kZero : kOne);
        } else {
            texture.numbers[i] = number(list, name, otherwise);
        }
    };
    const std::string& kind = definition.directive.strings[2];
    if (kind == "constant") {
        texture.kind = TextureKind::kConstant;
        input(0, "value", 1);
    } else if (kind == "scale") {
        texture.kind = TextureKind::kScale;
        input(0, "tex", 1);
        texture.amount = number(list, "scale", 1);
    } else if (kind == "mix") {
        texture.kind = TextureKind::kMix;
        input(0, "tex1", 0);
        input(1, "tex2", 1);
        texture.amount = number(list, "amount", 0.5);
    } else {
        list.error(fmt::format("Texture \"{}\": the class \"{}\" is not supported (constant, scale, mix)",
                               definition.directive.strings[0], kind));
        return texture;
    }
    list.report_unused();
    return texture;
}

void SceneTextures::finish() {
    for (std::size_t i = 0; i < uses_.size(); ++i) {  // reading one may add to them
        const Use use = uses_[i];
        scene_.textures.emplace_back();
        const auto found = definitions_.find({use.is_spectrum, use.name});
        if (found == definitions_.end()) {
            const bool other = definitions_.contains({!use.is_spectrum, use.name});
            diagnostics_.error(
                use.where,
                fmt::format(
                    "{} texture \"{}\" is not defined anywhere{}", use.is_spectrum ? "spectrum" : "float", use.name,
                    other ? fmt::format("; \"{}\" is a {} texture", use.name, use.is_spectrum ? "float" : "spectrum") : ""));
            continue;
        }
        scene_.textures[i] = read(found->second, use);
    }
    if (!diagnostics_.errors().empty()) return;
    for (const auto& [texture, refusal] : check_textures(scene_.textures))
        diagnostics_.error(scene_.textures[texture].location, refusal);
}

}  // namespace latent::render
