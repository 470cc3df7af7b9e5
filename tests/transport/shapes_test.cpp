// Shapes in whole pictures: path and bdpt agree on each, as what is lit and as a lamp.
#include "tests/transport/lit_floor.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

TEST(Shapes, PartsOfQuadrics) {
    const std::string shapes =
        "AttributeBegin\nTranslate -.6 0 1.2\nRotate 40 1 0 0\nAreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float scale\" 6 "
        "\"bool twosided\" true\nShape \"sphere\" \"float radius\" .5 \"float zmin\" -.2 \"float zmax\" .4 \"float phimax\" 300\n"
        "Translate 1.4 0 0\nShape \"cylinder\" \"float radius\" .3 \"float zmin\" -.2 \"float zmax\" .4 \"float phimax\" 200\n"
        "Translate -.7 .4 0\nReverseOrientation\nShape \"disk\" \"float radius\" .3 \"float innerradius\" .1 \"float phimax\" "
        "270\nAttributeEnd\n"
        "Material \"dielectric\" \"float roughness\" .3\nShape \"cylinder\" \"float radius\" .4 \"float zmin\" -.7 \"float zmax\" "
        "-.1\nMaterial \"conductor\" \"float uroughness\" .3 \"float vroughness\" .1\nTranslate .9 .5 0\n"
        "Shape \"sphere\" \"float radius\" .6 \"float zmax\" .2 \"float phimax\" 240\n";
    expect_path_and_bdpt_agree(scene_from(floor_under_sky(4, ".2 .3 .6") + shapes), 4096, 2048);
}

}  // namespace
}  // namespace latent::render::testing
