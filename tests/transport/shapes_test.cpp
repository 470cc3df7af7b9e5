// Shapes in whole pictures: path and bdpt agree on each, as what is lit and as a lamp.
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

// A floor under the sky, and something on it.
Scene floor_with(const std::string& what) {
    return scene_from(
        "LookAt 0 -3 1.2  0 0 .3  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" .1 \"float focaldistance\" "
        "3\n"
        "Integrator \"path\" \"integer maxdepth\" 4\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [.2 .3 .6]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .4 .3]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-4 -4 -.8  4 -4 -.8  4 4 -.8  -4 4 -.8] \"integer indices\" [0 1 2 0 2 3]\n" +
        what);
}
void expect_agreement(const Scene& scene) {
    expect_equal(picture_of(scene, {.kind = IntegratorKind::kPath}, 4096),
                 picture_of(scene, {.kind = IntegratorKind::kBdpt}, 2048));
}

TEST(Shapes, PartsOfQuadrics) {
    expect_agreement(floor_with(
        "AttributeBegin\nTranslate -.6 0 1.2\nRotate 40 1 0 0\nAreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float scale\" 6 "
        "\"bool twosided\" true\nShape \"sphere\" \"float radius\" .5 \"float zmin\" -.2 \"float zmax\" .4 \"float phimax\" 300\n"
        "Translate 1.4 0 0\nShape \"cylinder\" \"float radius\" .3 \"float zmin\" -.2 \"float zmax\" .4 \"float phimax\" 200\n"
        "Translate -.7 .4 0\nReverseOrientation\nShape \"disk\" \"float radius\" .3 \"float innerradius\" .1 \"float phimax\" "
        "270\nAttributeEnd\n"
        "Material \"dielectric\" \"float roughness\" .3\nShape \"cylinder\" \"float radius\" .4 \"float zmin\" -.7 \"float zmax\" "
        "-.1\nMaterial \"conductor\" \"float uroughness\" .3 \"float vroughness\" .1\nTranslate .9 .5 0\n"
        "Shape \"sphere\" \"float radius\" .6 \"float zmax\" .2 \"float phimax\" 240\n"));
}

}  // namespace
}  // namespace latent::render::testing
