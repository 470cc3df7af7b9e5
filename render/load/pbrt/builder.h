// render/load/pbrt/builder.h: the graphics state: applies directives one after another and collects the scene they describe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/load/files/diagnostics.h"
#include "render/load/files/scene_files.h"
#include "render/load/mesh/placement.h"
#include "render/load/pbrt/attributes.h"
#include "render/load/pbrt/directive.h"
#include "render/load/pbrt/materials.h"
#include "render/load/pbrt/names.h"
#include "render/load/pbrt/options.h"
#include "render/load/pbrt/spectra.h"
#include "render/load/pbrt/textures.h"
#include "render/load/pbrt/transforms.h"

namespace latent::render {

class SceneBuilder {
 public:
    // `scene` is filled, but for its shapes, its rgb_spectra given; it, `files` and `diagnostics` outlive the builder.
    SceneBuilder(SceneDescription& scene, SceneFiles& files, Diagnostics& diagnostics, const PbrtUse& use);

    // Any directive but Include and Import.
    void apply(const Directive& directive);
    // After the last directive: unresolved names, missing ends.
    void finish(const SourceLocation& end);
    // After that, without errors: the shapes of the world, and those of each object.
    std::vector<LoadedShape> take_shapes() { return std::move(shapes_); }
    std::vector<std::vector<LoadedShape>> take_object_shapes() { return std::move(object_shapes_); }
    const SceneOptions& options() const { return options_; }

    // Import: what the file changes in the graphics state ends with it.
    void begin_import(const SourceLocation& where) { push("Import", where); }
    void end_import(const SourceLocation& where) { pop("Import", where); }
    bool in_world() const { return in_world_; }
    // Something could not be read, and the error is reported: what it would have defined is not missed once more.
    void set_incomplete() { is_incomplete_ = true; }

 private:
    struct State {
        CurrentTransform ctm;
        bool reverse_orientation = false;
        std::uint32_t material = 0;
        std::uint32_t area_light = kNone;
        std::uint32_t inside_medium = kNone, outside_medium = kNone;
        std::string color_space = "srgb";
        Attributes attributes;
    };
    struct Pushed {
        State state;
        std::string by;  // "AttributeBegin" ...
        SourceLocation where;
    };
    void push(const std::string& by, const SourceLocation& where);
    void pop(const std::string& by, const SourceLocation& where);
    bool apply_state(const Directive& d);
    void begin_world();
    void report(const std::vector<UndefinedName>& undefined);
    std::uint32_t material(const std::string& text, const SourceLocation& where);  // by name
    MaterialDescription read_mixture(const ParameterList& list);
    MaterialDescription whole(PbrtMaterial material);  // its two parts are added to the scene
    void add_material(const Directive& d);
    void add_medium(const Directive& d);
    MediumDescription read_sum(const ParameterList& list);
    void add_area_light(const Directive& d);
    void add_shape(const Directive& d);
    std::vector<LoadedShape>& moving_shapes(const SourceLocation& where);
    bool check_moving_instance(const SourceLocation& where);  // false: refused
    void begin_object(const Directive& d);
    void add_instance(const Directive& d);
    std::uint32_t object(const std::string& text, const SourceLocation& where);
    ParameterList list(const Directive& d, std::string_view target);
    std::uint32_t medium(const std::string& text, const SourceLocation& where);
    // An error, if the current transformation moves.
    void refuse_motion(const SourceLocation& where, const std::string& what);

    SceneDescription& scene_;
    SceneFiles& files_;
    Diagnostics& diagnostics_;
    SceneSpectra spectra_;
    SceneTextures textures_;
    State state_;
    std::vector<Pushed> stack_;
    SceneOptions options_;
    Transforms transforms_;
    Names materials_, media_, objects_;
    struct Mixture {
        SourceLocation where;
        std::array<std::uint32_t, 2> mixed;
    };
    std::vector<Mixture> mixtures_;
    std::vector<LoadedShape> shapes_;                      // those of the world
    std::vector<std::vector<LoadedShape>> object_shapes_;  // those of each object
    struct MaterialUse {
        bool is_interface = false;
        std::uint32_t inside = kNone;  // medium of whatever is made of it
    };
    std::vector<MaterialUse> uses_;                                        // how each material is used
    std::uint32_t object_ = kNone;                                         // that is being defined
    std::vector<std::pair<std::uint32_t, SourceLocation>> with_tangents_;  // "S" of shapes, and their materials
    bool is_incomplete_ = false;                                           // something could not be read
    const bool is_addition_;                                               // PbrtUse
    bool in_world_ = false, is_world_supposed_ = false;
};

}  // namespace latent::render
