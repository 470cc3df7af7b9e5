#include "render/load/pbrt/attributes.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::render {

namespace {

// Parameters that would change everything that inherits them.
constexpr std::string_view kEverywhere[] = {"emissionfilename", "portal"};

constexpr std::string_view kTargets[] = {"shape", "light", "material", "medium", "texture"};

}  // namespace

void Attributes::add(const Directive& attribute, Diagnostics& diagnostics) {
    const std::string& target = attribute.strings[0];
    if (std::ranges::find(kTargets, target) == std::end(kTargets))
        diagnostics.error(attribute.where,
                          fmt::format("Attribute \"{}\": not one of shape, light, material, medium, texture", target));
    for (Parameter p : attribute.parameters) {
        if (std::ranges::find(kEverywhere, p.name) != std::end(kEverywhere))
            diagnostics.error(p.where, fmt::format("\"{} {}\" is not supported", p.type, p.name));
        std::vector<Parameter>& inherited = inherited_[target];
        if (std::ranges::find(inherited, p.name, &Parameter::name) != inherited.end())
            diagnostics.error(p.where, fmt::format("Attribute: \"{}\" is already inherited, and cannot be changed again", p.name));
        p.inherited = true;
        inherited.push_back(std::move(p));
    }
}

const std::vector<Parameter>& Attributes::of(std::string_view target) const {
    static const std::vector<Parameter> none;
    const auto found = inherited_.find(target);
    return found == inherited_.end() ? none : found->second;
}

}  // namespace latent::render
