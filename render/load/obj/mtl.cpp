#include "render/load/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/load/obj/statements.h"

namespace latent::render {

namespace {

// A newmtl block as it stands.
struct Block {
    std::string place, name;
    LinearRgb kd{0.5, 0.5, 0.5}, ks{0, 0, 0}, ke{0, 0, 0};
    double ns = 20, ni = 1.5, opacity = 1;
    int illum = 2;
    std::optional<double> roughness{}, metallic{};
    double coat = 0, coat_roughness = 0;
    std::uint32_t kd_texture = kNone, opacity_texture = kNone;
};

constexpr std::string_view kIgnored[] = {"Ka", "Tf", "Ps", "aniso", "anisor", "sharpness", "xyz", "spectral"};

LinearRgb rgb_of(const Statements& s) {
    if (s.words().size() > 1 && (s.words()[1] == "spectral" || s.words()[1] == "xyz")) {
        s.error(fmt::format("{}: only rgb values are supported", s.keyword()));
        return {};
    }
    LinearRgb rgb;
    for (std::size_t i = 0; i < 3; ++i) rgb[i] = s.number(s.words().size() > 3 ? i + 1 : 1);  // one number stands for all
    for (double& x : rgb) {
        if (x < 0) s.error(fmt::format("{}: must not be negative", s.keyword()));
        x = std::max(x, 0.0);
    }
    return rgb;
}

double number_within(const Statements& s, double low, double high) {
    const double x = s.number(1);
    if (!(x >= low && x <= high)) s.error(fmt::format("{}: must be from {} to {}", s.keyword(), low, high));
    return std::clamp(x, low, high);
}

// Which of the closures comes nearest. Transparency first, then what only metallic-roughness has, then mirrors, then Phong's lobe.
MtlMaterial described(const Block& b, const ModelColors& colors, Diagnostics& diagnostics) {
    MtlMaterial out;
    MaterialDescription& surface = out.surface;
    surface.name = b.name;
    const auto mapped = [&](const LinearRgb& rgb) {
        SpectrumInput input = colors.reflectance(rgb);
        input.texture = b.kd_texture;
        return input;
    };
    const bool is_glass =
                   b.illum == 4 || b.illum == 6 || b.illum == 7 || b.illum == 9 || (b.opacity < 0.5 && b.opacity_texture == kNone),
               is_mirror = b.illum == 3 || b.illum == 5 || b.illum == 8;
    if (is_glass) {
        surface.type = "dielectric";
        surface.spectra = {{"eta", color::Spectrum::constant(b.ni)}};
    } else if (b.roughness || b.metallic) {
        const double root = (b.ni - 1) / (b.ni + 1);
        surface.type = "metallicroughness";
        surface.spectra = {{"base_color", mapped(b.kd)}};
        surface.numbers = {{"roughness", static_cast<float>(b.roughness.value_or(0.5))},
                           {"metallic", static_cast<float>(b.metallic.value_or(0))},
                           {"f0", static_cast<float>(root * root)},
                           {"coat", static_cast<float>(b.coat)},
                           {"coat_roughness", static_cast<float>(b.coat_roughness)}};
    } else if (is_mirror && std::ranges::max(b.ks) > 0) {
        surface.type = "metallicroughness";
        surface.spectra = {{"base_color", colors.reflectance(b.ks)}};
        surface.numbers = {{"metallic", 1.0f}, {"roughness", 0.0f}};
    } else if (std::ranges::max(b.ks) > 0 && b.illum >= 2) {
        double most = 0;
        for (std::size_t i = 0; i < 3; ++i) most = std::max(most, b.kd[i] + b.ks[i]);
        const double share = 1 / std::max(most, 1.0);
        if (share < 1)
            diagnostics.warn(b.place,
                             fmt::format("{}: Kd + Ks exceeds 1; both are scaled by {:.3f} to conserve energy", b.name, share));
        surface.type = "phong";
        surface.spectra = {{"Kd", mapped({b.kd[0] * share, b.kd[1] * share, b.kd[2] * share})},
                           {"Ks", colors.reflectance({b.ks[0] * share, b.ks[1] * share, b.ks[2] * share})}};
        surface.numbers = {{"exponent", static_cast<float>(b.ns)}};
    } else {
        surface.spectra = {{"reflectance", mapped(b.kd)}};
    }
    if (!is_glass) {
        out.alpha = static_cast<float>(b.opacity);
        out.alpha.texture = b.opacity_texture;
    }
    out.radiance = std::ranges::max(b.ke);
    if (out.radiance > 0) out.emission = AreaLightDescription{.spectrum = colors.emission(b.ke), .name = b.name};
    return out;
}

void read_property(const Statements& s, Block& b) {
    const std::string_view key = s.keyword();
    if (key == "Kd") {
        b.kd = rgb_of(s);
    } else if (key == "Ks") {
        b.ks = rgb_of(s);
    } else if (key == "Ke") {
        b.ke = rgb_of(s);
    } else if (key == "Ns") {
        b.ns = number_within(s, 0, 1e5);
    } else if (key == "Ni") {
        b.ni = number_within(s, 1e-3, 1e3);
    } else if (key == "d") {
        b.opacity = s.words().size() > 1 && s.words()[1] == "-halo" ? s.number(2) : number_within(s, 0, 1);
    } else if (key == "Tr") {
        b.opacity = 1 - number_within(s, 0, 1);
    } else if (key == "illum") {
        b.illum = static_cast<int>(number_within(s, 0, 10));
    } else if (key == "Pr") {
        b.roughness = number_within(s, 0, 1);
    } else if (key == "Pm") {
        b.metallic = number_within(s, 0, 1);
    } else if (key == "Pc") {
        b.coat = number_within(s, 0, 1);
    } else if (key == "Pcr") {
        b.coat_roughness = number_within(s, 0, 1);
    } else if (key.starts_with("map_") || key.starts_with("bump") || key == "norm" || key == "disp" || key == "decal" ||
               key == "refl") {
        s.warn(fmt::format("{}: is ignored", key));
    } else if (std::ranges::find(kIgnored, key) == std::end(kIgnored)) {
        s.warn(fmt::format("{}: is unknown, and is ignored", key));
    }
}

// "map_Kd -s 2 2 wood.png", a colour, or a number: the index of the texture, kNone with an error.
std::uint32_t read_map(const Statements& s, bool is_spectrum, const SceneFiles& files, std::vector<TextureDescription>& textures) {
    if (s.words().size() < 2) {
        s.error(fmt::format("{}: the file is missing", s.keyword()));
        return kNone;
    }
    const bool has_options = s.words()[1].starts_with('-');
    if (has_options) s.warn(fmt::format("{}: its options are ignored", s.keyword()));
    const std::string name = has_options ? std::string(s.words().back()) : s.rest();
    const Result<Hash128> content = files.hash(name);
    if (!content) {
        s.error(content.error().message);
        return kNone;
    }
    TextureDescription texture{.kind = TextureKind::kImage, .is_spectrum = is_spectrum};
    texture.picture.is_srgb = is_spectrum;
    texture.picture.path = files.resolve(name).string();
    texture.picture.name = s.place() + ": " + texture.picture.path;
    texture.picture.content = *content;
    texture.picture.filter = TextureFilter::kTrilinear;
    textures.push_back(std::move(texture));
    return static_cast<std::uint32_t>(textures.size() - 1);
}

}  // namespace

void read_mtl(std::string_view text, const std::string& name, const SceneFiles& files, const ModelColors& colors,
              Diagnostics& diagnostics, MtlMaterials& materials, std::vector<TextureDescription>& textures) {
    Statements statements(text, name, diagnostics);
    std::optional<Block> block;
    const auto finish = [&] {
        if (!block) return;
        // The map is scaled by Kd; where that is black, the map is all there is.
        const double scale = std::ranges::max(block->kd);
        if (block->kd_texture != kNone) textures[block->kd_texture].picture.scale = scale > 0 ? scale : 1;
        if (block->opacity_texture != kNone) textures[block->opacity_texture].picture.scale = block->opacity;
        materials[block->name] = described(*block, colors, diagnostics);
    };
    while (statements.next()) {
        if (statements.keyword() == "newmtl") {
            finish();
            block = Block{.place = statements.place(), .name = statements.rest()};
        } else if (block && statements.keyword() == "map_Kd") {
            block->kd_texture = read_map(statements, true, files, textures);
        } else if (block && statements.keyword() == "map_d") {
            block->opacity_texture = read_map(statements, false, files, textures);
        } else if (block) {
            read_property(statements, *block);
        } else {
            statements.error(fmt::format("{}: comes before any newmtl", statements.keyword()));
        }
    }
    finish();
}

}  // namespace latent::render
