// What scenes say beyond pbrt-v4 (docs/scenes.md, "Extensions"): laws of each, and both integrators agree on all.
#include <cmath>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/rgb_space.h"
#include "render/texture/procedural.h"
#include "tests/transport/lit_floor.h"
#include "tests/transport/picture_mean.h"
#include "tests/transport/pictures.h"

namespace latent::render::testing {
namespace {

color::Chromaticity seen(const color::Spectrum& light) {
    const color::Xyz xyz = color::xyz_from_spectrum(light, color::Observer::cie1931());
    const double sum = xyz.x + xyz.y + xyz.z;
    return {xyz.x / sum, xyz.y / sum};
}

TEST(Extensions, DaylightOfAnyTemperatureHasItsChromaticity) {
    for (const double kelvin : {4000.0, 5003.0, 6504.0, 25000.0}) {
        const Scene scene = scene_from(fmt::format("WorldBegin\nLightSource \"infinite\" \"latent:daylight L\" [{}]\n", kelvin));
        const color::Chromaticity is = seen(scene.description.lights[0].spectrum),
                                  should_be = *color::daylight_chromaticity(kelvin);
        EXPECT_NEAR(is.x, should_be.x, 3e-4) << kelvin;
        EXPECT_NEAR(is.y, should_be.y, 3e-4) << kelvin;
    }
    const auto refused = load("WorldBegin\nLightSource \"infinite\" \"latent:daylight L\" [3999]\n");
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("L: daylight is defined for 4000 to 25000 K"), std::string::npos)
        << refused.error().message;
}

TEST(Extensions, AWhitePictureShowsItsIlluminant) {
    const Folder folder;
    write_exr(folder / "white.exr", 2, 2, std::vector<float>(12, 1.0f));
    const color::Chromaticity lamp = seen(*color::Spectrum::blackbody(2856));
    for (const char* light :
         {"LightSource \"infinite\" \"string filename\" \"white.exr\" \"blackbody latent:illuminant\" 2856\n",
          "Translate 0 0 2\nReverseOrientation\nAreaLightSource \"diffuse\" \"string filename\" \"white.exr\" \"blackbody "
          "latent:illuminant\" 2856\nShape \"disk\" \"float radius\" 9\n"}) {
        SCOPED_TRACE(light);
        const Scene scene = scene_of(
            load_scene(folder.write("room.pbrt", std::string("Camera \"perspective\" \"float fov\" 30\nWorldBegin\n") + light)));
        const Mean mean = mean_of_picture(scene, {.seed = 1}, 4096);
        const double sum = mean.xyz[0] + mean.xyz[1] + mean.xyz[2];
        EXPECT_NEAR(mean.xyz[1], 1, 2e-3);
        EXPECT_NEAR(mean.xyz[0] / sum, lamp.x, 1e-3);
        EXPECT_NEAR(mean.xyz[1] / sum, lamp.y, 1e-3);
    }
    const auto both = load_scene(
        folder.write("both.pbrt", "WorldBegin\nLightSource \"infinite\" \"string filename\" \"white.exr\" \"blackbody L\" 2856\n"));
    ASSERT_FALSE(both);
    EXPECT_NE(both.error().message.find("latent:illuminant"), std::string::npos);
}

// A small lamp of power P, high above a floor: right below it, E = I / d^2 with I = P (n + 2) / (2 pi) for each side that shines.
TEST(Extensions, ALampWithAnExponentLightsByItsPower) {
    for (const double exponent : {0.0, 1.0, 12.0, 300.0}) {
        for (const bool two_sided : {false, true}) {
            const Scene scene = scene_from(fmt::format(
                "LookAt 0 -1 1  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" .5\nIntegrator \"path\" \"integer maxdepth\" 1\n"
                "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [360 .5 830 .5]\n"
                "Shape \"disk\" \"float radius\" 1\nTranslate 0 0 5\nScale 2 .5 -1\n"
                "AreaLightSource \"diffuse\" \"float power\" 100 \"float latent:exponent\" {} \"bool twosided\" {}\n"
                "Shape \"disk\" \"float radius\" .02\n",
                exponent, two_sided));
            const double intensity = 100 * (exponent + 2) / (2 * std::numbers::pi) / (two_sided ? 2 : 1);
            const double expected = 0.5 / std::numbers::pi * intensity / 25;
            for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
                const Mean mean = mean_of_picture(scene, {.kind = kind, .seed = 3}, 20'000);
                EXPECT_NEAR(mean.xyz[1] / expected, 1, 0.005 + 4.5 * mean.error[1] / expected) << exponent << two_sided;
            }
        }
    }
}

// Points in focus are seen at the same place by both eyes; those at infinity d / (o w) further to the side, w the window's width.
TEST(Extensions, EyesOfAPairAgreeInThePlaneInFocus) {
    const auto scene = [](double shift) {
        return scene_from(
                   fmt::format(
                       "LookAt 1 2 3  1 2 13  0 1 0\nCamera \"perspective\" \"float fov\" 40 \"float frameaspectratio\" 1 \"float "
                       "focaldistance\" 5 \"float lensradius\" .01 \"float latent:lensshift\" {}\nWorldBegin\nLightSource "
                       "\"infinite\"\n",
                       shift))
            .description;
    };
    const SceneDescription left_scene = scene(-0.1), middle_scene = scene(0), right_scene = scene(0.1);
    const auto stands_at = [](const SceneDescription& s) { return s.origin + s.camera.world_from_camera.t; };
    EXPECT_NEAR(length(stands_at(left_scene) - Vec3d{0.9, 2, 3}), 0, 1e-12);
    EXPECT_NEAR(length(stands_at(right_scene) - Vec3d{1.1, 2, 3}), 0, 1e-12);
    const Camera left = *Camera::make(left_scene.camera), middle = *Camera::make(middle_scene.camera),
                 right = *Camera::make(right_scene.camera);
    const auto place = [](const Camera& camera, const Vec3f& from_centre) {
        CameraPoint point;
        EXPECT_TRUE(camera.connect(camera.center() + from_centre, 0.5f, 0.5f, point));
        return point.u;
    };
    const Vec3f x{0.1f, 0, 0}, in_focus{0.3f, 0, 5}, far_away{0, 0, 5e4f};
    for (const auto& [camera, shift] : {std::pair(&left, -1.0f), {&right, 1.0f}}) {
        EXPECT_NEAR(place(*camera, in_focus - x * shift), place(middle, in_focus), 1e-5);
        const double width = 2 * std::tan(20 * std::numbers::pi / 180);
        EXPECT_NEAR(place(*camera, far_away - x * shift) - place(middle, far_away), static_cast<double>(shift) * 0.1 / 5 / width,
                    1e-4);
    }
}

// Between two diffuse reflectances, that of the mixture is their mean by the selector, wavelength by wavelength.
TEST(Extensions, AMixtureBySpectrumIsOfEachWavelengthItsShare) {
    const auto floor = [](const std::string& material) {
        return scene_from(
            "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 30\nIntegrator \"path\" \"integer maxdepth\" 1\n"
            "WorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-A\"\n" +
            material + "Shape \"disk\" \"float radius\" 3\n");
    };
    const Scene mixed = floor(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"spectrum reflectance\" [360 .2 830 .2]\n"
        "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"spectrum reflectance\" [360 .8 830 .8]\n"
        "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"spectrum latent:amount\" [360 0 450 .1 650 .9 830 1]\n");
    const Scene one = floor("Material \"diffuse\" \"spectrum reflectance\" [360 .2 450 .26 650 .74 830 .8]\n");
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt})
        expect_equal(picture_of(mixed, {.kind = kind}, 2048), picture_of(one, {.kind = kind}, 2048));
}

TEST(Extensions, PathAndBdptMakeOnePicture) {
    const std::string room = floor_under_sky(3, ".1 .1 .1"),
                      lamp =
                          "Translate .1 -.2 1.3\nRotate 160 1 .2 0\nAreaLightSource \"diffuse\" "
                          "\"latent:daylight L\" 5000 \"float scale\" ",
                      disk = "Shape \"disk\" \"float radius\" .3\n",
                      metal = "Material \"conductor\" \"float roughness\" .5\nShape \"sphere\" \"float radius\" .4\n";
    const std::string mirror = "MakeNamedMaterial \"a\" \"string type\" \"conductor\" \"float roughness\" 0\n",
                      matt = "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [.7 .6 .5]\n";
    for (const std::string& rest :
         {metal + "Material \"diffuse\"\n" + lamp + "9 \"float latent:exponent\" 20 \"bool twosided\" true\n" + disk,
          metal + "Material \"diffuse\"\n" + lamp + "9 \"float latent:exponent\" 4\nScale 2 .6 1\n" + disk,
          "Material \"phong\" \"string latent:lobe\" \"retro\" \"rgb Kd\" [.2 .3 .1] \"rgb Ks\" [.6 .5 .4] \"float exponent\" 15\n"
          "Shape \"sphere\" \"float radius\" .4\nMaterial \"diffuse\"\n" +
              lamp + "5\n" + disk,
          "Material \"conductor\" \"string latent:lobe\" \"retro\" \"float roughness\" .2\nShape \"sphere\" \"float radius\" .4\n"
          "Translate .9 0 0\nMaterial \"conductor\" \"string latent:lobe\" \"retro\" \"float roughness\" 0\n"
          "Shape \"sphere\" \"float radius\" .4\nTranslate -.9 0 0\nMaterial \"diffuse\"\n" +
              lamp + "5\n" + disk,
          "Material \"dielectric\" \"bool latent:multiscatter\" true \"float roughness\" .6\nShape \"sphere\" \"float radius\" .4\n"
          "Translate .9 0 0\nMaterial \"latent:principled\" \"bool multiscatter\" true \"float metallic\" 1 \"float roughness\" "
          ".8\n"
          "Shape \"sphere\" \"float radius\" .4\nTranslate -.9 0 0\nMaterial \"diffuse\"\n" +
              lamp + "5\n" + disk,
          mirror + matt +
              "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"rgb latent:amount\" [.9 .5 .2]\n"
              "Shape \"sphere\" \"float radius\" .4\nMaterial \"diffuse\"\n" +
              lamp + "5\n" + disk,
          "Texture \"rings\" \"float\" \"latent:wood\" \"float scale\" 6\n"
          "Texture \"bark\" \"spectrum\" \"mix\" \"rgb tex1\" [.5 .3 .1] \"rgb tex2\" [.9 .7 .4] \"texture amount\" \"rings\"\n"
          "Material \"diffuse\" \"texture reflectance\" \"bark\"\nShape \"sphere\" \"float radius\" .4\nMaterial \"diffuse\"\n" +
              lamp + "5\n" + disk}) {
        SCOPED_TRACE(rest);
        expect_path_and_bdpt_agree(scene_from(room + rest), 6144, 4096);
    }
}

// A lens out of the middle, a slide before a lamp of its own, a picture by the round filter, and marble and clouds in one.
TEST(Extensions, PathAndBdptMakeOnePictureOfSlidesThroughAShiftedLens) {
    const Folder folder;
    std::vector<float> pixels;
    for (int i = 0; i < 64; ++i) pixels.insert(pixels.end(), {i % 3 == 0 ? 0.8f : 0.2f, 0.1f * static_cast<float>(i % 8), 0.5f});
    write_exr(folder / "slide.exr", 8, 8, pixels);
    expect_path_and_bdpt_agree(
        scene_of(load_scene(folder.write(
            "room.pbrt",
            "LookAt 0 -3 1.2  0 0 .3  0 0 1\nCamera \"perspective\" \"float fov\" 50 \"float lensradius\" .1 \"float "
            "focaldistance\" 3 "
            "\"float latent:lensshift\" .4\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n"
            "LightSource \"infinite\" \"rgb L\" [.1 .1 .1]\n"
            "Texture \"picture\" \"spectrum\" \"imagemap\" \"string filename\" \"slide.exr\" \"string filter\" \"latent:quartic\"\n"
            "Texture \"veins\" \"float\" \"latent:marble\" \"float scale\" 2\nTexture \"cover\" \"float\" \"latent:clouds\" "
            "\"float scale\" 3\n"
            "Texture \"both\" \"spectrum\" \"mix\" \"texture tex1\" \"picture\" \"rgb tex2\" [.6 .6 .5] \"texture amount\" "
            "\"veins\"\n"
            "Texture \"ball\" \"spectrum\" \"mix\" \"rgb tex1\" [.1 .2 .6] \"rgb tex2\" [.9 .9 .9] \"texture amount\" \"cover\"\n"
            "Material \"diffuse\" \"texture reflectance\" \"both\"\n"
            "Shape \"bilinearmesh\" \"point3 P\" [-3 -3 -.4  3 -3 -.4  -3 3 -.4  3 3 -.4]\n"
            "Material \"diffuse\" \"texture reflectance\" \"ball\"\nShape \"sphere\" \"float radius\" .4\n"
            "Translate .3 -.4 1.6\nRotate 170 1 .1 0\nLightSource \"projection\" \"float fov\" 70 \"string filename\" "
            "\"slide.exr\" "
            "\"blackbody latent:illuminant\" 2500\n"))),
        4096, 2048);
}

// With --rgb-spectra basis, an rgb is R r + G g + B b, whether a parameter, a picture or a voxel gives it.
TEST(Extensions, ColoursBySumsOfThreeCurvesAreTheSameFromAllSources) {
    const Folder folder;
    std::vector<float> pixels;
    for (int i = 0; i < 4; ++i) pixels.insert(pixels.end(), {0.8f, 0.25f, 0.125f});
    write_exr(folder / "colour.exr", 2, 2, pixels);
    const auto floor = [&](const std::string& material, color::RgbSpectra kind) {
        const std::string text =
            "LookAt 0 0 3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 30\nIntegrator \"path\" \"integer maxdepth\" 1\n"
            "WorldBegin\nLightSource \"infinite\"\n" +
            material + "Shape \"disk\" \"float radius\" 3\n";
        return scene_of(load_scene(folder.write("floor.pbrt", text), false, kind));
    };
    const auto spectral = [](const Scene& scene) {
        sampledb::Records out;
        RadianceFaults faults;
        const std::unique_ptr<Integrator> integrator = scene.integrator({.seed = 3});
        for (std::uint64_t n = 0; n < 500; ++n) integrator->trace(n, out, faults);
        return out.power;
    };
    using enum color::RgbSpectra;
    const std::string parameter = "Material \"diffuse\" \"rgb reflectance\" [.8 .25 .125]\n",
                      picture =
                          "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"colour.exr\"\n"
                          "Material \"diffuse\" \"texture reflectance\" \"c\"\n";
    const std::vector<float> a = spectral(floor(parameter, kBasis)), b = spectral(floor(picture, kBasis)),
                             smooth = spectral(floor(parameter, kSmooth));
    ASSERT_EQ(a.size(), b.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i], b[i], 2e-6f * std::abs(a[i]) + 1e-9f);
        different += std::abs(a[i] - smooth[i]) > 0.05f * smooth[i] ? 1 : 0;
    }
    EXPECT_GT(different, a.size() / 10);
    // D65 on the floor: what is seen has the colour, to the half percent of the curves, and the noise of the wavelengths.
    const Mean mean = mean_of_picture(floor(parameter, kBasis), {.seed = 1}, 20'000);
    const std::array<double, 3> rgb = color::RgbSpace::srgb().rgb_from_xyz * mean.xyz;
    EXPECT_NEAR(rgb[0], 0.8, 0.01);
    EXPECT_NEAR(rgb[1], 0.25, 0.01);
    EXPECT_NEAR(rgb[2], 0.125, 0.01);

    const auto light_of = [&](const std::string& light) {
        return scene_of(
            load_scene(folder.write("sky.pbrt", "Camera \"perspective\" \"float fov\" 5\nWorldBegin\n" + light), false, kBasis));
    };
    // A constant light is looked up at integer nm, a picture's colours between them: the mean is the same.
    const Mean sky = mean_of_picture(light_of("LightSource \"infinite\" \"rgb L\" [.8 .25 .125]\n"), {.seed = 1}, 2000),
               shown =
                   mean_of_picture(light_of("LightSource \"infinite\" \"string filename\" \"colour.exr\"\n"), {.seed = 1}, 2000);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(sky.xyz[c] / shown.xyz[c], 1, 1e-3);
}

Noise noise_of(NoiseKind kind, float scale, float variation) { return {kind, MappingDescription{}, 0.5f, 8, scale, variation}; }
float at(const Noise& noise, const Vec3f& p) {
    TexturePoint point{};
    point.p = p;
    return noise.at(point);
}

TEST(Extensions, WoodIsASawtoothAboutYAndMarbleASineAlongX) {
    const Noise wood = noise_of(NoiseKind::kWood, 4, 0), marble = noise_of(NoiseKind::kVeins, 4, 0);
    for (const float y : {-3.0f, 0.2f, 7.0f}) {
        for (const float turn : {0.1f, 2.0f, 4.0f}) {
            for (const float r : {0.02f, 0.11f, 0.24f}) {
                const Vec3f p{r * std::cos(turn), y, r * std::sin(turn)};
                EXPECT_NEAR(at(wood, p), 4 * r, 1e-5);
                EXPECT_NEAR(at(wood, p * ((r + 0.25f) / r) + Vec3f{0, y, 0}), 4 * r, 1e-4);
            }
        }
        for (const float x : {-1.3f, 0.1f, 0.9f}) {
            EXPECT_NEAR(at(marble, {x, y, 1 - y}), 0.5 + 0.5 * std::sin(8 * std::numbers::pi * static_cast<double>(x)), 1e-4);
        }
    }
}

TEST(Extensions, NoiseTexturesStayBetweenNoughtAndOne) {
    for (const NoiseKind kind : {NoiseKind::kVeins, NoiseKind::kWood, NoiseKind::kClouds}) {
        const Noise disturbed = noise_of(kind, 3, 2), straight = noise_of(kind, 3, 0);
        float least = 1, most = 0;
        int differ = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3f p{0.37f * static_cast<float>(i % 97), 0.11f * static_cast<float>(i % 41), 0.053f * static_cast<float>(i)};
            const float value = at(disturbed, p);
            least = std::min(least, value), most = std::max(most, value);
            differ += std::abs(value - at(straight, p)) > 0.01f ? 1 : 0;
        }
        EXPECT_GE(least, 0);
        EXPECT_LE(most, 1);
        EXPECT_LT(least, 0.05f);
        EXPECT_GT(most, 0.6f);
        EXPECT_GT(differ, 1000);
    }
    EXPECT_EQ(at(noise_of(NoiseKind::kWood, 1, 0), {1e30f, 0, 0}), 0);
}

}  // namespace
}  // namespace latent::render::testing
