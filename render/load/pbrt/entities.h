// render/load/pbrt/entities.h: what each kind of directive becomes: one function reads one parameter list into one plain value.
// Errors and warnings go to the list's messages; what is returned is then of no use, but valid.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/load/files/scene_files.h"
#include "render/load/mesh/placement.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"

namespace latent::render {

FilmDescription read_film(const std::string& type, const ParameterList& list);
// Resolves fov, aspect and screen window; transformation, medium and location are the caller's.
CameraDescription read_camera(const std::string& type, const ParameterList& list, const FilmDescription& film);
// Name and maxdepth of the integrator, into `scene`. If it is `replaced`, its name is of no consequence.
void read_integrator(const std::string& type, const ParameterList& list, bool replaced, SceneDescription& scene);

// Nothing: "interface", or an error was reported.
std::optional<MaterialDescription> read_material(const std::string& type, const ParameterList& list, SceneSpectra& spectra);
MediumDescription read_medium(const std::string& type, const ParameterList& list, SceneSpectra& spectra);

// The environment image `name`, as linear sRGB; null if an error was reported.
std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files);
LightDescription read_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra, SceneFiles& files);
AreaLightDescription read_area_light(const std::string& type, const ParameterList& list, SceneSpectra& spectra);

// The shapes of one Shape directive (a mesh of triangles and quads is two), in the space that `ctm` maps to. Orientation is
// resolved; material, light and media are the caller's.
std::vector<LoadedShape> read_shape(const std::string& type, const ParameterList& list, const Affined& ctm,
                                    bool reverse_orientation, SceneFiles& files);

}  // namespace latent::render
