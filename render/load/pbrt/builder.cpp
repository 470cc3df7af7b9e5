#include "render/load/pbrt/builder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "render/load/pbrt/features.h"
#include "render/load/pbrt/lights.h"
#include "render/load/pbrt/media.h"
#include "render/load/pbrt/shapes.h"
#include "render/load/pbrt/subsurface.h"
#include "render/scene/check.h"
#include "render/scene/hair.h"

namespace latent::render {

namespace {

// Whether the inverse of this makes things too small to be computed with.
bool is_tiny(const Affined& object_from_world) {
    return std::max({max_abs(object_from_world.x), max_abs(object_from_world.y), max_abs(object_from_world.z)}) > 1e15;
}

}  // namespace

SceneBuilder::SceneBuilder(SceneDescription& scene, SceneFiles& files, Diagnostics& diagnostics, const PbrtUse& use)
    : scene_(scene),
      files_(files),
      diagnostics_(diagnostics),
      spectra_(files, scene.rgb_spectra),
      textures_(scene, files, spectra_, diagnostics),
      options_(scene, diagnostics, use),
      is_addition_(use.is_addition) {
    scene.materials.push_back(
        {.spectra = {{"reflectance", color::Spectrum::constant(0.5)}}});  // what shapes are made of before any Material
    uses_.emplace_back();
}

ParameterList SceneBuilder::list(const Directive& d, std::string_view target) {
    spectra_.set_color_space(state_.color_space);
    return {d, state_.attributes.of(target), diagnostics_};
}

void SceneBuilder::push(const std::string& by, const SourceLocation& where) { stack_.push_back({state_, by, where}); }

void SceneBuilder::pop(const std::string& by, const SourceLocation& where) {
    if (stack_.empty())
        return diagnostics_.error(where,
                                  fmt::format("{} has nothing to end", by == "Import" ? by : by.substr(0, by.size() - 5) + "End"));
    if (stack_.back().by != by)
        diagnostics_.error(where, fmt::format("{} from line {} is still open here", stack_.back().by, stack_.back().where.line));
    state_ = std::move(stack_.back().state);
    stack_.pop_back();
}

std::uint32_t SceneBuilder::medium(const std::string& text, const SourceLocation& where) {
    if (text.empty()) return kNone;
    const std::uint32_t index = media_.mention(text, where, scene_.media.size());
    if (index == scene_.media.size()) scene_.media.push_back({.name = text, .location = where});
    return index;
}

void SceneBuilder::refuse_motion(const SourceLocation& where, const std::string& what) {
    if (state_.ctm.moves()) diagnostics_.error(where, what + ", but its transformation differs between StartTime and EndTime");
}

void SceneBuilder::apply(const Directive& d) {
    if (d.name == "Camera" && !in_world_) {
        const std::optional<Affined> start = state_.ctm.start.inverse(), end = state_.ctm.end.inverse();
        if (start && end) transforms_.name("camera", *start, *end);
    }
    if (transforms_.apply(d, state_.ctm, diagnostics_) ||
        options_.apply(d, in_world_ && !is_world_supposed_, state_.ctm, state_.outside_medium) || apply_state(d))
        return;
    if (!in_world_ && d.name != "MakeNamedMedium") {
        const bool is_world_alone = is_addition_ && !options_.has_camera();
        if (!is_incomplete_ && !is_world_alone) return diagnostics_.error(d.where, d.name + ": must come after WorldBegin");
        const CurrentTransform ctm = state_.ctm;
        begin_world();
        if (is_world_alone) state_.ctm = ctm;
        is_world_supposed_ = !is_world_alone;  // WorldBegin may be what is lost
    }
    if (d.name == "Material" || d.name == "MakeNamedMaterial") return add_material(d);
    if (d.name == "MakeNamedMedium") return add_medium(d);
    if (d.name == "AreaLightSource") return add_area_light(d);
    if (d.name == "Shape") return add_shape(d);
    if (d.name == "ObjectBegin") return begin_object(d);
    if (d.name == "ObjectInstance") return add_instance(d);
    if (d.name == "LightSource") {
        refuse_motion(d.where, "LightSource: lights cannot move");
        if (!state_.ctm.start.inverse()) diagnostics_.error(d.where, "LightSource: the transformation is singular");
        LightDescription light = read_light(d.strings[0], list(d, "light"), spectra_, files_);
        light.world_from_light = state_.ctm.start;
        light.medium = state_.outside_medium;
        scene_.lights.push_back(std::move(light));
        return;
    }
    textures_.define(d, state_.attributes.of("texture"), state_.ctm, state_.color_space);  // what is left is Texture
}

void SceneBuilder::begin_world() {
    options_.place_camera(state_.ctm, state_.outside_medium);
    in_world_ = true;
    state_.ctm = {};
    transforms_.name("world", {}, {});
}

bool SceneBuilder::apply_state(const Directive& d) {
    if (d.name == "AttributeBegin" || d.name == "TransformBegin") {
        push(d.name, d.where);
    } else if (d.name == "AttributeEnd" || d.name == "TransformEnd") {
        pop(d.name == "AttributeEnd" ? "AttributeBegin" : "TransformBegin", d.where);
    } else if (d.name == "ObjectEnd") {
        pop("ObjectBegin", d.where);
        object_ = kNone;
    } else if (d.name == "WorldBegin" && in_world_ && !is_world_supposed_) {
        diagnostics_.error(d.where, "WorldBegin: given twice");
    } else if (d.name == "WorldBegin") {
        begin_world();
        is_world_supposed_ = false;
    } else if (d.name == "ReverseOrientation") {
        state_.reverse_orientation = !state_.reverse_orientation;
    } else if (d.name == "NamedMaterial") {
        state_.material = material(d.strings[0], d.where);
    } else if (d.name == "MediumInterface") {
        state_.inside_medium = medium(d.strings.front(), d.where);
        state_.outside_medium = medium(d.strings.back(), d.where);
    } else if (d.name == "ColorSpace") {
        if (!spectra_.set_color_space(d.strings[0])) {
            diagnostics_.error(d.where, unsupported("ColorSpace", d.strings[0]));
        } else {
            state_.color_space = d.strings[0];
        }
    } else if (d.name == "Attribute") {
        state_.attributes.add(d, diagnostics_);
    } else {
        return false;
    }
    return true;
}

std::uint32_t SceneBuilder::material(const std::string& text, const SourceLocation& where) {
    const std::uint32_t index = materials_.mention(text, where, scene_.materials.size());
    if (index == scene_.materials.size()) {
        scene_.materials.push_back({.name = text, .location = where});
        uses_.emplace_back();
    }
    return index;
}

MaterialDescription SceneBuilder::read_mixture(const ParameterList& list) {
    MaterialDescription mixture{.type = "mix", .location = list.directive().where};
    mixture.numbers["amount"] = textures_.number(list, "amount", 0.5, 0, 1);
    if (const auto selector = textures_.find_spectrum(list, "latent:amount", SpectrumRole::kReflectance)) {
        if (list.find("amount", {"float", "integer", "texture"}) != nullptr)
            list.error("amount and latent:amount cannot be combined");
        if (!selector->is_textured() && selector->value.max_value() > 1) list.error("latent:amount: exceeds 1");
        mixture.spectra["selector"] = *selector;
    }
    const Parameter* names = list.find("materials", {"string"});
    if (names == nullptr || names->strings.size() != 2) {
        list.error("materials: must be the names of two materials");
    } else {
        for (std::size_t i = 0; i < 2; ++i) mixture.mixed[i] = material(names->strings[i], names->where);
        mixtures_.push_back({names->where, mixture.mixed});
    }
    list.report_unused();
    return mixture;
}

MaterialDescription SceneBuilder::whole(PbrtMaterial material) {
    if (!material.second) return std::move(material.surface);
    const auto first = static_cast<std::uint32_t>(scene_.materials.size());
    MaterialDescription mixture{.type = "mix",
                                .numbers = {{"amount", material.second_share}},
                                .mixed = {first, first + 1},
                                .location = material.surface.location};
    for (MaterialDescription* part : {&material.surface, &*material.second}) {
        scene_.materials.push_back(std::move(*part));
        uses_.emplace_back();
    }
    return mixture;
}

void SceneBuilder::add_material(const Directive& d) {
    const ParameterList parameters = list(d, "material");
    const bool has_name = d.name == "MakeNamedMaterial";
    const std::optional<std::string> type = has_name ? parameters.string("type") : d.strings[0];
    if (!type) parameters.error("MakeNamedMaterial: \"string type\" is missing");
    std::optional<PbrtMaterial> material;
    MaterialUse use{.is_interface = type && is_interface(*type)};
    if (type == "subsurface") {  // before the surface, which reports parameters that nothing reads
        use.inside = static_cast<std::uint32_t>(scene_.media.size());
        scene_.media.push_back(read_subsurface(parameters, textures_));
    }
    if (type)
        material = *type == "mix" ? PbrtMaterial{read_mixture(parameters)} : read_material(*type, parameters, textures_, files_);
    std::uint32_t index = static_cast<std::uint32_t>(scene_.materials.size());
    if (has_name) {
        index = materials_.mention(d.strings[0], d.where, index);
        if (!materials_.define(d.strings[0], d.name, d.where, diagnostics_)) return;
    }
    if (index == scene_.materials.size()) {
        scene_.materials.emplace_back();
        uses_.emplace_back();
    }
    uses_[index] = use;
    MaterialDescription read = material ? whole(std::move(*material)) : MaterialDescription{.location = d.where};
    scene_.materials[index] = std::move(read);
    scene_.materials[index].name = has_name ? d.strings[0] : "";
    if (!has_name) state_.material = index;
}

MediumDescription SceneBuilder::read_sum(const ParameterList& list) {
    MediumDescription sum{.location = list.directive().where};
    const Parameter* names = list.find("latent:media", {"string"});
    if (names == nullptr || names->strings.size() != 2 || names->strings[0].empty() || names->strings[1].empty()) {
        list.error(fmt::format("medium \"{}\": latent:media: must be the names of two media", list.directive().strings[0]));
    } else {
        for (std::size_t i = 0; i < 2; ++i) sum.summed[i] = medium(names->strings[i], names->where);
    }
    list.report_unused();
    return sum;
}

void SceneBuilder::add_medium(const Directive& d) {
    const ParameterList parameters = list(d, "medium");
    const std::optional<std::string> type = parameters.string("type");
    if (!type) parameters.error("MakeNamedMedium: \"string type\" is missing");
    MediumDescription read;
    if (type)
        read = *type == "latent:sum" ? read_sum(parameters) : read_medium(*type, parameters, state_.ctm.start, spectra_, files_);
    if (!std::holds_alternative<UniformVolume>(read.volume))
        refuse_motion(d.where, fmt::format("MakeNamedMedium: a medium of type \"{}\" cannot move", type.value_or("")));
    const std::uint32_t index = medium(d.strings[0], d.where);
    if (index == kNone) return parameters.error("MakeNamedMedium: the name is empty");
    if (!media_.define(d.strings[0], d.name, d.where, diagnostics_)) return;
    scene_.media[index] = std::move(read);
    scene_.media[index].name = d.strings[0];
}

void SceneBuilder::add_area_light(const Directive& d) {
    state_.area_light = static_cast<std::uint32_t>(scene_.area_lights.size());
    scene_.area_lights.push_back(read_area_light(d.strings[0], list(d, "light"), spectra_, textures_, files_));
}

void SceneBuilder::add_shape(const Directive& d) {
    const ParameterList parameters = list(d, "shape");
    const bool is_mesh = d.strings[0] != "sphere" && d.strings[0] != "disk" && d.strings[0] != "cylinder";
    const CurrentTransform& ctm = state_.ctm;
    if (!ctm.moves() && !ctm.start.inverse() && !is_mesh) {
        return parameters.warn(fmt::format("Shape: the {} is left out, since its transformation is singular", d.strings[0]));
    }
    if (const Parameter* s = parameters.find("S", {"vector3"})) with_tangents_.emplace_back(state_.material, s->where);
    // What moves is an object of its own.
    std::vector<LoadedShape>& shapes = ctm.moves() ? moving_shapes(d.where) : object_ == kNone ? shapes_ : object_shapes_[object_];
    const Affined map = ctm.moves() ? Affined{} : ctm.start;
    const bool emits = state_.area_light != kNone;
    for (LoadedShape& loaded : read_shape(d.strings[0], parameters, map, state_.reverse_orientation, emits, textures_, files_)) {
        ShapeDescription& shape = loaded.shape;
        shape.material = state_.material;
        shape.area_light = state_.area_light;
        shape.inside_medium = state_.inside_medium;
        shape.outside_medium = state_.outside_medium;
        if (object_ != kNone && shape.area_light != kNone) parameters.error("Shape: lights inside ObjectBegin are not supported");
        if (shape.area_light != kNone) refuse_motion(d.where, "Shape: an area light cannot move");
        render::add_shape(std::move(loaded), shapes);
    }
}

std::vector<LoadedShape>& SceneBuilder::moving_shapes(const SourceLocation& where) {
    if (object_ != kNone) {
        refuse_motion(where, "Shape: a shape inside ObjectBegin cannot move (its ObjectInstance can)");
        return object_shapes_[object_];
    }
    if (check_moving_instance(where)) {
        const auto index = static_cast<std::uint32_t>(scene_.objects.size());
        scene_.instances.push_back({index, state_.ctm.start, state_.ctm.end, where});
    }
    scene_.objects.emplace_back();
    return object_shapes_.emplace_back();
}

bool SceneBuilder::check_moving_instance(const SourceLocation& where) {
    const CurrentTransform& ctm = state_.ctm;
    const std::optional<Affined> start = ctm.start.inverse(), end = ctm.end.inverse();
    if (!start || !end) {
        diagnostics_.error(where, "the transformation of what moves is singular");
    } else if (ctm.start.swaps_handedness() != ctm.end.swaps_handedness()) {
        diagnostics_.error(where, "what moves is mirrored at only one of StartTime and EndTime");
    } else if (is_tiny(*start) || is_tiny(*end)) {
        diagnostics_.error(where, "too small to be traced in single precision");
    } else {
        return true;
    }
    return false;
}

std::uint32_t SceneBuilder::object(const std::string& text, const SourceLocation& where) {
    const std::uint32_t index = objects_.mention(text, where, scene_.objects.size());
    if (index == scene_.objects.size()) {
        scene_.objects.push_back({.name = text});
        object_shapes_.emplace_back();
    }
    return index;
}

void SceneBuilder::begin_object(const Directive& d) {
    push("ObjectBegin", d.where);
    if (object_ != kNone) return diagnostics_.error(d.where, "ObjectBegin: must not be inside another object");
    object_ = object(d.strings[0], d.where);
    objects_.define(d.strings[0], d.name, d.where, diagnostics_);
}

void SceneBuilder::add_instance(const Directive& d) {
    if (object_ != kNone) diagnostics_.error(d.where, "ObjectInstance: must not be inside ObjectBegin");
    const std::uint32_t index = object(d.strings[0], d.where);
    const CurrentTransform& ctm = state_.ctm;
    if (ctm.moves()) {
        if (check_moving_instance(d.where)) scene_.instances.push_back({index, ctm.start, ctm.end, d.where});
        return;
    }
    const std::optional<Affined> inverse = ctm.start.inverse();
    if (!inverse) return diagnostics_.warn(d.where, "ObjectInstance: left out, since its transformation is singular");
    if (is_tiny(*inverse)) diagnostics_.error(d.where, "ObjectInstance: too small to be traced in single precision");
    scene_.instances.push_back({index, ctm.start, std::nullopt, d.where});
}

void SceneBuilder::report(const std::vector<UndefinedName>& undefined) {
    if (!is_incomplete_) {
        for (const auto& [where, name, hint] : undefined)
            diagnostics_.error(where, fmt::format("{} is not defined anywhere{}", name, hint));
        return;
    }
    if (undefined.empty()) return;
    constexpr std::size_t kMax = 10;
    std::vector<std::string> names;
    for (const UndefinedName& one : undefined) names.push_back(one.name);
    const std::size_t rest = names.size() - std::min(names.size(), kMax);
    names.resize(names.size() - rest);
    diagnostics_.error(undefined.front().where, fmt::format("not defined in what could be read: {}{}", fmt::join(names, ", "),
                                                            rest > 0 ? fmt::format(" and {} more names", rest) : ""));
}

void SceneBuilder::finish(const SourceLocation& end) {
    if (!in_world_ && is_addition_) begin_world();
    if (!in_world_ && !is_incomplete_) diagnostics_.error(end, "the scene ends before WorldBegin");
    for (const Pushed& open : stack_) diagnostics_.error(open.where, open.by + " has no end");
    std::vector<UndefinedName> undefined;
    textures_.finish(undefined);
    materials_.add_undefined("material", undefined);
    media_.add_undefined("medium", undefined);
    objects_.add_undefined("object", undefined);
    transforms_.add_undefined(undefined);
    report(undefined);
    for (const auto& [where, mixed] : mixtures_) {
        for (const std::uint32_t i : mixed) {
            if (uses_[i].is_interface || uses_[i].inside != kNone)
                diagnostics_.error(where, "materials: \"interface\" and \"subsurface\" cannot be mixed");
        }
    }
    if (diagnostics_.errors().empty()) {
        for (const std::uint32_t i : endless_mixtures(scene_.materials))
            diagnostics_.error(scene_.materials[i].location,
                               "Material \"mix\": is made of itself, more than 256 deep, or of more than 10,000 materials");
    }
    for (const std::uint32_t i : sums_of_too_many(scene_.media))
        diagnostics_.error(scene_.media[i].location, fmt::format("medium \"{}\": is a sum of itself, or of more than {} media",
                                                                 scene_.media[i].name, kMaxSummed));
    for (const auto& [index, where] : with_tangents_) {
        const MaterialDescription& material = scene_.materials[index];
        const FloatInput x = material.number("alpha_x"), y = material.number("alpha_y");
        if (x.texture != y.texture || (!x.is_textured() && x.value != y.value) || material.numbers.contains("anisotropy")) {
            diagnostics_.error(where, "S: tangents are not supported for anisotropic materials");
        } else if (material.measured || material.type == "mix" || material.displacement.is_textured() ||
                   material.normal_map != kNone) {
            diagnostics_.warn(where, "S: tangents are ignored: measurements and relief follow u and v");
        } else {
            diagnostics_.note(where, "S: tangents are ignored: the material is isotropic");
        }
    }
    if (!scene_.media.empty() && scene_.integrator == "path")
        diagnostics_.note(scene_.media.front().location,
                          "media are rendered, which the integrators \"path\" and \"simplepath\" of pbrt-v4 leave out");
    bool is_translucent = false;
    const auto resolve = [&](ShapeDescription& shape) {
        const MaterialUse& use = uses_[shape.material];
        if (use.inside != kNone) shape.inside_medium = use.inside, is_translucent = true;
        if (use.is_interface) {
            shape.material = kNone;
            if (shape.area_light != kNone)
                diagnostics_.warn(shape.location, "Shape: the area light is ignored, since \"interface\" does not emit");
            shape.area_light = kNone;
        }
        if (shape.area_light != kNone) {
            for (const std::string& refusal : check_area_light(shape)) diagnostics_.error(shape.location, refusal);
        }
        shape.ribbon = shape.ribbon && is_hair(scene_.materials, shape.material);  // nothing else has a use for it
    };
    for (LoadedShape& loaded : shapes_) resolve(loaded.shape);
    for (std::vector<LoadedShape>& shapes : object_shapes_) {
        for (LoadedShape& loaded : shapes) resolve(loaded.shape);
    }
    if (is_translucent && scene_.max_depth != kUnlimited) {
        diagnostics_.warn(end, fmt::format("Integrator: maxdepth {} is ignored, since light scatters very often in \"subsurface\" "
                                           "materials; --max-depth limits it",
                                           scene_.max_depth));
        scene_.max_depth = kUnlimited;
    }
}

}  // namespace latent::render
