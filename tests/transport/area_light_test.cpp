// Lamps that shine as a picture, through holes, or from nowhere.
#include <fmt/format.h>

#include "tests/transport/lit_floor.h"
#include "tests/transport/picture_mean.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

class AreaLight : public ::testing::Test {
 protected:
    AreaLight() { write_exr(folder_ / "lamp.exr", 2, 1, {3, 2, 1, .25f, .5f, 1}); }
    // Beside "lamp.exr", two pixels wide.
    Scene with_picture(const std::string& text) const { return scene_of(load_scene(folder_.write("room.pbrt", text))); }

 private:
    Folder folder_;
};
const char* const kSquare =
    "Shape \"trianglemesh\" \"point3 P\" [-.5 -.5 0  .5 -.5 0  .5 .5 0  -.5 .5 0] \"point2 uv\" [0 0 1 0 1 1 0 1] "
    "\"integer indices\" [0 1 2 0 2 3] ";
double luminance(double r, double g, double b) { return 0.2126390 * r + 0.7151687 * g + 0.0721923 * b; }

// The texels' middles, each seen from near.
TEST_F(AreaLight, ShowsItsPicture) {
    for (const double side : {-1.0, 1.0}) {
        const Scene scene = with_picture(fmt::format(
            "LookAt {0} 0 -1  {0} 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 5\nWorldBegin\n"
            "AreaLightSource \"diffuse\" \"string filename\" \"lamp.exr\" \"float scale\" 2 \"bool twosided\" true\n{1}\n",
            side * 0.4, kSquare));
        const double expected = 2 * (side < 0 ? luminance(3, 2, 1) : luminance(.25, .5, 1));
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const Mean mean = mean_of_picture(scene, {.kind = kind, .seed = 1}, 20'000);
            EXPECT_NEAR(mean.xyz[1], expected, 4.5 * mean.error[1] + 0.002 * expected);
            EXPECT_LT(mean.error[1], 0.01 * expected);
        }
    }
}

TEST_F(AreaLight, PowerIsThatOfThePictureAltogether) {
    const Scene scene = with_picture(
        "WorldBegin\nScale 3 3 3\nAreaLightSource \"diffuse\" \"string filename\" \"lamp.exr\" \"float power\" 7\n"
        "Shape \"disk\" \"float radius\" .5\n");
    const double mean = 0.5 * (luminance(3, 2, 1) + luminance(.25, .5, 1)), area = std::numbers::pi * 1.5 * 1.5;
    const double scale = static_cast<double>(scene.world()->lights()[0].emission().scale);
    EXPECT_NEAR(scale * mean * std::numbers::pi * area, 7, 1e-4);
}

const std::string kRoom =
    floor_under_sky(3, ".1 .1 .1") +
    "Material \"conductor\" \"float roughness\" .5\nShape \"sphere\" \"float radius\" .4\nMaterial \"diffuse\"\n"
    "Translate .1 -.2 1.1\nRotate 160 1 .2 0\n";

TEST_F(AreaLight, PathAndBdptMakeOnePicture) {
    const std::string picture = "AreaLightSource \"diffuse\" \"string filename\" \"lamp.exr\" \"float scale\" 3 ",
                      lamp = "AreaLightSource \"diffuse\" \"float scale\" 4 ", quad = kSquare,
                      holes = "Texture \"holes\" \"float\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 4\n";
    for (const std::string& light :
         {picture + "\"bool twosided\" true " + quad, picture + "Shape \"sphere\" \"float radius\" .4",
          picture + "Shape \"cylinder\" \"float radius\" .4 \"float zmin\" -.2 \"float zmax\" .2",
          picture + quad + "\"float alpha\" .3", holes + lamp + quad + "\"texture alpha\" \"holes\"",
          // Light from a surface that nothing meets.
          picture + quad + "\"float alpha\" 0", lamp + "Shape \"sphere\" \"float radius\" .3 \"float alpha\" 0"}) {
        SCOPED_TRACE(light);
        const Scene scene = with_picture(kRoom + light + "\n");
        expect_path_and_bdpt_agree(scene, 6144, 4096);
    }
}

// A floor, lit from the side by a lamp that is out of sight.
TEST_F(AreaLight, OfAlphaNoughtLightsAsTheSameLampDoesThatIsThere) {
    const std::string floor =
        "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\nIntegrator \"path\" \"integer maxdepth\" 1\n"
        "WorldBegin\nMaterial \"diffuse\"\nShape \"disk\" \"float radius\" 3\nTranslate 3 0 1\nRotate 240 0 1 0\n"
        "AreaLightSource \"diffuse\"\n";
    const Scene there = scene_from(floor + kSquare), nowhere = scene_from(floor + kSquare + "\"float alpha\" 0");
    expect_equal(picture_of(nowhere, {}, 4096), picture_of(there, {}, 4096));
}

}  // namespace
}  // namespace latent::render::testing
