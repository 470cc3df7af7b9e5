// What directives mean: every one of the subset.
#include <gmock/gmock.h>

#include "base/small_file.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/rgb_space.h"
#include "render/scene/shape_counts.h"
#include "tests/render/scenes.h"
#include "tests/support/paths.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;
using testing::in_world;
using ::testing::IsEmpty;
using testing::load;
using testing::load_world;
using testing::refused_world;

const char* const kTriangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ]\n";

SceneDescription world(const std::string& text) {
    const Result<LoadedScene> scene = load_world(text);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? in_world(scene->description) : SceneDescription{};
}

double luminance(const color::Spectrum& s) { return color::photometric_sum(s); }

TEST(Scene, ProjectScenesLoad) {
    int loaded = 0;
    for (const auto& entry : std::filesystem::directory_iterator(latent::testing::in_tree("scenes"))) {
        const std::filesystem::path& path = entry.path();
        if (path.extension() != ".pbrt" || path.stem().string().starts_with("forest")) continue;  // which is below
        const Result<LoadedScene> scene = load_scene(path);
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_TRUE(scene->warnings.empty()) << path << ": " << scene->warnings[0];
        ++loaded;
    }
    EXPECT_GT(loaded, 8);
}

TEST(Scene, ItsSizeCountsAnObjectOnceInMemoryAndOncePerInstanceInTheWorld) {
    const std::string patch = "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  2 0.5 0  0.25 1 0  2.25 1.5 ";
    const std::string object = "ObjectBegin \"o\"\n" + std::string(kTriangle) + patch + "1 ]\nShape \"sphere\"\n" +
                               "Shape \"curve\" \"integer degree\" 2 \"point3 P\" [ 0 0 0 1 0 0 2 1 0 3 1 0 4 0 0 ]\nObjectEnd\n";
    const SceneSize size = size_of(world(object + kTriangle + patch + "0 ]\nShape \"disk\"\nShape \"cylinder\"\n" +
                                         "ObjectInstance \"o\"\nTranslate 9 0 0\nObjectInstance \"o\"\n"));
    // A flat patch is two triangles.
    EXPECT_EQ(size.stored, (ShapeCounts{.triangles = 4, .patches = 1, .curve_segments = 2, .quadrics = 3}));
    EXPECT_EQ(size.placed, (ShapeCounts{.triangles = 5, .patches = 2, .curve_segments = 4, .quadrics = 4}));
    EXPECT_EQ(size.instances, 2u);
}

TEST(Scene, JewelsAreWhatTheirScriptWrites) {
    const Folder folder;
    ASSERT_EQ(latent::testing::run({latent::testing::in_tree("scenes/make_jewels"), folder.path().string()}).status, 0);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        const std::string name = entry.path().filename();
        const auto text = [](const std::filesystem::path& path) {
            return read_small_file(path, 1 << 20, "a part of a scene").value();
        };
        EXPECT_TRUE(text(entry.path()) == text(latent::testing::in_tree("scenes/jewels/" + name))) << name;
    }
}

TEST(Scene, ForestLoadsOnceItIsGrown) {
    const Folder folder;
    std::filesystem::copy_file(latent::testing::in_tree("scenes/forest.pbrt"), folder / "forest.pbrt");
    ASSERT_EQ(latent::testing::run({latent::testing::in_tree("scenes/make_forest"), folder.path().string()}).status, 0);
    const Result<LoadedScene> scene = load_scene(folder / "forest.pbrt");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->description.instances.size(), 400u);
    const std::vector<ShapeDescription>& tree = scene->description.objects[0].shapes;
    ASSERT_EQ(tree.size(), 2u);
    EXPECT_EQ(tree[0].mesh->indices.size() + tree[1].mesh->indices.size(), 300000u);
}

TEST(Scene, CornellIsWhatItsFileSays) {
    const SceneDescription scene = load_scene(latent::testing::in_tree("scenes/cornell.pbrt"))->description;
    EXPECT_EQ(scene.max_depth, 12u);
    EXPECT_EQ(scene.integrator, "path");
    EXPECT_EQ(scene.film.width, 256u);
    EXPECT_NEAR(scene.camera.x1, std::tan(39 / 2.0 * std::numbers::pi / 180), 1e-12);
    ASSERT_EQ(scene.shapes.size(), 8u);
    ASSERT_EQ(scene.area_lights.size(), 1u);
    EXPECT_EQ(scene.area_lights[0].scale, 12);
    EXPECT_NEAR(luminance(scene.area_lights[0].spectrum), 1, 1e-9);
    const MaterialDescription& glass = scene.materials[scene.shapes[7].material];
    EXPECT_EQ(glass.type, "dielectric");
    EXPECT_NEAR(glass.spectra.at("eta").value(589), 1.78453, 2e-4);
}

TEST(Scene, AttributeBlocksRestoreEverything) {
    const SceneDescription scene =
        world(std::string("AttributeBegin\nTranslate 5 0 0\nReverseOrientation\nMaterial \"conductor\"\n"
                          "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nMediumInterface \"fog\" \"\"\n") +
              kTriangle +
              "AttributeEnd\nMakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] "
              "\"rgb sigma_s\" [0 0 0]\n" +
              kTriangle);
    ASSERT_EQ(scene.shapes.size(), 2u);
    const ShapeDescription &inner = scene.shapes[0], &outer = scene.shapes[1];
    EXPECT_EQ(inner.mesh->positions[1], Vec3f(6, 0, 0));
    EXPECT_TRUE(inner.flip_normal);
    EXPECT_EQ(scene.materials[inner.material].type, "conductor");
    EXPECT_EQ(inner.area_light, 0u);
    EXPECT_EQ(inner.inside_medium, 0u);
    EXPECT_EQ(inner.outside_medium, kNone);
    EXPECT_EQ(scene.media[0].name, "fog");
    EXPECT_EQ(outer.mesh->positions[1], Vec3f(1, 0, 0));
    EXPECT_FALSE(outer.flip_normal);
    EXPECT_EQ(outer.material, 0u);
    EXPECT_EQ(outer.area_light, kNone);
    EXPECT_EQ(outer.inside_medium, kNone);
}

TEST(Scene, AttributeDirectiveGivesParametersThatNeedNotBeUsed) {
    const SceneDescription scene =
        world(std::string("Attribute \"material\" \"float roughness\" 0.25 \"rgb reflectance\" [.2 .2 .2]\n"
                          "Material \"conductor\" \"bool remaproughness\" false\nAttribute \"light\" \"float scale\" 7\n") +
              "LightSource \"point\"\n");
    EXPECT_EQ(scene.materials[1].number("alpha_x").value, 0.25f);
    EXPECT_EQ(scene.lights[0].scale, 7);
    EXPECT_THAT(refused_world("Attribute \"sky\" \"float x\" 1"), HasSubstr("not one of shape, light"));
}

TEST(Scene, NamedMaterialsMayBeUsedBeforeTheyAreMade) {
    const SceneDescription scene = world(std::string("NamedMaterial \"m\"\n") + kTriangle +
                                         "MakeNamedMaterial \"m\" \"string type\" \"dielectric\" \"float eta\" 1.25\n");
    const MaterialDescription& m = scene.materials[scene.shapes[0].material];
    EXPECT_EQ(m.type, "dielectric");
    EXPECT_EQ(m.spectra.at("eta").value(500), 1.25);
    EXPECT_THAT(refused_world(std::string("NamedMaterial \"x\"\n") + kTriangle), HasSubstr("material \"x\" is not defined"));
    EXPECT_THAT(
        refused_world("MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\""),
        HasSubstr("room.pbrt:3:1: "));
}

TEST(Scene, InterfaceScattersNothing) {
    const SceneDescription scene = world(std::string("Material \"interface\"\n") + kTriangle);
    EXPECT_EQ(scene.shapes[0].material, kNone);
    for (const std::string old_name : {"none", ""})
        EXPECT_EQ(world("Material \"" + old_name + "\"\n" + kTriangle).shapes[0].material, kNone);
}

TEST(Scene, RoughnessIsRemappedBySquareRootUnlessToldNot) {
    const SceneDescription scene = world(
        "Material \"conductor\" \"float roughness\" 0.25\n"
        "Material \"dielectric\" \"float uroughness\" 0.04 \"float vroughness\" 0.09 \"bool remaproughness\" false\n");
    EXPECT_EQ(scene.materials[1].number("alpha_x").value, 0.5f);
    EXPECT_EQ(scene.materials[2].number("alpha_x").value, 0.04f);
    EXPECT_EQ(scene.materials[2].number("alpha_y").value, 0.09f);
}

TEST(Scene, IndicesNeedToBePositiveOnlyWhereWeLook) {
    const SceneDescription scene = world("Material \"dielectric\" \"spectrum eta\" [ 300 0 360 1.5 830 1.4 ]\n");
    EXPECT_EQ(scene.materials[1].spectra.at("eta").value(360), 1.5);
}

TEST(Scene, ConductorOfAReflectanceReflectsItAtNormalIncidence) {
    const SceneDescription scene = world("Material \"conductor\" \"spectrum reflectance\" [ 360 0.2 830 0.9 ]\n");
    for (const double lambda : {360.0, 500.0, 700.0, 830.0}) {
        const double k = scene.materials[1].spectra.at("k").value(lambda), expected = 0.2 + 0.7 * (lambda - 360) / 470;
        EXPECT_NEAR(k * k / (4 + k * k), expected, 1e-9);
    }
}

TEST(Scene, LightsAreNormalisedToLuminanceOne) {
    const SceneDescription scene = world(
        "LightSource \"point\" \"spectrum I\" [ 360 3 830 3 ] \"point3 from\" [1 2 3] \"float power\" 5\n"
        "LightSource \"spot\" \"blackbody I\" 2856 \"float coneangle\" 20 \"float conedeltaangle\" 3 \"point3 to\" [0 -1 0]\n"
        "LightSource \"distant\" \"spectrum L\" \"stdillum-A\" \"float illuminance\" 2\n"
        "LightSource \"infinite\" \"rgb L\" [ 2 2 2 ] \"float scale\" 3\n"
        "LightSource \"infinite\"\n");
    ASSERT_EQ(scene.lights.size(), 5u);
    for (const std::size_t i : {0, 1, 2, 4}) EXPECT_NEAR(luminance(scene.lights[i].spectrum), 1, 1e-9) << i;
    EXPECT_NEAR(luminance(scene.lights[3].spectrum), 2, 1e-6);  // only the illuminant of an rgb is normalised
    EXPECT_EQ(scene.lights[0].power, 5);
    EXPECT_EQ(scene.lights[1].cone_degrees, 20);
    EXPECT_EQ(scene.lights[2].illuminance, 2);
    EXPECT_EQ(scene.lights[3].scale, 3);
}

TEST(Scene, ColouredRgbLightHasTheChromaticityOfItsRgb) {
    const SceneDescription scene = world("LightSource \"infinite\" \"rgb L\" [ 0.9 0.5 0.2 ]\n");
    const color::Xyz xyz = color::xyz_from_spectrum(scene.lights[0].spectrum, color::Observer::cie1931());
    const std::array<double, 3> rgb = color::RgbSpace::srgb().rgb_from_xyz * std::array<double, 3>{xyz.x, xyz.y, xyz.z};
    EXPECT_NEAR(rgb[0], 0.9, 3e-3);
    EXPECT_NEAR(rgb[1], 0.5, 3e-3);
    EXPECT_NEAR(rgb[2], 0.2, 3e-3);
}

TEST(Scene, PhongHasTwoReflectancesAndAnExponent) {
    const SceneDescription scene = world(
        "Material \"phong\" \"spectrum Kd\" [ 360 0.4 830 0.5 ] \"spectrum Ks\" [ 360 0.3 830 0.2 ] \"float exponent\" 75\n"
        "Material \"phong\"\n");
    ASSERT_EQ(scene.materials[1].type, "phong");
    EXPECT_EQ(scene.materials[1].spectra.at("Kd").value(830), 0.5);
    EXPECT_EQ(scene.materials[1].spectra.at("Ks").value(360), 0.3);
    EXPECT_EQ(scene.materials[1].number("exponent").value, 75);
    EXPECT_EQ(scene.materials[2].spectra.at("Kd").value(500) + scene.materials[2].spectra.at("Ks").value(500), 0.5);
    EXPECT_THAT(refused_world("Material \"phong\" \"float exponent\" -1"), HasSubstr("exponent"));
}

TEST(Scene, PhongTransmitsAboutTheRefractedDirection) {
    const SceneDescription scene = world(
        "Material \"latent:phongtransmission\" \"spectrum Ks\" [ 360 0.3 830 0.2 ] \"float exponent\" 75 \"float eta\" 1.5\n"
        "Material \"latent:phongtransmission\"\n");
    ASSERT_EQ(scene.materials[1].type, "phongtransmission");
    EXPECT_EQ(scene.materials[1].spectra.at("Ks").value(360), 0.3);
    EXPECT_EQ(scene.materials[1].number("exponent").value, 75);
    EXPECT_EQ(scene.materials[1].number("eta").value, 1.5f);
    EXPECT_EQ(scene.materials[2].number("eta").value, 1);
    EXPECT_THAT(refused_world("Material \"latent:phongtransmission\" \"float eta\" 0"), HasSubstr("eta"));
}

TEST(Scene, SpectraComeInlineByNameFromFilesAndAsRgb) {
    const Folder folder;
    folder.write("grey.spd", "# two samples\n360 0.25\n830 0.25\n");
    const Result<LoadedScene> scene =
        load_scene(folder.write("room.pbrt",
                                "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" \"grey.spd\"\n"
                                "Material \"diffuse\" \"rgb reflectance\" [ .25 .25 .25 ]\n"
                                "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"\n"));
    ASSERT_TRUE(scene) << scene.error().message;
    const std::vector<MaterialDescription>& m = scene->description.materials;
    EXPECT_EQ(m[1].spectra.at("reflectance").value(600), 0.25);
    EXPECT_EQ(m[2].spectra.at("reflectance").value(600), 0.25);
    EXPECT_EQ(m[3].spectra.at("eta").value(550), color::named_spectrum("metal-Au-eta").value()(550));
    EXPECT_EQ(m[0].spectra.at("reflectance").value(600), 0.5);  // of shapes before any Material
}

TEST(Scene, ObjectsKeepTheirShapesAndInstancesTheirTransformations) {
    const SceneDescription scene =
        world(std::string("ObjectBegin \"o\"\nTranslate 0 1 0\n") + kTriangle +
              "ObjectEnd\nAttributeBegin\nTranslate 3 0 0\nObjectInstance \"o\"\nAttributeEnd\nObjectInstance \"o\"\n");
    EXPECT_THAT(scene.shapes, IsEmpty());
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].shapes[0].mesh->positions[0], Vec3f(0, 1, 0));
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].world_from_object.t, Vec3d(3, 0, 0));
    EXPECT_EQ(scene.instances[1].world_from_object.t, Vec3d(0, 0, 0));
}

TEST(Scene, ImportKeepsItsStateToItself) {
    const Folder folder;
    folder.write("a.pbrt", std::string("Translate 9 0 0\nMaterial \"conductor\"\n") + kTriangle);
    const Result<LoadedScene> included =
        load_scene(folder.write("i.pbrt", std::string("WorldBegin\nInclude \"a.pbrt\"\n") + kTriangle));
    const Result<LoadedScene> imported =
        load_scene(folder.write("j.pbrt", std::string("WorldBegin\nImport \"a.pbrt\"\n") + kTriangle));
    ASSERT_TRUE(included && imported);
    EXPECT_EQ(in_world(included->description).shapes[1].mesh->positions[0].x, 9);
    EXPECT_EQ(in_world(imported->description).shapes[1].mesh->positions[0].x, 0);
    EXPECT_EQ(in_world(imported->description).shapes[0].mesh->positions[0].x, 9);
}

TEST(Scene, ParallelogramsBecomePairsOfTrianglesOtherPatchesStay) {
    const SceneDescription scene = world(
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  2 0 0  0 1 0  2 1 0   0 0 5  1 0 5  0 1 5  1 1 6 ]\n"
        "  \"integer indices\" [ 0 1 2 3  4 5 6 7 ]\n");
    ASSERT_EQ(scene.shapes.size(), 2u);
    EXPECT_EQ(scene.shapes[0].kind, ShapeKind::kTriangles);
    EXPECT_TRUE(scene.shapes[0].pairs);
    EXPECT_EQ(scene.shapes[0].mesh->indices.size(), 6u);
    EXPECT_EQ(scene.shapes[1].kind, ShapeKind::kBilinear);
    EXPECT_EQ(scene.shapes[1].mesh->indices.size(), 4u);
}

TEST(Scene, CamerasResolveTheirWindow) {
    const auto camera = [](const std::string& text) {
        return load("Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n" + text + "\nWorldBegin\n")
            ->description.camera;
    };
    const CameraDescription wide = camera("Camera \"perspective\" \"float fov\" 90");
    EXPECT_NEAR(wide.y1, 1, 1e-12);  // fov spans the shorter axis
    EXPECT_NEAR(wide.x1, 2, 1e-12);
    const CameraDescription lens = camera("Camera \"perspective\" \"float lensradius\" .1 \"float focaldistance\" 4");
    EXPECT_EQ(lens.lens_radius, .1);
    EXPECT_EQ(lens.focal_distance, 4);
    const CameraDescription window = camera("Camera \"orthographic\" \"float screenwindow\" [ -1 3 -2 2 ]");
    EXPECT_EQ(window.kind, CameraKind::kOrthographic);
    EXPECT_EQ(window.x1, 3);
    EXPECT_EQ(window.y0, -2);
    EXPECT_EQ(camera("Camera \"spherical\"").mapping, SphericalMapping::kEqualArea);
    EXPECT_EQ(camera("Camera \"spherical\" \"string mapping\" \"equirectangular\"").mapping, SphericalMapping::kEquirectangular);
    EXPECT_NEAR(camera("").x1, 2, 1e-12);  // no Camera: perspective, 90 degrees
}

TEST(Scene, CameraLiesInTheMediumOutsideAtItsDirective) {
    const Result<LoadedScene> scene = load(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [0 0 0] \"float scale\" 3 "
        "\"float g\" .3\n"
        "MediumInterface \"fog\"\nCamera \"perspective\"\nWorldBegin\nMediumInterface \"\" \"\"\n");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->description.camera.medium, 0u);
    EXPECT_EQ(scene->description.media[0].scale, 3);
    EXPECT_EQ(scene->description.media[0].g, .3);
}

}  // namespace
}  // namespace latent::render
