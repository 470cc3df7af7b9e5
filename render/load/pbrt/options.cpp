// The directives before WorldBegin, which say how the world is looked at.
#include <fmt/format.h>

#include <algorithm>

#include "render/load/pbrt/builder.h"
#include "render/load/pbrt/film_camera.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

// Options that change no picture of ours.
constexpr std::string_view kHarmlessOptions[] = {"disabletexturefiltering",
                                                 "displacementedgescale",
                                                 "msereferenceimage",
                                                 "msereferenceout",
                                                 "pixelstats",
                                                 "rendercoordsys",
                                                 "seed",
                                                 "wavefront"};

}  // namespace

bool SceneBuilder::apply_option(const Directive& d) {
    const bool known = d.name == "Camera" || d.name == "Film" || d.name == "Integrator" || d.name == "Sampler" ||
                       d.name == "PixelFilter" || d.name == "Accelerator" || d.name == "WorldBegin" || d.name == "Option";
    if (!known) return false;
    if (in_world_ && d.name != "Option") {
        diagnostics_.error(d.where, d.name + ": must come before WorldBegin");
    } else if (d.name == "Camera") {
        camera_ = d;
        camera_state_ = state_;
        if (const std::optional<Affined> inverse = state_.ctm.inverse()) coordinate_systems_["camera"] = *inverse;
    } else if (d.name == "Film") {
        scene_.film = read_film(d.strings[0], list(d, "film"));
    } else if (d.name == "Integrator") {
        read_integrator(d.strings[0], list(d, "integrator"), replace_integrator_, scene_);
    } else if (d.name == "Sampler") {
        diagnostics_.warn(d.where, "Sampler is ignored; set the number of samples with --spp or --samples");
    } else if (d.name == "PixelFilter") {
        diagnostics_.warn(d.where, "PixelFilter is ignored; choose a filter with latent-develop --filter");
    } else if (d.name == "Accelerator") {
        diagnostics_.warn(d.where, "Accelerator is ignored");
    } else if (d.name == "Option") {
        if (std::ranges::find(kHarmlessOptions, d.strings[0]) != std::end(kHarmlessOptions) || d.strings[1] == "false") {
            diagnostics_.warn(d.where, fmt::format("Option \"{}\" is ignored", d.strings[0]));
        } else {
            diagnostics_.error(d.where, fmt::format("Option \"{}\" is not supported", d.strings[0]));
        }
    } else {
        place_camera();
        in_world_ = true;
        state_.ctm = {};
        coordinate_systems_["world"] = {};
    }
    return true;
}

void SceneBuilder::place_camera() {
    const Directive standard{.name = "Camera", .strings = {"perspective"}};
    const Directive& d = camera_ ? *camera_ : standard;
    const State& state = camera_ ? camera_state_ : state_;
    const std::optional<Affined> inverse = state.ctm.inverse();
    if (!inverse) diagnostics_.error(d.where, "Camera: the transformation is singular");
    scene_.camera = read_camera(d.strings[0], ParameterList(d, {}, diagnostics_), scene_.film);
    scene_.camera.world_from_camera = inverse.value_or(Affined{});
    scene_.camera.medium = state.outside_medium;
    for (const std::string& refusal : check_camera(scene_.camera)) diagnostics_.error(d.where, refusal);
}

}  // namespace latent::render
