// Surfaces that are there in part: how much light passes them, where a texture makes holes, and that nothing else changes.
#include <fmt/format.h>

#include <random>

#include "tests/render/rays.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/picture_mean.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

// A lamp that fills the view, and something before it.
std::string before_lamp(const std::string& what) {
    return "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 8\nIntegrator \"path\" \"integer maxdepth\" 4\n"
           "WorldBegin\nAttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
           "AreaLightSource \"diffuse\" \"bool twosided\" true\n"
           "Shape \"bilinearmesh\" \"point3 P\" [-4 -4 2  4 -4 2  -4 4 2  4 4 2]\nAttributeEnd\n"
           "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n" +
           what;
}
const char* const kQuad =
    "Shape \"trianglemesh\" \"point3 P\" [-2 -2 0  2 -2 0  2 2 0  -2 2 0] \"point2 uv\" [0 0 1 0 1 1 0 1] "
    "\"integer indices\" [0 1 2 0 2 3] ";

// A share of 1 - alpha passes each layer, whatever the shape and the integrator.
TEST(Alpha, HidesItsShareOfTheLight) {
    struct Case {
        std::string shape;
        int layers;
    };
    const std::string half = "\"float alpha\" .4\n";
    const std::vector<Case> cases = {
        {kQuad + half, 1},
        {"Shape \"disk\" \"float radius\" 2 " + half, 1},
        {"Shape \"sphere\" \"float radius\" 1 " + half, 2},
        {"Shape \"bilinearmesh\" \"point3 P\" [-2 -2 0  2 -2 .1  -2 2 .1  2 2 0] " + half, 1},
        {"ObjectBegin \"o\"\n" + std::string(kQuad) + half + "Shape \"sphere\" \"float radius\" 1 " + half +
             "ObjectEnd\nScale 1.5 1.5 -.5\nRotate 20 0 0 1\nObjectInstance \"o\"\n",
         3},
        {"Texture \"a\" \"float\" \"constant\" \"float value\" .4\n" + std::string(kQuad) + "\"texture alpha\" \"a\"\n", 1},
        {kQuad + std::string("\"float alpha\" 0\n"), 0},
        {"Attribute \"shape\" \"float alpha\" 1\n" + std::string(kQuad), -1},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.shape);
        const Scene scene = scene_from(before_lamp(c.shape));
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const Mean mean = mean_of_picture(scene, {.kind = kind, .max_depth = 4, .seed = 1}, 20'000);
            const double passed = c.layers < 0 ? 0 : std::pow(0.6, c.layers);
            EXPECT_NEAR(mean.xyz[1], passed, 4.5 * mean.error[1]);
            EXPECT_LT(mean.error[1], 0.01);
        }
    }
}

// Cells of a checkerboard that are there, and cells that are not.
TEST(Alpha, OfATextureCutsHoles) {
    const Scene scene = scene_from(before_lamp(
        "Texture \"holes\" \"float\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 4 \"float tex1\" 1 \"float tex2\" 0\n" +
        std::string(kQuad) + "\"texture alpha\" \"holes\"\n"));
    const std::unique_ptr<World> world = scene.world();
    const Vec3f origin(scene.description.origin);
    for (int x = 0; x < 4; ++x) {
        for (int y = 0; y < 4; ++y) {
            const Vec3f p = Vec3f{static_cast<float>(x) - 1.5f, static_cast<float>(y) - 1.5f, -1} - origin;
            const auto hit = first_hit(world->geometry(), {p, {0, 0, 1}});
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->t, (x + y) % 2 == 0 ? 1 : 3, 1e-5) << x << ", " << y;
        }
    }
}

// A shadow ray is not stopped at random: it gathers what each surface lets pass, which is the mean of what a hash decides.
TEST(Alpha, AShadowRayGathersWhatPasses) {
    const auto behind = [](const std::string& shapes) {
        return scene_from("Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n" + shapes).world();
    };
    const std::string quad = std::string(kQuad) + "\"float alpha\" .375\n";
    const std::unique_ptr<World> world =
        behind(quad + "Translate 0 0 .5\n" + quad + "Translate 0 0 1\nShape \"sphere\" \"float radius\" .25 \"float alpha\" .5\n" +
               "ObjectBegin \"o\"\nShape \"bilinearmesh\" \"point3 P\" [-1 -1 .5  1 -1 .5  -1 1 .5  1 1 .6] \"float alpha\" "
               ".25\nObjectEnd\n"
               "ObjectInstance \"o\"\nTranslate 0 0 3\nShape \"disk\" \"float radius\" .5\n");
    const Geometry& geometry = world->geometry();
    const Vec3f origin(scene_from("Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n" + quad).description.origin);
    const Vec3f from = Vec3f{0.07f, 0.03f, -1} - origin, up{0, 0, 1};
    EXPECT_EQ(share_passed(geometry, {from, up, 1.2f}), 0.625f);
    EXPECT_EQ(share_passed(geometry, {from, up, 2}), 0.625f * 0.625f);
    EXPECT_EQ(share_passed(geometry, {from, up, 4.8f}), 0.625f * 0.625f * 0.25f * 0.75f);
    EXPECT_EQ(share_passed(geometry, {from, up, 8}), 0);  // the disk is whole
    double gathered = 0, decided = 0;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> even(-0.2f, 0.2f);
    constexpr int kCount = 40'000;
    for (int i = 0; i < kCount; ++i) {
        const Ray ray{from + Vec3f{even(random), even(random), 0}, {even(random), even(random), 1}, 2};
        gathered += static_cast<double>(share_passed(geometry, ray)) / kCount;
        decided += (first_hit(geometry, ray) ? 0.0 : 1.0) / kCount;
    }
    EXPECT_NEAR(decided, gathered, 4.5 * 0.5 / std::sqrt(kCount));
}

// Sheets before, within and behind a ball of fog, whose surface is an interface; and one that the line does not reach.
TEST(Alpha, AShadowRayGathersThroughInterfacesToo) {
    const auto sheet = [](int z, const std::string& alpha) {
        return fmt::format("AttributeBegin\nTranslate 0 0 {}\n{}\"float alpha\" {}\nAttributeEnd\n", z, kQuad, alpha);
    };
    const Scene scene = scene_from(
        "Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\n"
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1]\n" +
        sheet(-3, ".25") + sheet(0, ".5") + sheet(1, ".75") + sheet(4, ".375") + sheet(6, ".5") +
        "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"fog\" \"\"\nShape \"sphere\" \"float radius\" 2\nAttributeEnd\n"
        "Translate 0 0 9\nShape \"disk\" \"float radius\" 1\n");
    const std::unique_ptr<World> world = scene.world();
    const Vec3f from = Vec3f{0.07f, 0.03f, -5} - Vec3f(scene.description.origin);
    const Line line = world->geometry().trace({from, {0, 0, 10}, 1}, Stop::kAnySolid);
    EXPECT_EQ(line.passed, 0.75f * 0.5f * 0.25f * 0.625f);
    ASSERT_EQ(line.crossings.size(), 2u);
    EXPECT_EQ(line.crossings[0].entered, 0u);
    EXPECT_EQ(line.crossings[1].entered, kNone);
    EXPECT_EQ(world->geometry().trace({from, {0, 0, 20}, 1}, Stop::kAnySolid).passed, 0);  // the disk is whole
}

const char* const kFog =
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .2 .3] \"rgb sigma_s\" [.9 .6 .7]\n";

// Where light passes a surface between two media, the medium changes, whatever the surface is made of.
TEST(Alpha, BetweenMediaAHoleIsAnInterface) {
    struct Case {
        const char* material;
        float passed;
        double open;
    };
    for (const Case& c : {Case{"interface", 1, 1}, Case{"diffuse", 0.625f, 0.625}}) {
        SCOPED_TRACE(c.material);
        const Scene scene =
            scene_from(fmt::format("Camera \"perspective\"\nWorldBegin\nLightSource \"point\"\nMaterial \"{}\"\n{}MediumInterface "
                                   "\"fog\" \"\"\n{}\"float alpha\" .375\n",
                                   c.material, kFog, kQuad));
        const std::unique_ptr<World> world = scene.world();
        const Vec3f from = Vec3f{0, 0, 1} - Vec3f(scene.description.origin);
        constexpr int kCount = 4096;
        int open = 0;
        for (int i = 0; i < kCount; ++i) {
            const Vec3f o = from + Vec3f{static_cast<float>(i % 64 - 32) / 40, static_cast<float>(i / 64 - 32) / 40, 0};
            const Line shadow = world->geometry().trace({o, {0, 0, -1}, 2}, Stop::kAnySolid);
            EXPECT_EQ(shadow.passed, c.passed);
            ASSERT_EQ(shadow.crossings.size(), 1u);
            EXPECT_EQ(shadow.crossings[0].entered, 0u);
            const Line line = world->geometry().trace({o, {0, 0, -1}}, Stop::kFirstSolid);
            EXPECT_EQ(line.crossings.size(), line.hit ? 0u : 1u);
            open += line.hit ? 0 : 1;
        }
        EXPECT_NEAR(open, c.open * kCount, 4.5 * std::sqrt(kCount * c.open * (1 - c.open)));
    }
}

// So a place is in one medium, whichever way light comes there.
TEST(Alpha, PathAndBdptAgreeOnMediaBehindHoles) {
    struct Case {
        const char *material, *alpha;
    };
    for (const Case& c :
         {Case{"\"interface\"", "float alpha\" .4"}, Case{"\"diffuse\" \"rgb reflectance\" [.2 .5 .8]", "float alpha\" .4"},
          Case{"\"dielectric\" \"float roughness\" .3", "float alpha\" .4"}, Case{"\"diffuse\"", "texture alpha\" \"holes\""}}) {
        SCOPED_TRACE(c.material);
        const std::string ball =
            fmt::format("Material {}\nMediumInterface \"fog\" \"\"\nTranslate 0 0 1\nShape \"sphere\" \"float radius\" .7 \"{}\n",
                        c.material, c.alpha);
        expect_path_and_bdpt_agree(
            scene_from(floor_under_sky(4, ".2 .3 .6") + "Texture \"holes\" \"float\" \"fbm\"\n" + kFog + ball), 4096, 2048);
    }
}

// Leaves before a lamp and the sky, with holes by a texture and by a number; a ball of fog about some of them.
TEST(Alpha, PathAndBdptMakeOnePicture) {
    const std::string room =
        floor_under_sky(4, ".2 .3 .6") +
        "AttributeBegin\nTranslate -.6 -.3 2\nAreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float scale\" 12\n"
        "Shape \"sphere\" \"float radius\" .3\nAttributeEnd\n"
        "Texture \"holes\" \"float\" \"fbm\"\n"
        "Material \"diffusetransmission\" \"rgb reflectance\" [.2 .4 .1] \"rgb transmittance\" [.3 .5 .2]\n"
        "AttributeBegin\nTranslate 0 0 .8\nRotate 30 0 1 1\nScale .4 .4 .4\n" +
        kQuad +
        "\"texture alpha\" \"holes\"\nAttributeEnd\nMaterial \"conductor\" \"float roughness\" .1\n"
        "Shape \"sphere\" \"float radius\" .6 \"float alpha\" .5\n";
    expect_path_and_bdpt_agree(scene_from(room), 4096, 2048);
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.02 .02 .02] \"rgb sigma_s\" [.2 .2 .2]\n"
        "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"fog\" \"\"\nTranslate -.3 0 1.2\n"
        "Shape \"sphere\" \"float radius\" .7\nAttributeEnd\n";
    expect_path_and_bdpt_agree(scene_from(room + fog), 4096, 2048);
}

}  // namespace
}  // namespace latent::render::testing
