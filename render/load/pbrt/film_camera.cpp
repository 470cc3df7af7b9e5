#include "render/load/pbrt/film_camera.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/load/files/unread.h"
#include "render/load/pbrt/features.h"

namespace latent::render {

FilmDescription read_film(const std::string& type, const ParameterList& list) {
    FilmDescription film;
    film.width = static_cast<std::uint32_t>(list.integer("xresolution", 1280, 1, 1 << 24));
    film.height = static_cast<std::uint32_t>(list.integer("yresolution", 720, 1, 1 << 24));
    if (type == "spectral") {
        list.note("Film \"spectral\" is ignored; for spectra, use latent-develop --spectral-bins");
    } else if (type == "gbuffer") {
        list.note("Film \"gbuffer\" is ignored: only the picture is rendered, without positions, normals or albedo");
    } else if (type != "rgb") {
        list.error(unsupported("Film", type));
    }
    const auto ignored = [](const char* name) {
        return fmt::format("Film: ignored: \"{}\"{}", name, why_unread(SceneLanguage::kPbrtV4, "Film", name));
    };
    if (list.string("sensor").value_or("cie1931") != "cie1931") list.note(ignored("sensor"));
    if (list.number("iso", 100) != 100) list.note(ignored("iso"));
    list.report_unused();
    return film;
}

namespace {

// Focal distances of the shortest and the longest wavelength; those between are linear in wavelength [R06 8.3.3].
void read_chromatic_aberration(const ParameterList& list, CameraDescription& camera) {
    const Parameter* const p = list.find("latent:focaldistances", {"float"});
    if (p == nullptr) return;
    if (list.find("focaldistance", {"float", "integer"}) != nullptr) list.error(*p, "cannot be combined with focaldistance");
    const std::span<const double> ends = p->numbers;
    if (ends.size() != 2) return list.error(*p, "must be two distances, those of 360 nm and of 830 nm");
    if (!(std::min(ends[0], ends[1]) >= 1e-6) || !(std::max(ends[0], ends[1]) <= 1e30))
        return list.error(*p, "both distances must be between 1e-06 and 1e+30");
    if (camera.lens_radius == 0) list.warn("Camera: latent:focaldistances has no effect without lensradius");
    camera.focal_distance = (ends[0] + ends[1]) / 2;
    camera.focal_slope = (ends[1] - ends[0]) / (830 - 360);
}

}  // namespace

ShutterDescription read_shutter(const ParameterList& list) {
    ShutterDescription shutter{list.number("shutteropen", 0), list.number("shutterclose", 1)};
    if (shutter.close < shutter.open) list.error("Camera: \"shutterclose\" comes before \"shutteropen\"");
    if (shutter.close - shutter.open != 1)
        list.note(
            "Camera: the time that the shutter is open does not change the exposure; set that with latent-convert --sensitivity");
    return shutter;
}

CameraDescription read_camera(const std::string& type, const ParameterList& list, const FilmDescription& film) {
    CameraDescription camera{.location = list.directive().where};
    const double aspect = list.number("frameaspectratio", static_cast<double>(film.width) / film.height, 1e-6, 1e6);
    camera.x1 = std::max(aspect, 1.0);
    camera.y1 = std::max(1 / aspect, 1.0);
    camera.x0 = -camera.x1;
    camera.y0 = -camera.y1;
    if (type == "spherical") {
        camera.kind = CameraKind::kSpherical;
        const std::string mapping = list.string("mapping").value_or("equalarea");
        if (mapping != "equalarea" && mapping != "equirectangular")
            list.error(fmt::format("mapping \"{}\" is neither equalarea nor equirectangular", mapping));
        camera.mapping = mapping == "equirectangular" ? SphericalMapping::kEquirectangular : SphericalMapping::kEqualArea;
        list.ignore({"screenwindow", "lensradius", "focaldistance"}, "a spherical camera has none");
        list.report_unused();
        return camera;
    }
    const std::span<const double> window = list.array("screenwindow", "float", 4);
    if (window.size() > 4 || (window.size() == 4 && !(window[0] < window[1] && window[2] < window[3]))) {
        list.error("screenwindow: must have x0 < x1 and y0 < y1");
    } else if (window.size() == 4) {
        camera.x0 = window[0], camera.x1 = window[1], camera.y0 = window[2], camera.y1 = window[3];
    }
    camera.lens_radius = list.number("lensradius", 0, 0, 1e6);
    camera.focal_distance = list.number("focaldistance", 1e6, 1e-6, 1e30);
    if (type == "perspective") {
        read_chromatic_aberration(list, camera);
        const double fov = list.number("fov", 90, 1e-3, 179.999);
        const double scale = std::tan(fov / 2 * std::numbers::pi / 180);
        camera.x0 *= scale, camera.x1 *= scale, camera.y0 *= scale, camera.y1 *= scale;
        // Both eyes of a pair see the same part of the plane in focus [R06 8.3.1].
        const double shift = list.number("latent:lensshift", 0, -1e6, 1e6);
        camera.world_from_camera.t = {shift, 0, 0};
        camera.x0 -= shift / camera.focal_distance, camera.x1 -= shift / camera.focal_distance;
    } else if (type == "orthographic") {
        camera.kind = CameraKind::kOrthographic;
    } else {
        list.error(unsupported("Camera", type));
        return camera;
    }
    list.report_unused();
    return camera;
}

void read_integrator(const std::string& type, const ParameterList& list, bool replaced, SceneDescription& scene) {
    scene.integrator = type;
    scene.max_depth = static_cast<std::uint32_t>(list.integer("maxdepth", 5, 0, 1 << 30));
    if (replaced) return list.report_unused();
    if (is_among(pbrt_replacements(), "Integrator", type)) {
        const bool finds_caustics = type == "mlt" || type == "sppm";
        scene.integrator = finds_caustics ? "bdpt" : "path";
        list.note(fmt::format("Integrator \"{}\" is replaced by \"{}\"{}", type, scene.integrator,
                              finds_caustics ? ", which finds fewer caustics: those behind glass or water stay noisy" : ""));
    } else if (!is_among(pbrt_features(), "Integrator", type)) {
        list.error(unsupported("Integrator", type));
    }
    list.report_unused();
}

}  // namespace latent::render
