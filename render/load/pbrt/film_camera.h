// render/load/pbrt/film_camera.h: film, camera and integrator. Defaults are pbrt-v4's.
#pragma once

#include <string>

#include "render/load/pbrt/parameters.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the lists' diagnostics; what is returned is then of no use, but valid.

FilmDescription read_film(const std::string& type, const ParameterList& list);
// The times at which the shutter opens and closes.
ShutterDescription read_shutter(const ParameterList& list);
// Resolves fov, aspect and screen window; transformation, medium and location are the caller's.
CameraDescription read_camera(const std::string& type, const ParameterList& list, const FilmDescription& film);
// Name and maxdepth of the integrator, into `scene`. If it is `replaced`, its name is of no consequence.
void read_integrator(const std::string& type, const ParameterList& list, bool replaced, SceneDescription& scene);

}  // namespace latent::render
