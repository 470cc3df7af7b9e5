// render/load/pbrt/features.h: the features of pbrt-v4's format that are read, and those beyond it, for messages and lists.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace latent::render {

// The types of a directive: Material "diffuse".
struct PbrtFeature {
    std::string_view directive;
    std::vector<std::string_view> types;
};
std::span<const PbrtFeature> pbrt_features();
// Types that are accepted, with a note, and replaced: Integrator "mlt".
std::span<const PbrtFeature> pbrt_replacements();
// Whether the type of a directive is among them.
bool is_among(std::span<const PbrtFeature> features, std::string_view directive, std::string_view type);
// What may be said within a directive that pbrt-v4 does not know: parameters, types and values of parameters.
std::span<const PbrtFeature> pbrt_extensions();

// "diffuse, conductor" of "Material".
std::string types_of(std::string_view directive);
// "; did you mean conductor?", or nothing.
std::string near_types(std::string_view directive, std::string_view type);
// ": use what is like it", or nothing.
std::string why_unread_type(std::string_view directive, std::string_view type);
// "Material "conducter" is not supported; did you mean conductor? (diffuse, conductor)".
std::string unsupported(std::string_view directive, std::string_view type);

}  // namespace latent::render
