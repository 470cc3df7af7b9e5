// render/load/model/model.h: a scene while it is loaded from a format that describes models: glTF, OBJ.
#pragma once

#include <string>
#include <vector>

#include "base/file.h"
#include "render/load/mesh/placement.h"
#include "render/scene/description.h"

namespace latent::render {

struct Model {
    SceneDescription scene{};                         // without shapes
    std::vector<LoadedShape> shapes{};                // of the world
    std::vector<std::vector<LoadedShape>> objects{};  // of each of scene.objects
    std::vector<double> radiances{};                  // of each of scene.area_lights: the largest component
    bool has_camera = false, has_idle_cameras = false;
    std::vector<File> embedded{};  // pictures in the model's own file
};

// Gives a model what it lacks and a picture needs, then its place (placement.h). Without a camera: one that looks at all of the
// model, from the front (+z), the right and above, y up. Without a light: a grey sky, whose radiance in
// the direction d is
//   0.6 + 0.4 d.y + 4 exp(20 (d . k - 1)),  k = (0.5, 0.8, 0.6) / |(0.5, 0.8, 0.6)|
// times that of `white`. Surfaces of radiance 1 or less do not count as lights.
// The scene keeps its list of files. Returns what was added, in words, but for a camera in place of idle ones, which were told.
std::vector<std::string> complete(Model model, const color::Spectrum& white, SceneDescription& scene);

}  // namespace latent::render
