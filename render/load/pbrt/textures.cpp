#include "render/load/pbrt/textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/load/pbrt/features.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

// One of a few words.
template <class Value>
Value choice(const ParameterList& list, std::string_view name, const std::string& otherwise,
             const std::map<std::string, Value>& choices) {
    const std::string word = list.string(name).value_or(otherwise);
    const auto found = choices.find(word);
    if (found != choices.end()) return found->second;
    std::string words;
    for (const auto& [known, value] : choices) words += (words.empty() ? "" : ", ") + known;
    list.error(fmt::format("{}: \"{}\" is not one of {}", name, word, words));
    return choices.at(otherwise);
}

Vec3d vector(const ParameterList& list, std::string_view name, const Vec3d& otherwise) {
    const std::span<const double> values = list.array(name, "vector3", 3);
    if (values.empty()) return otherwise;
    if (values.size() > 3) list.error(fmt::format("{}: must be one vector", name));
    return {values[0], values[1], values[2]};
}

void refuse_motion(const ParameterList& list, const CurrentTransform& ctm) {
    if (ctm.moves())
        list.error("Texture: textures of space cannot move, but the transformation differs between StartTime and EndTime");
}

}  // namespace

void SceneTextures::define(const Directive& directive, const std::vector<Parameter>& inherited, const CurrentTransform& ctm,
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
    if (is_new) uses_.push_back({is_spectrum, role, p.strings[0], p.where, std::nullopt});
    return at->second;
}

std::optional<std::uint32_t> SceneTextures::find_texture(const ParameterList& list, std::string_view name) {
    const Parameter* p = list.find(name, {"texture"});
    if (p == nullptr) return std::nullopt;
    return use(list, *p, false, SpectrumRole::kUnbounded);
}

std::uint32_t SceneTextures::use_picture(const ParameterList& list, const std::string& file, TextureDescription texture) {
    const Result<Hash128> content = files_.hash(file);
    if (!content) list.unreadable(content.error());
    texture.picture.path = files_.resolve(file).string();
    texture.picture.name = name_of(list, texture.picture);
    texture.picture.content = content.value_or(Hash128{});
    texture.location = list.directive().where;
    uses_.push_back({texture.is_spectrum, texture.role, file, texture.location, std::move(texture)});
    return static_cast<std::uint32_t>(uses_.size() - 1);
}

std::uint32_t SceneTextures::normal_map(const ParameterList& list) {
    const std::optional<std::string> file = list.string("normalmap");
    if (!file) return kNone;
    return use_picture(list, *file, {.kind = TextureKind::kNormalMap, .picture = {.is_srgb = false}});
}

std::uint32_t SceneTextures::emission(const ParameterList& list, const std::string& file) {
    return use_picture(list, file,
                       {.kind = TextureKind::kImage,
                        .is_spectrum = true,
                        .role = SpectrumRole::kUnbounded,
                        .picture = {.wrap = {TextureWrap::kClamp, TextureWrap::kClamp}}});
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

// The place of a texture is that of its directive; `is_solid`: a point of space, with nothing more to say about it.
void SceneTextures::read_mapping(const ParameterList& list, const CurrentTransform& ctm, bool is_solid,
                                 MappingDescription& mapping) {
    static const std::map<std::string, MappingKind> kKinds{{"uv", MappingKind::kUv},
                                                           {"spherical", MappingKind::kSpherical},
                                                           {"cylindrical", MappingKind::kCylindrical},
                                                           {"planar", MappingKind::kPlanar}};
    if (!is_solid) {
        mapping.kind = choice(list, "mapping", "uv", kKinds);
        if (mapping.kind == MappingKind::kUv) {
            mapping.s[0] = list.number("uscale", 1);
            mapping.t[1] = list.number("vscale", 1);
        }
        if (mapping.kind == MappingKind::kUv || mapping.kind == MappingKind::kPlanar) {
            mapping.delta_u = list.number("udelta", 0);
            mapping.delta_v = list.number("vdelta", 0);
        }
        if (mapping.kind == MappingKind::kUv) return;
        if (mapping.kind == MappingKind::kPlanar) {
            mapping.v1 = vector(list, "v1", mapping.v1);
            mapping.v2 = vector(list, "v2", mapping.v2);
        }
    }
    refuse_motion(list, ctm);
    const std::optional<Affined> inverse = ctm.start.inverse();
    if (!inverse) return list.error("Texture: the transformation is singular");
    mapping.texture_from_world = *inverse;
}

std::string SceneTextures::name_of(const ParameterList& list, const PictureDescription& picture) const {
    return diagnostics_.place(list.directive().where) + ": " + picture.path;
}

void SceneTextures::read_picture(const ParameterList& list, PictureDescription& picture) {
    static const std::map<std::string, TextureWrap> kWraps{{"repeat", TextureWrap::kRepeat},
                                                           {"black", TextureWrap::kBlack},
                                                           {"clamp", TextureWrap::kClamp},
                                                           {"octahedralsphere", TextureWrap::kOctahedralSphere}};
    static const std::map<std::string, TextureFilter> kFilters{
        {"point", TextureFilter::kPoint}, {"bilinear", TextureFilter::kBilinear}, {"trilinear", TextureFilter::kTrilinear},
        {"ewa", TextureFilter::kEwa},     {"EWA", TextureFilter::kEwa},           {"latent:quartic", TextureFilter::kQuartic}};
    picture.wrap.fill(choice(list, "wrap", "repeat", kWraps));
    picture.filter = choice(list, "filter", "bilinear", kFilters);
    const double anisotropy = list.number("maxanisotropy", 8, 1, 1e6);
    if (picture.filter == TextureFilter::kEwa) picture.max_anisotropy = std::min(anisotropy, 64.0);
    picture.scale = list.number("scale", 1);
    picture.invert = list.flag("invert", false);
    const std::string encoding = list.string("encoding").value_or("sRGB");
    std::optional<double> gamma;
    if (encoding == "linear") gamma = 1;
    if (encoding.starts_with("gamma ")) gamma = parse_number(std::string_view(encoding).substr(6));
    if (gamma && *gamma > 0 && *gamma <= 100) {
        picture.gamma = *gamma;
        picture.is_srgb = false;
    } else if (encoding != "sRGB") {
        list.error(fmt::format("encoding: \"{}\" is not supported (sRGB, linear, gamma X)", encoding));
    }
    const std::optional<std::string> name = list.string("filename");
    if (!name) return list.error("filename: missing");
    const Result<Hash128> content = files_.hash(*name);
    if (!content) return list.unreadable(content.error());
    picture.path = files_.resolve(*name).string();
    picture.name = name_of(list, picture);
    picture.content = *content;
}

TextureDescription SceneTextures::read(const Definition& definition, const Use& use) {
    const ParameterList list(definition.directive, definition.inherited, diagnostics_);
    spectra_.set_color_space(definition.color_space);
    TextureDescription texture{.is_spectrum = use.is_spectrum, .role = use.role, .location = definition.directive.where};
    const auto input = [&](std::size_t i, std::string_view name, double otherwise) {
        if (use.is_spectrum) {
            texture.spectra[i] = spectrum(list, name, use.role, color::Spectrum::constant(otherwise));
        } else {
            texture.numbers[i] = number(list, name, otherwise);
        }
    };
    const auto mapping = [&](bool is_solid) { read_mapping(list, definition.ctm, is_solid, texture.mapping); };
    const std::string& kind = definition.directive.strings[2];
    const auto is = [&](std::string_view name, TextureKind which) {
        if (kind == name) texture.kind = which;
        return kind == name;
    };
    if (is("constant", TextureKind::kConstant)) {
        input(0, "value", 1);
    } else if (is("scale", TextureKind::kScale)) {
        input(0, "tex", 1);
        texture.amount = number(list, "scale", 1);
    } else if (is("mix", TextureKind::kMix)) {
        input(0, "tex1", 0);
        input(1, "tex2", 1);
        texture.amount = number(list, "amount", 0.5);
    } else if (is("imagemap", TextureKind::kImage)) {
        mapping(false);
        read_picture(list, texture.picture);
    } else if (is("latent:vertexcolor", TextureKind::kVertexColor)) {
        static const std::map<std::string, std::uint8_t> kChannels{
            {"mean", 255}, {"red", 0}, {"green", 1}, {"blue", 2}, {"alpha", 3}};
        if (!use.is_spectrum) texture.picture.channel = choice(list, "channel", "mean", kChannels);
    } else if (is("checkerboard", TextureKind::kCheckerboard)) {
        texture.is_solid = list.integer("dimension", 2, 2, 3) == 3;
        input(0, "tex1", 1);
        input(1, "tex2", 0);
        mapping(texture.is_solid);
    } else if (is("dots", TextureKind::kDots)) {
        input(0, "inside", 1);
        input(1, "outside", 0);
        mapping(false);
    } else if (is("bilerp", TextureKind::kBilerp)) {
        input(0, "v00", 0);
        input(1, "v01", 1);
        input(2, "v10", 0);
        input(3, "v11", 1);
        mapping(false);
    } else if (is("directionmix", TextureKind::kDirectionMix)) {
        input(0, "tex1", 0);
        input(1, "tex2", 1);
        refuse_motion(list, definition.ctm);
        const Vec3d direction = definition.ctm.start.vector(vector(list, "dir", {0, 1, 0}));
        if (!(length(direction) > 0)) list.error("dir: must not be 0");
        texture.direction = normalize(direction);
    } else if ((!use.is_spectrum && (is("fbm", TextureKind::kFbm) || is("wrinkled", TextureKind::kWrinkled))) ||
               (use.is_spectrum && is("marble", TextureKind::kMarble))) {
        texture.octaves = static_cast<std::uint32_t>(list.integer("octaves", 8, 0, 64));
        texture.roughness = list.number("roughness", 0.5, 0, 1e3);
        if (use.is_spectrum) {
            texture.scale = list.number("scale", 1);
            texture.variation = list.number("variation", 0.2);
        }
        mapping(true);
    } else if (!use.is_spectrum && (is("latent:marble", TextureKind::kVeins) || is("latent:wood", TextureKind::kWood) ||
                                    is("latent:clouds", TextureKind::kClouds))) {
        texture.octaves = static_cast<std::uint32_t>(list.integer("octaves", 8, 0, 64));
        texture.roughness = list.number("roughness", 0.5, 0, 1e3);
        texture.scale = list.number("scale", 1);
        texture.variation = list.number("variation", texture.kind == TextureKind::kClouds ? 4 : 0.2, 0, 1e6);
        mapping(true);
    } else if (!use.is_spectrum && is("windy", TextureKind::kWindy)) {
        mapping(true);
    } else {
        list.error(
            fmt::format("Texture \"{}\": {} \"{}\" is not supported{} ({}; fbm, wrinkled, windy, latent:...: float only; marble: "
                        "spectrum only){}",
                        definition.directive.strings[0], definition.directive.strings[1], kind, near_types("Texture", kind),
                        types_of("Texture"), why_unread_type("Texture", kind)));
        return texture;
    }
    list.report_unused();
    return texture;
}

void SceneTextures::finish(std::vector<UndefinedName>& undefined) {
    for (std::size_t i = 0; i < uses_.size(); ++i) {  // reading one may add to them
        const Use use = uses_[i];
        scene_.textures.emplace_back();
        if (use.picture) {
            scene_.textures[i] = *use.picture;
            continue;
        }
        const auto found = definitions_.find({use.is_spectrum, use.name});
        if (found == definitions_.end()) {
            const auto name = [&](bool is_spectrum) {
                return fmt::format("{} texture \"{}\"", is_spectrum ? "spectrum" : "float", use.name);
            };
            const bool other = definitions_.contains({!use.is_spectrum, use.name});
            undefined.push_back(
                {use.where, name(use.is_spectrum), other ? fmt::format("; there is a {}", name(!use.is_spectrum)) : ""});
            continue;
        }
        scene_.textures[i] = read(found->second, use);
    }
    if (!diagnostics_.errors().empty() || !undefined.empty()) return;
    for (const auto& [texture, refusal] : check_textures(scene_.textures))
        diagnostics_.error(scene_.textures[texture].location, refusal);
}

}  // namespace latent::render
