#include "render/load/pbrt/options.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/load/files/unread.h"
#include "render/load/pbrt/film_camera.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

// Those that change nothing while they are off.
bool is_off(const Directive& option) {
    return option.strings[1] == "false" && (option.strings[0].starts_with("disable") || option.strings[0] == "forcediffuse");
}

}  // namespace

bool SceneOptions::apply(const Directive& d, bool in_world, const CurrentTransform& ctm, std::uint32_t outside_medium) {
    const bool known = d.name == "Camera" || d.name == "Film" || d.name == "Integrator" || d.name == "Sampler" ||
                       d.name == "PixelFilter" || d.name == "Accelerator" || d.name == "Option" || d.name == "TransformTimes";
    if (!known) return false;
    if (in_world && d.name != "Option") {
        diagnostics_.error(d.where, d.name + ": must come before WorldBegin");
    } else if (d.name == "Camera") {
        camera_ = {d, ctm, outside_medium};
    } else if (d.name == "TransformTimes") {
        start_time_ = d.numbers[0];
        end_time_ = d.numbers[1];
        if (!(start_time_ < end_time_)) diagnostics_.error(d.where, "TransformTimes: the end must come after the start");
    } else if (d.name == "Film") {
        scene_.film = read_film(d.strings[0], ParameterList(d, {}, diagnostics_));
    } else if (d.name == "Integrator") {
        read_integrator(d.strings[0], ParameterList(d, {}, diagnostics_), use_.replaces_integrator, scene_);
        has_integrator_ = true;
    } else {
        const bool is_option = d.name == "Option";
        const std::string what = is_option ? fmt::format("Option \"{}\"", d.strings[0]) : d.name;
        const UnreadFeatures* const unread = find_unread(SceneLanguage::kPbrtV4, d.name, is_option ? d.strings[0] : "");
        if (is_option && is_off(d)) {
            diagnostics_.note(d.where, what + " is ignored: it is off");
        } else if (unread == nullptr) {
            diagnostics_.error(d.where, what + " is not supported");
        } else {
            const std::string place = diagnostics_.place(d.where);
            diagnostics_.say_of_unread(place + what, place, what + " is ignored", *unread);
        }
    }
    return true;
}

void SceneOptions::place_camera(const CurrentTransform& ctm, std::uint32_t outside_medium) {
    const CameraDirective standard{{.name = "Camera", .strings = {"perspective"}}, ctm, outside_medium};
    const auto& [d, camera_from_world, medium] = camera_ ? *camera_ : standard;
    const std::optional<Affined> inverse = camera_from_world.start.inverse(), inverse_at_end = camera_from_world.end.inverse();
    if (!inverse || !inverse_at_end) diagnostics_.error(d.where, "Camera: the transformation is singular");
    const ParameterList list(d, {}, diagnostics_);
    const ShutterDescription times = read_shutter(list);
    const double length = end_time_ - start_time_;
    scene_.shutter = {(times.open - start_time_) / length, (times.close - start_time_) / length};
    scene_.camera = read_camera(d.strings[0], list, scene_.film);
    if (use_.is_right_handed && inverse && !inverse->swaps_handedness())
        scene_.camera.world_from_camera = Affined({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}) * scene_.camera.world_from_camera;
    if (camera_from_world.moves()) scene_.camera.end = inverse_at_end.value_or(Affined{}) * scene_.camera.world_from_camera;
    scene_.camera.world_from_camera = inverse.value_or(Affined{}) * scene_.camera.world_from_camera;
    scene_.camera.medium = medium;
    for (const std::string& refusal : check_camera(scene_.camera)) diagnostics_.error(d.where, refusal);
}

}  // namespace latent::render
