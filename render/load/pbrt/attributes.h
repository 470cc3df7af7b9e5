// render/load/pbrt/attributes.h: the parameters that Attribute directives add to later ones.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"

namespace latent::render {

class Attributes {
 public:
    void add(const Directive& attribute, Diagnostics& diagnostics);
    // For directives about "shape", "light", "material", "medium" or "texture".
    const std::vector<Parameter>& of(std::string_view target) const;

 private:
    std::map<std::string, std::vector<Parameter>, std::less<>> inherited_;  // by target
};

}  // namespace latent::render
