// render/load/pbrt/from_v3.h: scenes for pbrt-v3: each directive as pbrt-v4 has it, about as `pbrt --upgrade` writes it.
// docs/scenes.md, "Scenes for pbrt-v3".
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/load/pbrt/directive.h"

namespace latent::render {

// Whether it has a type that pbrt-v3 has and pbrt-v4 has not: Film "image".
bool is_of_pbrt_v3(const Directive& d);

class FromPbrtV3 {
 public:
    explicit FromPbrtV3(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    // In the order of the file. None: pbrt-v4 has no use for it.
    std::vector<Directive> translate(Directive d);

 private:
    bool rewrite(Directive& d);  // false: none
    void film(Directive& d) const;
    void integrator(Directive& d) const;
    void light(Directive& d) const;
    void shape(Directive& d) const;
    void texture(Directive& d);
    void scale_texture(Directive& d) const;
    // Returns the share of the surface that is there, if that is not all.
    std::optional<double> material(std::string& type, Directive& d) const;
    void mixture(Directive& d) const;
    void translucent(Directive& d) const;
    void disney(Directive& d) const;

    // The name that stands for `name` from now on: pbrt-v3 allows to define it again.
    std::string define(const std::string& kind, const std::string& name);
    std::string current(const std::string& kind, const std::string& name) const;
    // Parameters that pbrt-v4 lacks; of a material, unless they have the value that changes nothing.
    void drop_unread(Directive& d) const;
    void drop(Directive& d, std::string_view material, std::initializer_list<std::string_view> names, double harmless) const;

    struct Known {
        int count = 0;  // definitions
        std::optional<double> opacity{};
    };
    Diagnostics& diagnostics_;
    std::map<std::pair<std::string, std::string>, Known> names_;  // by kind and name
    int kept_transforms_ = 0;                                     // by TransformBegin
    std::optional<double> opacity_;                               // the current material's
    std::vector<std::optional<double>> opacities_;                // those that come back when a block ends
};

}  // namespace latent::render
