// render/load/pbrt/transforms.h: the current transformation, and the directives that change it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"
#include "render/load/pbrt/names.h"
#include "render/math/vec.h"

namespace latent::render {

// At the start and at the end of the motion; directives change those that are active.
struct CurrentTransform {
    Affined start{}, end{};
    bool start_active = true, end_active = true;

    bool moves() const { return start != end; }
};

class Transforms {
 public:
    // False, and nothing is done, unless `d` is such a directive.
    bool apply(const Directive& d, CurrentTransform& ctm, Diagnostics& diagnostics);
    // A coordinate system that has a name without a directive: "camera", "world".
    void name(const std::string& text, const Affined& start, const Affined& end) { named_[text] = {start, end}; }
    // Adds the coordinate systems that directives asked for before they had a name.
    void add_undefined(std::vector<UndefinedName>& names) const { names.insert(names.end(), undefined_.begin(), undefined_.end()); }

 private:
    // Both at once. False: not a directive of that kind.
    bool apply_to_both(const Directive& d, CurrentTransform& ctm, Diagnostics& diagnostics);

    std::map<std::string, CurrentTransform> named_;
    std::vector<UndefinedName> undefined_;
};

}  // namespace latent::render
