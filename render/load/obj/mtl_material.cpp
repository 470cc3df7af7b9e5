#include "render/load/obj/mtl_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/load/files/pictures.h"
#include "render/load/files/unread.h"

namespace latent::render {

namespace {

constexpr double kSheenRoughness = 0.3, kF0OfKs = 0.08;

double mean(const LinearRgb& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

// The roughness of facets, as Blender and assimp read Ns, and as Blender writes it.
double roughness_of(double ns) { return 1 - std::sqrt(std::min(ns, 1000.0) / 1000); }

// The body's colour. Where it is black or missing, its picture is all there is.
LinearRgb body_of(const MtlBlock& b) {
    const bool is_given = b.kd && (std::ranges::max(*b.kd) > 0 || !(b.has("map_Kd") || b.lacks_map_kd));
    return is_given ? *b.kd : b.has("map_Kd") ? LinearRgb{1, 1, 1} : LinearRgb{0.5, 0.5, 0.5};
}

// Without a factor, a map is taken as it is.
LinearRgb factor_of(const MtlBlock& b, const std::optional<LinearRgb>& factor, const char* map) {
    return factor ? *factor : b.has(map) ? LinearRgb{1, 1, 1} : LinearRgb{0, 0, 0};
}
LinearRgb ks_of(const MtlBlock& b) { return factor_of(b, b.ks, "map_Ks"); }

// By illum, light is mirrored as by a polished surface.
bool mirrors(const MtlBlock& b) { return b.illum == 3 || b.illum == 5 || b.illum == 8; }

// Blender writes an input of its Principled BSDF wherever MTL has something like it, and reads it from there: the roughness as Ns,
// and the metallic share as Ka if illum says that light is mirrored.
void translate_blenders(MtlBlock& b) {
    if (!b.roughness && !b.has("map_Pr")) b.roughness = roughness_of(b.ns);
    if (!b.metallic && !b.has("map_Pm")) b.metallic = b.illum >= 3 && b.illum <= 8 && b.ka ? std::min(mean(*b.ka), 1.0) : 0;
}

// Glass refracts. Maya writes illum 4 and an index of 1 for all that it has. Blender writes no illum for glass, but Tf with the PBR
// extension. Others write illum 9 for all that has a d below 1, which says how much of it is seen.
bool is_glass(const MtlBlock& b) {
    if (b.ni == 1 || b.has("map_Kd") || b.has("map_d")) return false;
    if (b.is_blenders) return b.tf && mean(*b.tf) >= 0.5;
    return b.illum == 4 || b.illum == 6 || b.illum == 7 || (b.illum == 9 && b.opacity == 1);
}
// Tf, or the hue of Kd.
LinearRgb tint_of_glass(const MtlBlock& b) {
    if (b.tf && !b.is_blenders) return *b.tf;
    const double most = b.kd ? std::ranges::max(*b.kd) : 0;
    return most > 0 ? LinearRgb{(*b.kd)[0] / most, (*b.kd)[1] / most, (*b.kd)[2] / most} : LinearRgb{1, 1, 1};
}

// How much of a surface is a metal of reflectance Ks. Where illum says that it mirrors: as far as Ks is brighter than Kd, or has a
// hue. Elsewhere exporters write both for plastic, too, and viewers show plastic: then Ks must have a hue, and Kd must be dark.
double metal_share(const MtlBlock& b, const LinearRgb& kd) {
    const LinearRgb mirror = ks_of(b);
    const double ks = std::ranges::max(mirror), brightest = std::max(ks, std::ranges::max(kd));
    if (b.illum < 2 || b.has("map_Kd") || brightest == 0) return 0;
    const double brighter = (ks - std::ranges::max(kd)) / brightest;
    const double hue = (ks - std::ranges::min(mirror)) / brightest / 0.2 - 1;  // 1 for copper, 2 for gold
    return std::clamp(mirrors(b) ? std::max(brighter, hue) : std::min(2 * brighter - 1, hue), 0.0, 1.0);
}

class Describer {
 public:
    Describer(const MtlBlock& block, const MtlTarget& target)
        : b(block), target_(target), values_(target.colors, target.textures) {}

    MtlMaterial operator()() {
        MtlMaterial out{.surface = is_glass(b) ? glass() : is_pbr() ? metallic_roughness() : phong()};
        out.surface.name = b.name;
        if (!is_glass(b)) out.alpha = alpha();
        describe_relief(out.surface);
        describe_emission(out);
        return out;
    }

 private:
    std::optional<TextureDescription> picture(const char* keyword) const {
        const auto found = b.maps.find(keyword);
        return found != b.maps.end() ? std::optional(found->second.texture) : std::nullopt;
    }
    FloatInput number(const char* map, double factor) {
        const auto found = b.maps.find(map);
        return values_.number(picture(map), found != b.maps.end() ? found->second.channel : PictureChannel::kMean, factor);
    }
    // Not said, it is 1 times its map, or `without`.
    FloatInput number(const char* map, const std::optional<double>& factor, double without) {
        return number(map, factor.value_or(b.has(map) ? 1 : without));
    }
    SpectrumInput body() { return values_.color(picture("map_Kd"), body_of(b), target_.by_vertex_color); }

    MaterialDescription glass() {
        MaterialDescription out{.type = "dielectric", .spectra = {{"eta", color::Spectrum::constant(b.ni)}}};
        const LinearRgb tint = tint_of_glass(b);
        if (tint != LinearRgb{1, 1, 1}) out.spectra["transmittance"] = target_.colors.reflectance(tint);
        return out;
    }

    // The PBR extension of MTL.
    bool is_pbr() const { return b.roughness || b.metallic || b.has("map_Pr") || b.has("map_Pm"); }
    MaterialDescription metallic_roughness() {
        MaterialDescription out{.type = "metallicroughness", .spectra = {{"base_color", body()}}};
        out.numbers = {{"roughness", number("map_Pr", b.roughness, 0.5)},
                       {"metallic", number("map_Pm", b.metallic, 0)},
                       {"coat", number("map_Pc", b.coat)},
                       {"coat_roughness", number("map_Pcr", b.coat_roughness)}};
        if (b.is_blenders) {
            set_specular(out);
        } else {
            const double root = (b.ni - 1) / (b.ni + 1);
            out.numbers["f0"] = static_cast<float>(root * root);
        }
        const double sheen = b.sheen.value_or(b.has("map_Ps") ? 1 : 0);
        if (sheen == 0) return out;
        out.type = "sheen";
        out.spectra["sheen.color"] = values_.color(picture("map_Ps"), {sheen, sheen, sheen});
        out.numbers["sheen.roughness"] = static_cast<float>(kSheenRoughness);
        return out;
    }

    // Kd, Ks and Ns.
    MaterialDescription phong() {
        const LinearRgb ks = ks_of(b);
        if (b.illum < 2 || std::ranges::max(ks) == 0) return {.spectra = {{"reflectance", body()}}};
        const double metallic = metal_share(b, body_of(b)), rough = mirrors(b) ? 1 - metallic : 1;
        SpectrumInput base = metallic < 1 ? body() : values_.color(picture("map_Ks"), ks);
        if (metallic > 0 && metallic < 1) base = values_.between(base, values_.color(picture("map_Ks"), ks), metallic);
        MaterialDescription out{.type = "metallicroughness", .spectra = {{"base_color", base}}};
        out.numbers = {{"metallic", static_cast<float>(metallic)},
                       // A picture of Ns leads from matt to it.
                       {"roughness", values_.between(rough, rough * roughness_of(b.ns), number("map_Ns", 1))}};
        set_specular(out);
        return out;
    }

    // What is not metal is a dielectric. A Ks of 0.5 stands for an index of 1.5; below it, reflection fades at all angles.
    void set_specular(MaterialDescription& out) {
        const double ks = mean(ks_of(b));
        out.numbers["f0"] = number("map_Ks", kF0OfKs * std::min(ks, 1.0));
        out.numbers["f90"] = number("map_Ks", std::min(2 * ks, 1.0));
    }

    // Some programs write d 0 or Tr 1 for what is opaque; an invisible material is never meant.
    FloatInput alpha() {
        if (b.opacity == 0)
            target_.diagnostics.warn_of_kind(
                "d 0", b.place, fmt::format("{}: d is 0 (or Tr is 1), which would hide all of it; it is opaque", b.name));
        const double opacity = b.opacity == 0 ? 1 : b.opacity;
        const auto color = b.maps.find("map_Kd");
        const bool has_alpha = !b.has("map_d") && color != b.maps.end() && color->second.alpha != AlphaUse::kUnused;
        const bool is_opacity = has_alpha && color->second.alpha == AlphaUse::kOpacity;
        if (has_alpha)
            target_.diagnostics.note_of_kind(
                is_opacity ? "alpha of map_Kd" : "other alpha of map_Kd", b.place,
                fmt::format("{}: has no map_d; the alpha of its map_Kd {}", b.name,
                            is_opacity ? "is its opacity" : "hides what looks like a picture, and is ignored"));
        return is_opacity ? values_.number(color->second.texture, PictureChannel::kAlpha, opacity) : number("map_d", opacity);
    }

    void describe_relief(MaterialDescription& surface) {
        const auto normals = b.maps.find("norm"), bump = b.maps.find("bump");
        const bool is_bump = normals == b.maps.end() && bump != b.maps.end();
        if (normals == b.maps.end() && !is_bump) return;
        const MtlMap& map = is_bump ? bump->second : normals->second;
        // Normal maps are found under "bump", too.
        const PictureDescription& file = map.texture.picture;
        const NormalUse use = is_bump ? normal_use(file.path, file.name) : NormalUse::kAsStored;
        if (use == NormalUse::kNothing)
            return target_.diagnostics.warn_of_kind(
                "bump", b.place,
                fmt::format("{}: bump: is ignored{}", b.name, why_unread(SceneLanguage::kObj, "materials", "bump")));
        surface.normal_map = values_.normal_map(map.texture, use == NormalUse::kAsSrgb);
        surface.normal_scale = static_cast<float>(map.strength);
        surface.normals_follow_v = true;
    }

    void describe_emission(MtlMaterial& out) {
        const LinearRgb ke = factor_of(b, b.ke, "map_Ke");
        Result<std::optional<AreaLightDescription>> emission = values_.emission(picture("map_Ke"), ke);
        if (!emission) return target_.diagnostics.warn(b.place, emission.error().message);
        if (!*emission) return;
        out.emission = std::move(*emission);
        out.emission->name = b.name;
        out.radiance = std::ranges::max(ke);
    }

    const MtlBlock& b;
    const MtlTarget& target_;
    ModelValues values_;
};

}  // namespace

MtlMaterial describe(MtlBlock block, const MtlTarget& target) {
    if (block.is_blenders) translate_blenders(block);
    return Describer(block, target)();
}

}  // namespace latent::render
