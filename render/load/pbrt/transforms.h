// render/load/pbrt/transforms.h: the directives that change the current transformation.
#pragma once

#include <map>
#include <string>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"
#include "render/math/vec.h"

namespace latent::render {

class Transforms {
 public:
    // False, and nothing is done, unless `d` is such a directive.
    bool apply(const Directive& d, Affined& ctm, Diagnostics& diagnostics);
    // A coordinate system that has a name without a directive: "camera", "world".
    void name(const std::string& text, const Affined& map) { named_[text] = map; }

 private:
    std::map<std::string, Affined> named_;
};

}  // namespace latent::render
