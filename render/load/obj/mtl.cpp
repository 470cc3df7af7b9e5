#include "render/load/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/load/files/pictures.h"
#include "render/load/files/unread.h"
#include "render/load/obj/maps.h"
#include "render/load/obj/statements.h"

namespace latent::render {

namespace {

// A newmtl block as it stands.
struct Block {
    std::string place, name;
    std::optional<LinearRgb> kd{}, ke{};
    LinearRgb ks{0, 0, 0};
    std::optional<LinearRgb> tf{};
    double ns = 20, ni = 1.5, opacity = 1;
    int illum = 2;
    std::optional<double> roughness{}, metallic{}, sheen{};
    double coat = 0, coat_roughness = 0;
    std::map<std::string, MtlMap, std::less<>> maps{};  // by keyword

    std::optional<TextureDescription> picture(std::string_view keyword) const {
        const auto found = maps.find(keyword);
        return found != maps.end() ? std::optional(found->second.texture) : std::nullopt;
    }
    PictureChannel channel(std::string_view keyword) const {
        const auto found = maps.find(keyword);
        return found != maps.end() ? found->second.channel : PictureChannel::kMean;
    }
};

constexpr double kIndex = 1.5, kSheenRoughness = 0.3, kF0OfKs = 0.08;
constexpr std::string_view kMaps[] = {"map_Kd", "map_Ks", "map_Ke", "map_Ns",  "map_d", "map_Pr",
                                      "map_Pm", "map_Ps", "map_Pc", "map_Pcr", "norm",  "bump"};
constexpr std::string_view kProperties[] = {"Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr"};

template <std::size_t N>
bool is_among(const std::string_view (&words)[N], std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

// Other spellings of one map.
std::string_view canonical(std::string_view keyword) {
    if (keyword == "map_bump" || keyword == "map_Bump" || keyword == "Bump") return "bump";
    if (keyword == "map_Kn" || keyword == "map_norm") return "norm";
    if (keyword == "map_opacity" || keyword == "map_D") return "map_d";
    return keyword;
}

LinearRgb rgb_of(const Statements& s) {
    if (s.words().size() > 1 && (s.words()[1] == "spectral" || s.words()[1] == "xyz")) {
        s.warn(fmt::format("{}: {} values are not read{}", s.keyword(), s.words()[1],
                           why_unread(SceneLanguage::kObj, "colours", s.words()[1])));
        return {};
    }
    LinearRgb rgb;
    for (std::size_t i = 0; i < 3; ++i) rgb[i] = s.number(s.words().size() > 3 ? i + 1 : 1);  // one number stands for all
    if (std::ranges::min(rgb) < 0) s.warn_of_kind("negative", fmt::format("{}: is negative, and counts as 0", s.keyword()));
    for (double& x : rgb) x = std::max(x, 0.0);
    return rgb;
}

double number_within(const Statements& s, double low, double high, std::size_t word = 1) {
    const double x = s.number(word);
    if (!(x >= low && x <= high))
        s.warn_of_kind(std::string(s.keyword()) + " clamped",
                       fmt::format("{}: {} is clamped: must be from {} to {}", s.keyword(), x, low, high));
    return std::clamp(x, low, high);
}

// By illum, light is mirrored as by a polished surface.
bool mirrors(const Block& b) { return b.illum == 3 || b.illum == 5 || b.illum == 8; }

// A metal has a Ks that is brighter than its Kd, and says that it mirrors: exporters write these illum for things that shine a
// little, too. Or next to nothing is seen of it but a Ks above 0.5, which Blender writes for anything.
bool is_metal(const Block& b, const LinearRgb& kd) {
    const double body = std::ranges::max(kd), mirror = std::ranges::max(b.ks);
    if (b.maps.contains("map_Kd") || b.illum < 2) return false;
    return mirrors(b) ? mirror > body : mirror > 0.5 && mirror >= 10 * body;
}

// Glass refracts. Maya writes illum 4 and an index of 1 for all that it has; Blender writes illum 9 for all that has a d below 1,
// and its d says how much of it is seen.
bool is_glass(const Block& b) {
    if (b.ni == 1 || b.maps.contains("map_Kd") || b.maps.contains("map_d")) return false;
    return b.illum == 4 || b.illum == 6 || b.illum == 7 || (b.illum == 9 && b.opacity == 1);
}
// Tf, or the hue of Kd.
LinearRgb tint_of_glass(const Block& b) {
    if (b.tf) return *b.tf;
    const double most = b.kd ? std::ranges::max(*b.kd) : 0;
    return most > 0 ? LinearRgb{(*b.kd)[0] / most, (*b.kd)[1] / most, (*b.kd)[2] / most} : LinearRgb{1, 1, 1};
}

// Of facets, as Blender and assimp read Ns, and as Blender writes it.
double roughness_of(double ns) { return 1 - std::sqrt(std::min(ns, 1000.0) / 1000); }

// Whether a picture's colours are directions near (0, 0, 1): normal maps are found under "bump", too.
bool is_normal_map(const PictureDescription& picture) {
    const Result<LoadedPicture> read = read_picture(picture.path, picture.name);
    if (!read || read->image.rgb.empty()) return false;
    std::array<double, 3> mean{};
    const std::vector<float>& rgb = read->image.rgb;
    for (std::size_t i = 0; i < rgb.size(); ++i) mean[i % 3] += static_cast<double>(rgb[i]) * 3 / static_cast<double>(rgb.size());
    const auto is_middle = [](double x) { return x > 0.13 && x < 0.32; };  // 0.4 to 0.6, decoded
    return is_middle(mean[0]) && is_middle(mean[1]) && mean[2] > 0.5;
}

// Materials out of blocks.
class Describer {
 public:
    explicit Describer(const MtlTarget& target) : target_(target), values_(target.colors, target.textures) {}

    MtlMaterial operator()(const Block& b) {
        MtlMaterial out;
        describe_surface(b, out.surface);
        out.surface.name = b.name;
        if (!is_glass(b)) out.alpha = alpha(b);
        describe_relief(b, out.surface);
        const bool is_mapped = b.maps.contains("map_Ke");
        const LinearRgb ke = b.ke.value_or(is_mapped ? LinearRgb{1, 1, 1} : LinearRgb{0, 0, 0});
        Result<std::optional<AreaLightDescription>> emission = values_.emission(b.picture("map_Ke"), ke);
        if (!emission) target_.diagnostics.warn(b.place, emission.error().message);
        if (!emission || !*emission) return out;
        out.emission = std::move(*emission);
        out.emission->name = b.name;
        out.radiance = std::ranges::max(ke);
        return out;
    }

 private:
    // Some programs write d 0 or Tr 1 for what is opaque; nobody means a material that is not there.
    FloatInput alpha(const Block& b) {
        if (b.opacity == 0)
            target_.diagnostics.warn_of_kind(
                "d 0", b.place, fmt::format("{}: d is 0 (or Tr is 1), which would hide all of it; it is opaque", b.name));
        const double opacity = b.opacity == 0 ? 1 : b.opacity;
        const auto color = b.maps.find("map_Kd");
        const bool has_alpha = !b.maps.contains("map_d") && color != b.maps.end() && color->second.alpha != AlphaUse::kUnused;
        const bool is_opacity = has_alpha && color->second.alpha == AlphaUse::kOpacity;
        if (has_alpha)
            target_.diagnostics.note_of_kind(
                is_opacity ? "alpha of map_Kd" : "other alpha of map_Kd", b.place,
                fmt::format("{}: has no map_d; the alpha of its map_Kd {}", b.name,
                            is_opacity ? "is its opacity" : "hides what looks like a picture, and is ignored"));
        if (!is_opacity) return values_.number(b.picture("map_d"), b.channel("map_d"), opacity);
        return values_.number(color->second.texture, PictureChannel::kAlpha, opacity);
    }

    // Which of the closures comes nearest. Transparency first, then what says that it is metallic-roughness, then metals, then what
    // has a gloss.
    void describe_surface(const Block& b, MaterialDescription& surface) {
        // Where the diffuse colour is black or missing, its picture is all there is.
        const bool is_mapped = b.maps.contains("map_Kd");
        LinearRgb kd = b.kd.value_or(LinearRgb{0.5, 0.5, 0.5});
        if (is_mapped && (!b.kd || std::ranges::max(kd) == 0)) kd = {1, 1, 1};
        const auto diffuse = [&] { return values_.color(b.picture("map_Kd"), kd, target_.by_vertex_color); };
        const auto number = [&](const char* map, double factor) { return values_.number(b.picture(map), b.channel(map), factor); };
        if (is_glass(b)) {
            surface.type = "dielectric";
            surface.spectra = {{"eta", color::Spectrum::constant(b.ni)}};
            const LinearRgb tint = tint_of_glass(b);
            if (tint != LinearRgb{1, 1, 1}) surface.spectra["transmittance"] = target_.colors.reflectance(tint);
            return;
        }
        const bool has_pbr = b.roughness || b.metallic || b.maps.contains("map_Pr") || b.maps.contains("map_Pm");
        if (has_pbr) {
            const double root = (b.ni - 1) / (b.ni + 1);
            surface.type = "metallicroughness";
            surface.spectra = {{"base_color", diffuse()}};
            surface.numbers = {{"roughness", number("map_Pr", b.roughness.value_or(b.maps.contains("map_Pr") ? 1 : 0.5))},
                               {"metallic", number("map_Pm", b.metallic.value_or(b.maps.contains("map_Pm") ? 1 : 0))},
                               {"f0", static_cast<float>(root * root)},
                               {"coat", number("map_Pc", b.coat)},
                               {"coat_roughness", number("map_Pcr", b.coat_roughness)}};
            const double sheen = b.sheen.value_or(b.maps.contains("map_Ps") ? 1 : 0);
            if (sheen == 0) return;
            surface.type = "sheen";
            surface.spectra["sheen.color"] = values_.color(b.picture("map_Ps"), {sheen, sheen, sheen});
            surface.numbers["sheen.roughness"] = static_cast<float>(kSheenRoughness);
        } else if (is_metal(b, kd)) {
            surface.type = "metallicroughness";
            surface.spectra = {{"base_color", values_.color(b.picture("map_Ks"), b.ks)}};
            surface.numbers = {{"metallic", 1.0f}, {"roughness", mirrors(b) ? FloatInput(0.0f) : roughness(b)}};
        } else if (std::ranges::max(b.ks) > 0 && b.illum >= 2) {
            // A dielectric. 0.5 stands for an index of 1.5; below it, reflection fades at all angles.
            const double ks = (b.ks[0] + b.ks[1] + b.ks[2]) / 3;
            surface.type = "metallicroughness";
            surface.spectra = {{"base_color", diffuse()}};
            surface.numbers = {{"metallic", 0.0f},
                               {"roughness", roughness(b)},
                               {"f0", number("map_Ks", kF0OfKs * std::min(ks, 1.0))},
                               {"f90", number("map_Ks", std::min(2 * ks, 1.0))}};
        } else {
            surface.spectra = {{"reflectance", diffuse()}};
        }
    }

    // A picture of Ns leads from matt to it.
    FloatInput roughness(const Block& b) {
        return values_.between(1, roughness_of(b.ns), values_.number(b.picture("map_Ns"), b.channel("map_Ns"), 1));
    }

    void describe_relief(const Block& b, MaterialDescription& surface) {
        const auto normals = b.maps.find("norm"), bump = b.maps.find("bump");
        const bool is_bump = normals == b.maps.end() && bump != b.maps.end();
        if (normals == b.maps.end() && !is_bump) return;
        const MtlMap& map = is_bump ? bump->second : normals->second;
        if (is_bump && !is_normal_map(map.texture.picture))
            return target_.diagnostics.warn_of_kind(
                "bump", b.place,
                fmt::format("{}: bump: is ignored{}", b.name, why_unread(SceneLanguage::kObj, "materials", "bump")));
        surface.normal_map = values_.normal_map(map.texture);
        surface.normal_scale = static_cast<float>(map.strength);
        surface.normals_follow_v = true;
    }

    const MtlTarget& target_;
    ModelValues values_;
};

void read_property(const Statements& s, Block& b) {
    const std::string_view key = s.keyword();
    if (key == "Kd") {
        b.kd = rgb_of(s);
    } else if (key == "Ks") {
        b.ks = rgb_of(s);
    } else if (key == "Ke") {
        b.ke = rgb_of(s);
    } else if (key == "Tf") {
        b.tf = rgb_of(s);
    } else if (key == "Ns") {
        b.ns = number_within(s, 0, 1e5);
    } else if (key == "Ni") {
        // Exporters write 0 for what is opaque.
        b.ni = s.number(1);
        if (!(b.ni >= 1 && b.ni <= 1e3)) {
            if (b.ni != 0) s.warn_of_kind("Ni", fmt::format("Ni: {} is no index of refraction; it is {}", b.ni, kIndex));
            b.ni = kIndex;
        }
    } else if (key == "d") {
        b.opacity = number_within(s, 0, 1, s.words().size() > 1 && s.words()[1] == "-halo" ? 2 : 1);
    } else if (key == "Tr") {
        b.opacity = 1 - number_within(s, 0, 1);
    } else if (key == "illum") {
        b.illum = static_cast<int>(number_within(s, 0, 10));
    } else if (key == "Pr") {
        b.roughness = number_within(s, 0, 1);
    } else if (key == "Pm") {
        b.metallic = number_within(s, 0, 1);
    } else if (key == "Ps") {
        b.sheen = number_within(s, 0, 1);
    } else if (key == "Pc") {
        b.coat = number_within(s, 0, 1);
    } else if (key == "Pcr") {
        b.coat_roughness = number_within(s, 0, 1);
    }
}

}  // namespace

bool read_mtl(std::string_view text, const std::string& name, const MtlTarget& target, MtlMaterials& materials) {
    Statements statements(text, target.files.resolve(name).string(), target.diagnostics);
    Describer describe(target);
    std::optional<Block> block;
    bool is_empty = true;  // but for comments
    while (statements.next()) {
        is_empty = false;
        const std::string_view key = statements.keyword();
        if (key == "newmtl") {
            if (block) materials[block->name] = describe(*block);
            block = Block{.place = statements.place(), .name = statements.rest()};
        } else if (!block) {
            if (!is_among(kProperties, key) && !is_among(kMaps, key) &&
                find_unread(SceneLanguage::kObj, "materials", key) == nullptr)
                return false;
            statements.warn(fmt::format("{}: comes before any newmtl, and is ignored", key));
        } else if (is_among(kMaps, canonical(key))) {
            if (std::optional<MtlMap> map = read_map(statements, name, target.files))
                block->maps.insert_or_assign(std::string(canonical(key)), std::move(*map));
        } else if (is_among(kProperties, key)) {
            read_property(statements, *block);
        } else {
            const UnreadFeatures* const unread = find_unread(SceneLanguage::kObj, "materials", key);
            const std::string what(key.substr(0, 40)), kind = "MTL " + what;
            if (unread == nullptr) {
                statements.warn_of_kind(kind, fmt::format("{}: is unknown, and is ignored", what));
            } else {
                statements.say_of_unread(kind, what + ": is ignored", *unread);
            }
        }
    }
    if (block) materials[block->name] = describe(*block);
    return block || is_empty;
}

}  // namespace latent::render
