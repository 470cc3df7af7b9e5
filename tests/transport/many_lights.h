// tests/transport/many_lights.h: scenes with few lights and with many.
#pragma once

#include <cmath>
#include <string>

#include "tests/transport/world_builder.h"

namespace latent::render::testing {

// A corridor of 40 m with walls across, each with a door, and under the ceiling `lamps` square lamps of the same power.
inline std::string corridor(int lamps) {
    std::string text =
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 3\n"
        "LookAt 0 -19.5 2.4  0 -15 .3  0 0 1\nCamera \"perspective\" \"float fov\" 45\nWorldBegin\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 .6 830 .6]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -20 0  2 -20 0  -2 20 0  2 20 0]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -20 3  2 -20 3  -2 20 3  2 20 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -20 0  -2 20 0  -2 -20 3  -2 20 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [2 -20 0  2 20 0  2 -20 3  2 20 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 20 0  2 20 0  -2 20 3  2 20 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -20 0  2 -20 0  -2 -20 3  2 -20 3]\n";
    for (int wall = 0; wall < 7; ++wall) {
        const double y = -15 + 5 * wall, left = wall % 2 == 0 ? -2 : -0.5, right = wall % 2 == 0 ? 0.5 : 2;
        text += fmt::format("Shape \"bilinearmesh\" \"point3 P\" [{0} {2} 0  {1} {2} 0  {0} {2} 3  {1} {2} 3]\n", left, right, y);
    }
    text += "AreaLightSource \"diffuse\" \"float power\" 5\n";
    for (int i = 0; i < lamps; ++i) {
        const double x = (i % 4 - 1.5) * 0.9, y = -20 + 40 * (i / 4 + 0.53) / ((lamps + 3) / 4);
        text += fmt::format("Shape \"bilinearmesh\" \"point3 P\" [{0} {2} 2.95  {0} {3} 2.95  {1} {2} 2.95  {1} {3} 2.95]\n",
                            x - 0.04, x + 0.04, y - 0.04, y + 0.04);
    }
    return text;
}

// A room with a shining ring of 2 n^2 triangles, as a mesh.
inline std::string shining_ring(int n) {
    std::string points, indices;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n, r = 1 + 0.3 * std::cos(b);
            points += fmt::format("{:.5f} {:.5f} {:.5f} ", r * std::cos(a), 0.5 * r * std::sin(a) + 0.3 * std::sin(b),
                                  0.9 * r * std::sin(a) + 1.4);
            const int i1 = (i + 1) % n, j1 = (j + 1) % n;
            indices += fmt::format("{} {} {} {} {} {} ", i * n + j, i1 * n + j, i1 * n + j1, i * n + j, i1 * n + j1, i * n + j1);
        }
    }
    return "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 3\n"
           "LookAt 0 -5.8 1.8  0 0 1.4  0 0 1\nCamera \"perspective\" \"float fov\" 50\nWorldBegin\n"
           "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [-3 -6 0  3 -6 0  -3 3 0  3 3 0]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [-3 3 0  3 3 0  -3 3 4  3 3 4]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [-3 -6 0  -3 3 0  -3 -6 4  -3 3 4]\n"
           "Shape \"bilinearmesh\" \"point3 P\" [3 -6 0  3 3 0  3 -6 4  3 3 4]\n"
           "ReverseOrientation\nAreaLightSource \"diffuse\"\nShape \"trianglemesh\" \"point3 P\" [ " +
           points + "] \"integer indices\" [ " + indices + "]\n";
}

// A floor with balls of many kinds under n x n points of light, in fog or not.
inline std::string points_of_light(int n, bool fog) {
    std::string text =
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"volpath\" \"integer maxdepth\" 3\n";
    if (fog) {
        text +=
            "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_s\" [360 .06 830 .06] \"spectrum sigma_a\" "
            "[360 .01 830 .01]\nMediumInterface \"fog\" \"fog\"\n";
    }
    text += "LookAt 0 -12 4  0 0 0.5  0 0 1\nCamera \"perspective\" \"float fov\" 50\nWorldBegin\n";
    if (fog) text += "MediumInterface \"fog\" \"fog\"\n";
    text +=
        "Material \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-8 -8 0  8 -8 0  -8 8 0  8 8 0]\n";
    const char* const kinds[] = {"\"diffuse\"", "\"conductor\" \"float roughness\" .3", "\"dielectric\" \"float roughness\" .4",
                                 "\"coateddiffuse\" \"float roughness\" .3"};
    for (int i = 0; i < 9; ++i)
        text += fmt::format("AttributeBegin\nMaterial {}\nTranslate {} {} .8\nShape \"sphere\" \"float radius\" .8\nAttributeEnd\n",
                            kinds[i % 4], (i % 3 - 1) * 3.0, (i / 3 - 1) * 3.0);
    for (int i = 0; i < n * n; ++i)
        text += fmt::format("LightSource \"point\" \"float scale\" .2 \"point3 from\" [{} {} {}]\n",
                            -7.0 + 14.0 * (i % n) / (n - 1), -7.0 + 14.0 * (i / n) / (n - 1), 2 + 0.2 * (i % 3));
    return text;
}

// The corridor's first room alone, with three lamps of other sizes and kinds.
// `lamps`: bit i says whether lamp i is lit.
inline std::string three_lamps(unsigned lamps = 7) {
    std::string text =
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 3\n"
        "LookAt 0 -2.4 1.5  0 0 1.2  0 0 1\nCamera \"perspective\" \"float fov\" 80\nWorldBegin\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 .6 830 .6]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2.5 0  2 -2.5 0  -2 2.5 0  2 2.5 0]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2.5 3  2 -2.5 3  -2 2.5 3  2 2.5 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2.5 0  -2 2.5 0  -2 -2.5 3  -2 2.5 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [2 -2.5 0  2 2.5 0  2 -2.5 3  2 2.5 3]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 2.5 0  2 2.5 0  -2 2.5 3  2 2.5 3]\n";
    const char* const lights[] = {"AreaLightSource \"diffuse\" \"float power\" 4\n",
                                  "AreaLightSource \"diffuse\" \"float power\" 4\n",
                                  "LightSource \"spot\" \"float power\" 3 \"point3 from\" [1 -1 2.9] \"point3 to\" [.5 0 0]\n"};
    const char* const bulbs[] = {"Translate -1.5 1.5 .7\nShape \"sphere\" \"float radius\" .1\n",
                                 "Translate 1.5 2 1.8\nShape \"sphere\" \"float radius\" .05\n", ""};
    for (unsigned i = 0; i < 3; ++i)
        text += fmt::format("AttributeBegin\n{}{}AttributeEnd\n", (lamps >> i & 1) == 1 ? lights[i] : "", bulbs[i]);
    return text;
}

}  // namespace latent::render::testing
