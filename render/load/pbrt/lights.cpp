#include "render/load/pbrt/lights.h"

#include <fmt/format.h>

#include "render/load/files/pictures.h"
#include "render/load/pbrt/features.h"
#include "render/load/pbrt/light_pictures.h"

namespace latent::render {

namespace {

// pbrt reads a negative power or illuminance as "not given".
std::optional<double> positive(const ParameterList& list, std::string_view name) {
    const std::optional<double> value = list.number(name);
    return value && *value > 0 ? value : std::nullopt;
}

// What the colours of a picture multiply. They are in a space of their own, whatever that of the scene's colours.
color::Spectrum illuminant_of_picture(const ParameterList& list, SceneSpectra& spectra) {
    return SceneSpectra::is_given(list, "latent:illuminant") ? spectra.emission(list, "latent:illuminant")
                                                             : SceneSpectra::white_of_pictures();
}
// Without a picture, L is the light.
void refuse_illuminant(const ParameterList& list) {
    if (SceneSpectra::is_given(list, "latent:illuminant"))
        list.error(
            "latent:illuminant: is the light that a picture colours, and filename is missing; a light without a picture has L");
}
void refuse_radiance(const ParameterList& list) {
    if (SceneSpectra::is_given(list, "L"))
        list.error("L and filename cannot be combined; the light that the picture colours is latent:illuminant");
}

// The picture of a goniometric light: the mean of R, G and B in each pixel.
std::shared_ptr<const ImageDescription> read_intensities(const ParameterList& list, const std::string& name, SceneFiles& files) {
    const std::shared_ptr<const ImageDescription> image = read_environment(list, name, files);
    if (!image) return nullptr;
    auto grey = std::make_shared<ImageDescription>(*image);
    for (std::size_t i = 0; i < grey->rgb.size(); i += 3) {
        float* const rgb = &grey->rgb[i];
        rgb[0] = rgb[1] = rgb[2] = (rgb[0] + rgb[1] + rgb[2]) / 3;
    }
    return grey;
}

// Corners of a rectangle, in the world.
std::optional<std::array<Vec3d, 4>> read_portal(const ParameterList& list) {
    const std::span<const double> p = list.array("portal", "point3", 3);
    if (p.empty()) return std::nullopt;
    std::array<Vec3d, 4> corners;
    if (p.size() != 12) {
        list.error("portal: must be the four corners of a rectangle");
        return std::nullopt;
    }
    for (std::size_t i = 0; i < 4; ++i) corners[i] = {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
    const Vec3d a = corners[1] - corners[0], b = corners[3] - corners[0];
    const double size = std::max(length(a), length(b)), skew = max_abs(corners[2] - corners[1] - b);
    if (!(length(a) > 0 && length(b) > 0 && skew <= 1e-3 * size && std::abs(dot(a, b)) <= 1e-3 * length(a) * length(b))) {
        list.error("portal: the four points are not the corners, in turn, of a rectangle");
        return std::nullopt;
    }
    return corners;
}

}  // namespace

AreaLightDescription read_area_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra,
                                     SceneTextures& textures, SceneFiles& files) {
    AreaLightDescription light{.location = list.directive().where};
    if (type != "diffuse") {
        list.error(unsupported("AreaLightSource", type));
        return light;
    }
    if (const std::optional<std::string> name = list.string("filename")) {
        refuse_radiance(list);
        light.spectrum = illuminant_of_picture(list, spectra);
        if (const std::shared_ptr<const ImageDescription> image = read_light_picture(list, *name, files)) {
            light.picture = textures.emission(list, *name);
            light.mean_luminance = mean_luminance(*image);
            if (!(light.mean_luminance > 0)) list.error(fmt::format("{}: is black", *name));
        }
    } else {
        refuse_illuminant(list);
        light.spectrum = spectra.emission(list, "L");
    }
    light.scale = list.number("scale", 1, 0, 1e30);
    light.power = positive(list, "power");
    light.two_sided = list.flag("twosided", false);
    light.exponent = list.number("latent:exponent", 0, 0, 1e5);
    light.name = list.string("name").value_or("");
    list.report_unused();
    return light;
}

LightDescription read_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra, SceneFiles& files) {
    LightDescription light{.location = list.directive().where};
    light.scale = list.number("scale", 1, 0, 1e30);
    light.name = list.string("name").value_or("");
    if (type == "point" || type == "spot") {
        light.kind = type == "point" ? LightKind::kPoint : LightKind::kSpot;
        light.spectrum = spectra.emission(list, "I");
        light.power = positive(list, "power");
        light.from = list.point("from", {0, 0, 0});
        if (type == "spot") {
            light.to = list.point("to", {0, 0, 1});
            light.cone_degrees = list.number("coneangle", 30, 0, 180);
            light.cone_delta_degrees = list.number("conedeltaangle", 5, 0, 180);
        }
    } else if (type == "goniometric" || type == "projection") {
        const bool is_map = type == "goniometric";
        light.kind = is_map ? LightKind::kGoniometric : LightKind::kProjection;
        light.spectrum = is_map ? spectra.emission(list, "I") : illuminant_of_picture(list, spectra);
        light.power = positive(list, "power");
        if (!is_map) light.fov_degrees = list.number("fov", 90, 1e-3, 179);
        const std::optional<std::string> name = list.string("filename");
        if (!name) {
            list.error("filename: missing");
        } else {
            light.image = is_map ? read_intensities(list, *name, files) : read_light_picture(list, *name, files);
        }
        if (light.image && !(mean_luminance(*light.image) > 0)) list.error(fmt::format("{}: is black", *name));
    } else if (type == "distant") {
        light.kind = LightKind::kDistant;
        light.spectrum = spectra.emission(list, "L");
        light.illuminance = positive(list, "illuminance");
        light.from = list.point("from", {0, 0, 0});
        light.to = list.point("to", {0, 0, 1});
    } else if (type == "infinite") {
        light.kind = LightKind::kInfinite;
        light.illuminance = positive(list, "illuminance");
        if (const std::optional<std::string> name = list.string("filename")) {
            refuse_radiance(list);
            light.spectrum = illuminant_of_picture(list, spectra);
            light.image = read_environment(list, *name, files);
        } else {
            refuse_illuminant(list);
            light.spectrum = spectra.emission(list, "L");
        }
        light.portal = read_portal(list);
    } else {
        list.error(unsupported("LightSource", type));
        return light;
    }
    if ((light.kind == LightKind::kSpot || light.kind == LightKind::kDistant) && light.from == light.to)
        list.error("from and to are the same point");
    list.report_unused();
    return light;
}

}  // namespace latent::render
