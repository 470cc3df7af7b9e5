// render/load/gltf/lights.h: cameras [glTF2 3.10] and the lights of KHR_lights_punctual.
#pragma once

#include "render/load/gltf/value.h"
#include "render/load/model/colors.h"
#include "render/scene/description.h"

namespace latent::render {

// /cameras/N, placed by its node. Its aspect decides the film's.
void read_camera(const GltfValue& camera, const Affined& world_from_node, SceneDescription& scene);

// /extensions/KHR_lights_punctual/lights/N, placed by its node. Candela and lux are kept as they are: radiances are then in cd/m^2.
LightDescription read_light(const GltfValue& light, const Affined& world_from_node, const ModelColors& colors);

}  // namespace latent::render
