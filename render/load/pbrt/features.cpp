#include "render/load/pbrt/features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/near_names.h"
#include "render/load/files/unread.h"
#include "render/load/pbrt/materials.h"

namespace latent::render {

std::span<const PbrtFeature> pbrt_features() {
    static const PbrtFeature features[] = {
        {"Camera", {"perspective", "orthographic", "spherical"}},
        {"Film", {"rgb"}},
        {"Integrator", {"path", "volpath", "bdpt"}},
        {"ColorSpace", {"srgb", "dci-p3", "rec2020", "aces2065-1"}},
        {"Shape", {"trianglemesh", "plymesh", "bilinearmesh", "loopsubdiv", "curve", "sphere", "disk", "cylinder"}},
        {"Material", material_types()},
        {"Texture",
         {"constant", "scale", "mix", "imagemap", "checkerboard", "dots", "bilerp", "directionmix", "fbm", "wrinkled", "windy",
          "marble", "latent:vertexcolor", "latent:marble", "latent:wood", "latent:clouds"}},
        {"LightSource", {"point", "spot", "goniometric", "projection", "distant", "infinite"}},
        {"AreaLightSource", {"diffuse"}},
        {"Medium", {"homogeneous", "uniformgrid", "rgbgrid", "cloud", "nanovdb", "latent:sum"}},
    };
    return features;
}

std::span<const PbrtFeature> pbrt_replacements() {
    static const PbrtFeature replacements[] = {
        {"Film", {"gbuffer", "spectral"}},
        {"Integrator", {"simplepath", "simplevolpath", "mlt", "sppm"}},
    };
    return replacements;
}

bool is_among(std::span<const PbrtFeature> features, std::string_view directive, std::string_view type) {
    return std::ranges::any_of(features, [&](const PbrtFeature& feature) {
        return feature.directive == directive && std::ranges::count(feature.types, type) > 0;
    });
}

std::span<const PbrtFeature> pbrt_extensions() {
    static const PbrtFeature extensions[] = {
        {"Camera", {"latent:focaldistances", "latent:lensshift"}},
        {"LightSource", {"name", "latent:illuminant"}},
        {"AreaLightSource", {"name", "latent:exponent", "latent:illuminant"}},
        {"Material", {"latent:amount", "latent:lobe", "latent:multiscatter"}},
        {"Texture", {"filter \"latent:quartic\""}},
        {"Medium", {"latent:media"}},
        {"any spectrum", {"latent:daylight"}},
    };
    return extensions;
}

std::string types_of(std::string_view directive) {
    const auto found = std::ranges::find(pbrt_features(), directive, &PbrtFeature::directive);
    return fmt::format("{}", fmt::join(found->types, ", "));
}

std::string near_types(std::string_view directive, std::string_view type) {
    const auto found = std::ranges::find(pbrt_features(), directive, &PbrtFeature::directive);
    const std::string near = near_names(type, std::vector<std::string>(found->types.begin(), found->types.end()));
    return near.empty() ? "" : fmt::format("; did you mean {}?", near);
}

std::string why_unread_type(std::string_view directive, std::string_view type) {
    const std::string kind = fmt::format("{} type", directive), why = why_unread(SceneLanguage::kPbrtV4, kind, type);
    return why.empty() ? why_unread(SceneLanguage::kPbrtV3, kind, type) : why;
}

std::string unsupported(std::string_view directive, std::string_view type) {
    return fmt::format("{} \"{}\" is not supported{} ({}){}", directive, type, near_types(directive, type), types_of(directive),
                       why_unread_type(directive, type));
}

}  // namespace latent::render
