// tests/transport/lit_floor.h: a grey floor of 6 m x 6 m, seen whole by the camera, under one light.
#pragma once

#include <string>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

inline std::string lit_floor(const std::string& light) {
    return "LookAt 0 -3 3  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\n"
           "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 0  3 -3 0  -3 3 0  3 3 0]\n" +
           light;
}
// A spot 3 m above, that lights a disc of radius 1.7 m.
inline std::string floor_under_spot() {
    return lit_floor(
        "LightSource \"spot\" \"point3 from\" [0 0 3] \"point3 to\" [0 0 0] \"float coneangle\" 30 \"float conedeltaangle\" 10\n");
}
// A lamp of 1 m x 1 m, 2 m above, that faces down.
inline std::string floor_under_lamp() {
    return lit_floor(
        "Translate 0 0 2\nScale 1 -1 -1\nAreaLightSource \"diffuse\"\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-.5 -.5 0  .5 -.5 0  -.5 .5 0  .5 .5 0]\n");
}

}  // namespace latent::render::testing
