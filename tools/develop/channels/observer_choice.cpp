#include "tools/develop/channels/observer_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "color/catalogue.h"
#include "color/film/exposure.h"
#include "color/named_spectra.h"
#include "color/observer_file.h"

namespace latent::develop {

namespace {

constexpr double kLargestFactor = 1e6;

double daylight_exposure(const color::Observer& observer) { return color::xyz_from_spectrum(color::illuminant_d65(), observer).y; }

// Chromaticities of a camera's channels: with them, a reader's XYZ is that of the matrix.
color::Primaries primaries_of(const color::Matrix3& m, color::Chromaticity white) {
    const auto column = [&](int c) { return color::chromaticity({m.m[0][c], m.m[1][c], m.m[2][c]}); };
    return {column(0), column(1), column(2), white};
}

Status put_filter(const ObserverOptions& options, ChosenObserver& chosen) {
    const Result<color::Spectrum> filter = color::lens_filter(options.lens_filter);
    if (!filter) return usage_error("--lens-filter: " + filter.error().message);
    const double without = daylight_exposure(chosen.observer);
    chosen.filter_factor = options.filter_factor;
    if (options.filter_factor == 0) {
        chosen.filter_factor = without / daylight_exposure(chosen.observer.behind(*filter, options.lens_filter, 1));
        if (!(chosen.filter_factor <= kLargestFactor))
            return usage_error(fmt::format("--filter-factor auto: {} has no response to daylight behind {}", chosen.observer.name(),
                                           options.lens_filter));
    }
    chosen.observer = chosen.observer.behind(*filter, options.lens_filter, chosen.filter_factor);
    return {};
}

Result<ChosenObserver> choose_film(const ObserverOptions& options) {
    const Result<film::Material> material = film::find_material(options.film, true);
    if (!material) return material.error().at("--film");
    const double index = options.exposure_index > 0 ? options.exposure_index : material->exposure_index;
    Result<color::Observer> layers = film::film_observer(*material, index);
    if (!layers) return layers.error().at("--film");
    return ChosenObserver{.observer = *std::move(layers), .primaries = {}, .film = LoadedFilm{*material, index, options.push}};
}

Result<ChosenObserver> choose_eye(const ObserverOptions& options) {
    Result<color::Observer> found = color::observer_by_name_or_file(options.name);
    if (!found) return found.error().at("--observer");
    ChosenObserver chosen{.observer = *std::move(found)};
    const bool camera = chosen.observer.kind() == color::ObserverKind::kCamera;
    if (options.camera_xyz && !camera)
        return usage_error(fmt::format("--camera-output xyz: {} is not a camera", chosen.observer.name()));
    if (!options.balanced && (!camera || options.camera_xyz))
        return usage_error(fmt::format("--raw-balance none: {}",
                                       camera ? "goes with --camera-output raw" : chosen.observer.name() + " is not a camera"));
    if (camera) {
        const Result<color::CameraFit> fit = color::fit_camera(chosen.observer);
        if (!fit) return fit.error().at(options.name).at("--observer");
        chosen.fit = *fit;
        if (options.camera_xyz) {
            chosen.observer = chosen.observer.as_eye(fit->xyz_from_rgb);
        } else {
            chosen.primaries.reset();
            if (options.balanced) chosen.primaries = primaries_of(fit->xyz_from_rgb, chosen.observer.neutral());
            if (!options.balanced) chosen.observer = chosen.observer.unbalanced();
        }
    }
    return chosen;
}

}  // namespace

Result<ChosenObserver> choose_observer(const ObserverOptions& options) {
    if (options.lens_filter.empty() && options.filter_factor != 1) return usage_error("--filter-factor: needs --lens-filter");
    Result<ChosenObserver> chosen = options.film.empty() ? choose_eye(options) : choose_film(options);
    if (chosen && !options.lens_filter.empty()) {
        if (Status s = put_filter(options, *chosen); !s) return s.error();
    }
    return chosen;
}

std::string list_observers() {
    return color::listing("observers (--observer)", color::observer_catalogue()) +
           color::listing("filters in front of the lens (--lens-filter)", color::lens_filter_catalogue());
}

}  // namespace latent::develop
