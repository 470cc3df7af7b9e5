// tools/develop/channels/observer_choice.h: who looks: an observer, camera or film, and a filter in front of the lens.
// docs/color.md.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "color/camera.h"
#include "color/film/material.h"
#include "color/observer.h"
#include "color/rgb_space.h"

namespace latent::develop {

struct ObserverOptions {
    std::string name;          // a name in the catalogue, or a CSV file; "": cie1931
    bool camera_xyz = false;   // a camera's r, g, b taken to X, Y, Z; else as they are
    bool balanced = true;      // a camera's r, g, b with D65 as (1, 1, 1); else all with the scale of green
    std::string lens_filter;   // "": none
    double filter_factor = 1;  // exposure is multiplied by it; 0: by what the filter takes of D65
    std::string film;  // a name in color/film/material.h, instead of `name`: the picture holds exposures of its layers; "": none
    double exposure_index = 0;  // the film is exposed for; 0: that of its box
    double push = 0;            // stops that the film will be developed for longer
};

// A film in the camera.
struct LoadedFilm {
    film::Material material;
    double exposure_index = 0, push = 0;
};

struct ChosenObserver {
    color::Observer observer;
    // Those of the pictures' R, G, B; none if they are unbalanced.
    std::optional<color::Primaries> primaries = color::kXyzPrimaries;
    std::optional<color::CameraFit> fit{};  // for cameras
    double filter_factor = 1;               // that was used
    std::optional<LoadedFilm> film{};       // whose layers are exposed
};

// Errors: kUsage, if options do not go together; of color/catalogue.h and of the file.
Result<ChosenObserver> choose_observer(const ObserverOptions& options);

// Every observer and filter that has a name: what it is, and the source of its numbers.
std::string list_observers();

}  // namespace latent::develop
