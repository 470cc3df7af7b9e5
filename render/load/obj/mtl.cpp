#include "render/load/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "render/load/files/unread.h"
#include "render/load/obj/maps.h"
#include "render/load/obj/mtl_material.h"
#include "render/load/obj/statements.h"

namespace latent::render {

namespace {

constexpr double kIndex = 1.5;
constexpr std::string_view kMaps[] = {"map_Kd", "map_Ks", "map_Ke", "map_Ns",  "map_d", "map_Pr",
                                      "map_Pm", "map_Ps", "map_Pc", "map_Pcr", "norm",  "bump"};
constexpr std::string_view kProperties[] = {"Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr"};

template <std::size_t N>
bool is_among(const std::string_view (&words)[N], std::string_view word) {
    return std::ranges::find(words, word) != std::end(words);
}

// Other spellings of one map. Blender writes pictures of roughness, of the metallic share and of normals under names of its own.
std::string_view canonical(std::string_view keyword, bool is_blenders) {
    const bool is_bump = keyword == "bump" || keyword == "map_bump" || keyword == "map_Bump" || keyword == "Bump";
    if (is_bump) return is_blenders ? "norm" : "bump";
    if (keyword == "map_Kn" || keyword == "map_norm") return "norm";
    if (keyword == "map_opacity" || keyword == "map_D") return "map_d";
    if (is_blenders && keyword == "map_Ns") return "map_Pr";
    if (is_blenders && (keyword == "refl" || keyword == "map_refl")) return "map_Pm";
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

// The first word that should be a number and is none; none if there is no such word.
std::optional<std::string_view> malformed(const Statements& s) {
    const std::vector<std::string_view>& words = s.words();
    const std::string_view first = words.size() > 1 ? words[1] : std::string_view();
    const bool is_rgb = s.keyword() == "Kd" || s.keyword() == "Ks" || s.keyword() == "Ke" || s.keyword() == "Tf";
    if (is_rgb && (first == "spectral" || first == "xyz")) return std::nullopt;
    const std::size_t begin = first == "-halo" ? 2 : 1, end = is_rgb && words.size() > 3 ? 4 : begin + 1;
    for (std::size_t i = begin; i < end; ++i) {
        if (i >= words.size()) return "";
        if (!finite_number(words[i])) return words[i];
    }
    return std::nullopt;
}

void read_property(const Statements& s, MtlBlock& b) {
    const std::string_view key = s.keyword();
    if (const std::optional<std::string_view> word = malformed(s))
        return s.warn(fmt::format("{}: \"{}\" is not a finite number; the statement is ignored", key, word->substr(0, 40)));
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
    const bool is_blenders = text.starts_with("# Blender");
    std::optional<MtlBlock> block;
    bool is_empty = true;  // but for comments
    while (statements.next()) {
        is_empty = false;
        const std::string_view key = statements.keyword(), map_key = canonical(key, is_blenders);
        if (key == "newmtl") {
            if (block) materials[block->name] = describe(*block, target);
            block = MtlBlock{.place = statements.place(), .name = statements.rest(), .is_blenders = is_blenders};
        } else if (!block) {
            if (!is_among(kProperties, key) && !is_among(kMaps, map_key) &&
                find_unread(SceneLanguage::kObj, "materials", key) == nullptr)
                return false;
            statements.warn(fmt::format("{}: comes before any newmtl, and is ignored", key));
        } else if (is_among(kMaps, map_key)) {
            std::optional<MtlMap> map = read_map(statements, name, target.files);
            if (map_key == "map_Kd") block->lacks_map_kd = !map;
            if (map) block->maps.insert_or_assign(std::string(map_key), std::move(*map));
        } else if (is_blenders && key == "Ka") {
            block->ka = rgb_of(statements);
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
    if (block) materials[block->name] = describe(*block, target);
    return block || is_empty;
}

}  // namespace latent::render
