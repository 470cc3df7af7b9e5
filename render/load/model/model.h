// render/load/model/model.h: a scene while it is loaded.
#pragma once

#include <string>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "render/load/mesh/placement.h"
#include "render/load/model/options.h"
#include "render/scene/description.h"

namespace latent::render {

struct Model {
    SceneDescription scene{};                         // without shapes
    std::vector<LoadedShape> shapes{};                // those of the world
    std::vector<std::vector<LoadedShape>> objects{};  // those of each of scene.objects
    std::vector<double> radiances{};                  // the largest component of each of scene.area_lights, for glTF and OBJ
    std::vector<std::string> cameras{};               // number and name of all in the scene
    std::vector<std::string> variants{};              // names
    std::vector<std::string> animations{};            // number, name and length
    // The one that was asked for.
    bool has_camera = false, has_idle_cameras = false, has_variant = false, has_animation = false;
    bool is_object = false;            // it could have cameras, and has none: no scene, but a thing to be shown
    double sky_scale = 1;              // factor for a picture of the sky, so that it is in the unit of the lamps
    bool has_integrator = false;       // the scene says which, and how deep
    std::vector<std::string> notes{};  // what was read in another way than it stands there
    std::vector<File> embedded{};      // pictures in the model's own file
};

// Gives a model what it lacks and a picture needs (stage.h), and what `options` say instead of it. A model without camera and
// lights also gets a ground, and so does an object with lights. Surfaces of radiance 1 or less do not count as lights. `additions`
// are appended, and may have what the model lacks; the model alone is framed. Returns the model's notes and what was added, in
// words, but for a camera in place of idle ones, which were told. Errors: those of read_picture, kUsage.
Result<std::vector<std::string>> complete(Model& model, std::vector<Model> additions, const ModelOptions& options,
                                          const color::Spectrum& white);

}  // namespace latent::render
