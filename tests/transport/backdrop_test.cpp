// Backdrops (ShapeDescription::backdrop): seen, and nothing else.
#include "tests/transport/picture_mean.h"

namespace latent::render::testing {
namespace {

// Side 8 about the origin, of reflectance 0.3, which emits 0.25, if anything.
constexpr const char* kBox = R"(
Material "diffuse" "spectrum reflectance" [360 0.3 830 0.3]
Shape "trianglemesh" "point3 P" [-4 -4 -4  4 -4 -4  -4 4 -4  4 4 -4  -4 -4 4  4 -4 4  -4 4 4  4 4 4]
  "integer indices" [0 1 3 0 3 2 4 5 7 4 7 6 0 1 5 0 5 4 2 3 7 2 7 6 0 2 6 0 6 4 1 3 7 1 7 5]
)";
constexpr const char* kEmission =
    R"(AreaLightSource "diffuse" "spectrum L" "stdillum-D65" "float scale" 0.25 "bool twosided" true)";
constexpr const char* kSky = R"(LightSource "infinite" "spectrum L" "stdillum-D65")";
constexpr const char* kPinhole = R"(LookAt 0.4 1 -2.5  0 0 0  0 1 0 Camera "perspective" "float fov" 10)";
constexpr const char* kLens =
    R"(LookAt 0.4 1 -2.5  0 0 0  0 1 0 Camera "perspective" "float fov" 10 "float lensradius" 0.1 "float focaldistance" 2)";

std::string text_of(const std::string& camera, const std::string& box, const std::string& world) {
    return fmt::format(
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nIntegrator \"path\" \"integer maxdepth\" 40\n"
        "{}\nWorldBegin\nAttributeBegin\n{}\nAttributeEnd\n{}\n",
        camera, box, world);
}
// The box is one.
Scene before_backdrop(const std::string& camera, const std::string& emission, const std::string& world) {
    Scene scene = scene_from(text_of(camera, emission + kBox, world));
    scene.description.shapes[0].backdrop = true;
    return scene;
}

std::vector<float> luminances(const Scene& scene) {
    const std::unique_ptr<Integrator> integrator = scene.integrator({.record = sampledb::RecordKind::kXyz, .seed = 1});
    sampledb::Records records;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < 4096; ++n) integrator->trace(n, records, faults);
    return records.y;
}

// A sphere fills the picture.
TEST(Backdrop, ItHidesNoLight) {
    const std::string world = R"(LightSource "infinite" "rgb L" [.5 .6 .7] Shape "sphere" "float radius" 1)";
    EXPECT_EQ(luminances(before_backdrop(kPinhole, "", world)), luminances(scene_from(text_of(kPinhole, "", world))));
}

// Under a sky of radiance 1, what is matt shows its reflectance; smooth metal and glass show that of the backdrop.
TEST(Backdrop, ItIsSeenInMirrorsAndThroughGlassAndLightsNothing) {
    struct Case {
        const char* thing;
        bool shows_backdrop;
    };
    for (const Case& c : {Case{R"(Material "diffuse" "spectrum reflectance" [360 0.5 830 0.5])", false},
                          Case{R"(Material "latent:principled" "rgb color" [1 1 1] "float metallic" 1 "float roughness" 0)", true},
                          Case{R"(Material "dielectric")", true}, Case{R"(Material "thindielectric")", true}}) {
        for (const char* camera : {kPinhole, kLens}) {
            for (const char* emission : {"", kEmission}) {
                for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
                    SCOPED_TRACE(fmt::format("{}, {}, {}, {}", c.thing, camera, emission, kind == IntegratorKind::kBdpt));
                    const std::string world = fmt::format("{} {} Shape \"sphere\" \"float radius\" 1", kSky, c.thing);
                    const double backdrop = *emission != 0 ? 0.55 : 0.3, expected = c.shows_backdrop ? backdrop : 0.5;
                    const Mean mean = mean_of_picture(before_backdrop(camera, emission, world), {.kind = kind, .seed = 1}, 20'000);
                    EXPECT_NEAR(mean.xyz[1], expected, 4.5 * mean.error[1]);
                    EXPECT_LT(mean.error[1], 0.01 * expected);
                }
            }
        }
    }
}

// A large lens close to the backdrop, and behind that a lamp before a wall.
TEST(Backdrop, ItHidesWhatIsBehindIt) {
    const std::string world = std::string(kSky) + R"(
AttributeBegin
  Translate 0 0 4.3
  AreaLightSource "diffuse" "spectrum L" "stdillum-D65" "float scale" 10
  Shape "sphere" "float radius" 0.1
AttributeEnd
Translate 0 0 4.5
Shape "disk" "float radius" 2
)";
    for (const char* lens : {"", R"("float lensradius" 0.5 "float focaldistance" 0.8)"}) {
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            SCOPED_TRACE(fmt::format("{}, {}", lens, kind == IntegratorKind::kBdpt));
            const std::string camera = fmt::format("LookAt 0 0 3.5  0 0 4  0 1 0 Camera \"perspective\" \"float fov\" 60 {}", lens);
            const Mean mean = mean_of_picture(before_backdrop(camera, "", world), {.kind = kind, .seed = 1}, 20'000);
            EXPECT_NEAR(mean.xyz[1], 0.3, 4.5 * mean.error[1]);
            EXPECT_LT(mean.error[1], 0.003);
        }
    }
}

// A lamp that shines on the backdrop alone; and a sky and a lamp with a glossy floor, metal and glass in the box.
TEST(Backdrop, PathAndBdptMakeOnePicture) {
    const std::string lamp = R"(
Translate 0 0 2.8
AreaLightSource "diffuse" "spectrum L" "stdillum-D65" "float scale" 10
Shape "disk" "float radius" 0.1
)";
    const std::string things = std::string(kSky) + R"(
AttributeBegin
  Translate 2 0.5 3.6
  AreaLightSource "diffuse" "spectrum L" "stdillum-D65" "float scale" 10
  Shape "sphere" "float radius" 0.1
AttributeEnd
AttributeBegin
  Translate 0 -0.5 0 Rotate 90 1 0 0
  Material "coateddiffuse" "float roughness" 0.1
  Shape "disk" "float radius" 1.5
AttributeEnd
AttributeBegin
  Translate 0.6 0 0.3
  Material "conductor" "float roughness" 0.2
  Shape "sphere" "float radius" 0.5
AttributeEnd
Translate -0.5 0 -0.3
Material "dielectric"
Shape "sphere" "float radius" 0.5
)";
    for (const char* kind :
         {R"("perspective" "float fov" 60)", R"("perspective" "float fov" 60 "float lensradius" 0.3 "float focaldistance" 2)",
          R"("orthographic" "float screenwindow" [-3 3 -3 3])"}) {
        const std::string camera = fmt::format("LookAt 0.4 1 -2.5  0 0 0  0 1 0 Camera {}", kind);
        for (const Connections connections : {Connections::kAll, Connections::kOne}) {
            for (const Scene& scene : {before_backdrop(camera, "", lamp), before_backdrop(camera, kEmission, things)}) {
                SCOPED_TRACE(camera);
                const Mean path = mean_of_picture(scene, {.seed = 1}, 200'000),
                           bdpt = mean_of_picture(scene, {.kind = IntegratorKind::kBdpt, .connections = connections, .seed = 2},
                                                  100'000);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double error = std::hypot(path.error[c], bdpt.error[c]);
                    EXPECT_NEAR(path.xyz[c], bdpt.xyz[c], 4.5 * error);
                    EXPECT_LT(error, 0.01 * path.xyz[c]);
                }
            }
        }
    }
}

}  // namespace
}  // namespace latent::render::testing
