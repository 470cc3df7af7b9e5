#include "render/load/list_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>
#include <vector>

#include "render/load/gltf/extensions.h"
#include "render/load/pbrt/features.h"

namespace latent::render {

namespace {

// "  NAME  words", wrapped at 80 columns.
template <class Words>
std::string paragraph(std::string_view name, const Words& words) {
    constexpr std::size_t kIndent = 18, kWidth = 80;
    std::string text, line = fmt::format("  {:<16}", name);
    for (const std::string_view word : words) {
        if (line.size() + 1 + word.size() > kWidth) {
            text += line + "\n";
            line = std::string(kIndent, ' ');
        }
        if (line.size() > kIndent) line += ' ';
        line += word;
    }
    return text + line + "\n";
}

}  // namespace

std::string list_features() {
    std::string text = "pbrt-v4 (.pbrt; pbrt-v3: docs/scenes.md, \"Scenes for pbrt-v3\")\n", own_types, parameters, replaced;
    const auto is_of_pbrt = [](std::string_view type) { return type != "phong" && !type.starts_with("latent:"); };
    for (const PbrtFeature& feature : pbrt_features()) {
        std::vector<std::string_view> of_pbrt, own;
        for (const std::string_view type : feature.types) (is_of_pbrt(type) ? of_pbrt : own).push_back(type);
        text += paragraph(feature.directive, of_pbrt);
        if (!own.empty()) own_types += paragraph(feature.directive, own);
    }
    for (const PbrtFeature& feature : pbrt_replacements()) replaced += paragraph(feature.directive, feature.types);
    for (const PbrtFeature& extension : pbrt_extensions()) parameters += paragraph(extension.directive, extension.types);
    text += "\nreplaced, with a warning: films by rgb, integrators by path\n" + replaced;
    text += "\ntypes beyond pbrt-v4 (docs/scenes.md, \"Extensions\")\n" + own_types;
    text += "\nparameters, and values of parameters, beyond pbrt-v4\n" + parameters;
    text += "\nglTF 2.0 (.gltf, .glb)\n" + paragraph("extensions", known_extensions());
    text += "\nWavefront OBJ (.obj, .mtl)\n";
    using Words = std::initializer_list<std::string_view>;
    text += paragraph("geometry", Words{"v", "vt", "vn", "f", "s", "mtllib", "usemtl"});
    text += paragraph("materials",
                      Words{"newmtl", "Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr"});
    text += paragraph("maps", Words{"map_Kd", "map_Ks", "map_Ke", "map_Ns", "map_d", "map_Pr", "map_Pm", "map_Ps", "map_Pc",
                                    "map_Pcr", "norm", "map_bump"});
    return text;
}

}  // namespace latent::render
