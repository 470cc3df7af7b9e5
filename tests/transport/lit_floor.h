// tests/transport/lit_floor.h: scenes that begin with a floor, under one light or an even sky.
#pragma once

#include <string>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

// 6 m x 6 m, grey, seen whole by the camera.
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

// 8 m x 8 m, seen from its side through a lens. Paths have up to `depth` bounces; `sky` is an RGB radiance.
inline std::string floor_under_sky(int depth, const std::string& sky) {
    return fmt::format(
        "LookAt 0 -3 1.2  0 0 .3  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" .1 \"float focaldistance\" "
        "3\nIntegrator \"path\" \"integer maxdepth\" {}\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [{}]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .4 .3]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-4 -4 -.8  4 -4 -.8  4 4 -.8  -4 4 -.8] \"integer indices\" [0 1 2 0 2 3]\n",
        depth, sky);
}

}  // namespace latent::render::testing
