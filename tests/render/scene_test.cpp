// What directives mean: every one of the subset, and what is refused or ignored, by name.
#include <gmock/gmock.h>

#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/rgb_space.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::load;
using testing::load_world;
using testing::refusal;

const char* const kTriangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ]\n";

SceneDescription world(const std::string& text) {
    const Result<LoadedScene> scene = load_world(text);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? scene->description : SceneDescription{};
}
std::string refused_world(const std::string& text) { return refusal("WorldBegin\n" + text); }

double luminance(const color::Spectrum& s) { return color::photometric_sum(s); }

TEST(Scene, ProjectScenesLoad) {
    for (const char* name : {"cornell", "sodium", "conductors", "fog"}) {
        const Result<LoadedScene> scene = load_scene(std::string(LATENT_SOURCE_DIR "/scenes/") + name + ".pbrt");
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_TRUE(scene->warnings.empty()) << name << ": " << scene->warnings[0];
    }
}

TEST(Scene, ForestLoadsOnceItIsGrown) {
    const Folder folder;
    std::filesystem::copy_file(LATENT_SOURCE_DIR "/scenes/forest.pbrt", folder / "forest.pbrt");
    ASSERT_EQ(latent::testing::run({LATENT_SOURCE_DIR "/scenes/make_forest", folder.path().string()}).status, 0);
    const Result<LoadedScene> scene = load_scene(folder / "forest.pbrt");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->description.instances.size(), 400u);
    const std::vector<ShapeDescription>& tree = scene->description.objects[0].shapes;
    ASSERT_EQ(tree.size(), 2u);
    EXPECT_EQ(tree[0].mesh->indices.size() + tree[1].mesh->indices.size(), 300000u);
}

TEST(Scene, CornellIsWhatItsFileSays) {
    const SceneDescription scene = load_scene(LATENT_SOURCE_DIR "/scenes/cornell.pbrt")->description;
    EXPECT_EQ(scene.max_depth, 12u);
    EXPECT_EQ(scene.integrator, "path");
    EXPECT_EQ(scene.film.width, 256u);
    EXPECT_NEAR(scene.camera.x1, std::tan(39 / 2.0 * std::numbers::pi / 180), 1e-12);
    ASSERT_EQ(scene.shapes.size(), 8u);
    ASSERT_EQ(scene.area_lights.size(), 1u);
    EXPECT_EQ(scene.area_lights[0].scale, 12);
    EXPECT_NEAR(luminance(scene.area_lights[0].spectrum), 1, 1e-9);
    const MaterialDescription& glass = scene.materials[scene.shapes[7].material];
    EXPECT_EQ(glass.kind, MaterialKind::kDielectric);
    EXPECT_TRUE(glass.dispersive);
    EXPECT_NEAR(glass.eta(589), 1.78453, 2e-4);
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
    EXPECT_EQ(scene.materials[inner.material].kind, MaterialKind::kConductor);
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
    EXPECT_EQ(scene.materials[1].alpha_x, 0.25f);
    EXPECT_EQ(scene.lights[0].scale, 7);
    EXPECT_THAT(refused_world("Attribute \"sky\" \"float x\" 1"), HasSubstr("not one of shape, light"));
}

TEST(Scene, NamedMaterialsMayBeUsedBeforeTheyAreMade) {
    const SceneDescription scene = world(std::string("NamedMaterial \"m\"\n") + kTriangle +
                                         "MakeNamedMaterial \"m\" \"string type\" \"dielectric\" \"float eta\" 1.25\n");
    const MaterialDescription& m = scene.materials[scene.shapes[0].material];
    EXPECT_EQ(m.kind, MaterialKind::kDielectric);
    EXPECT_FALSE(m.dispersive);
    EXPECT_EQ(m.eta(500), 1.25);
    EXPECT_THAT(refused_world(std::string("NamedMaterial \"x\"\n") + kTriangle), HasSubstr("material \"x\" is not defined"));
    EXPECT_THAT(
        refused_world("MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\""),
        HasSubstr("room.pbrt:3:1: "));
}

TEST(Scene, InterfaceScattersNothing) {
    const SceneDescription scene = world(std::string("Material \"interface\"\n") + kTriangle);
    EXPECT_EQ(scene.shapes[0].material, kNone);
}

TEST(Scene, RoughnessIsRemappedBySquareRootUnlessToldNot) {
    const SceneDescription scene = world(
        "Material \"conductor\" \"float roughness\" 0.25\n"
        "Material \"dielectric\" \"float uroughness\" 0.04 \"float vroughness\" 0.09 \"bool remaproughness\" false\n");
    EXPECT_EQ(scene.materials[1].alpha_x, 0.5f);
    EXPECT_EQ(scene.materials[2].alpha_x, 0.04f);
    EXPECT_EQ(scene.materials[2].alpha_y, 0.09f);
}

TEST(Scene, IndicesNeedToBePositiveOnlyWhereWeLook) {
    const SceneDescription scene = world(
        "Material \"dielectric\" \"spectrum eta\" [ 300 0 360 1.5 830 1.4 ]\nMaterial \"dielectric\" \"spectrum eta\" [ 360 1.5 "
        "830 1.5 ]\n");
    EXPECT_TRUE(scene.materials[1].dispersive);
    EXPECT_FALSE(scene.materials[2].dispersive);
}

TEST(Scene, ConductorOfAReflectanceReflectsItAtNormalIncidence) {
    const SceneDescription scene = world("Material \"conductor\" \"spectrum reflectance\" [ 360 0.2 830 0.9 ]\n");
    for (const double lambda : {360.0, 500.0, 700.0, 830.0}) {
        const double k = scene.materials[1].k(lambda), expected = 0.2 + 0.7 * (lambda - 360) / 470;
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
    EXPECT_EQ(m[1].reflectance(600), 0.25);
    EXPECT_EQ(m[2].reflectance(600), 0.25);
    EXPECT_EQ(m[3].eta(550), color::named_spectrum("metal-Au-eta").value()(550));
    EXPECT_EQ(m[0].reflectance(600), 0.5);  // of shapes before any Material
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
    EXPECT_EQ(included->description.shapes[1].mesh->positions[0].x, 9);
    EXPECT_EQ(imported->description.shapes[1].mesh->positions[0].x, 0);
    EXPECT_EQ(imported->description.shapes[0].mesh->positions[0].x, 9);
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

TEST(Scene, CamerasThatCannotBeMappedAreRefusedWhereTheyStand) {
    EXPECT_THAT(refusal("Scale 1 2 1\n\n  Camera \"perspective\"\nWorldBegin"),
                AllOf(HasSubstr("room.pbrt:3:3: "), HasSubstr("skews or stretches")));
    EXPECT_THAT(refusal("Camera \"orthographic\" \"float lensradius\" .1\nWorldBegin"),
                AllOf(HasSubstr("room.pbrt:1:1: "), HasSubstr("lensradius")));
    EXPECT_THAT(refusal("\nCamera \"spherical\" \"string mapping\" \"mercator\"\nWorldBegin"), HasSubstr("room.pbrt:2:1: "));
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

TEST(Scene, WhatWouldMakeAnotherPictureIsAnErrorWithItsPlace) {
    struct Case {
        const char *text, *message;
    };
    for (const Case& c : {
             Case{"Material \"subsurface\"", "Material \"subsurface\" is not supported"},
             Case{"Material \"diffuse\" \"texture reflectance\" \"t\"",
                  "\"texture reflectance\" of Material \"diffuse\" is not supported"},
             Case{"Material \"diffuse\" \"rgb reflectance\" [ 2 0 0 ]", "no component above 1"},
             Case{"Material \"diffuse\" \"rgb reflectance\" [ -1 0 0 ]", "not negative"},
             Case{"Material \"diffuse\" \"spectrum reflectance\" [ 400 1 300 2 ]", "reflectance: "},
             Case{"Material \"diffuse\" \"spectrum reflectance\" \"nothing\"", "neither a known spectrum nor a file"},
             Case{"Material \"dielectric\" \"spectrum eta\" [ 400 1.5 700 1.4 ]", "must be positive from 360 to 830"},
             Case{"LightSource \"infinite\" \"string filename\" \"sky.exr\"", "sky.exr"},
             Case{"LightSource \"point\" \"spectrum I\" [ 900 1 1000 1 ]", "no visible part"},
             Case{"Shape \"sphere\" \"float phimax\" 90", "whole quadrics"},
             Case{"Shape \"sphere\" \"float zmin\" 0", "whole spheres"},
             Case{"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]",
                  "beyond the 3 vertices"},
             Case{"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 ]", "not items of 3"},
             Case{"Shape \"plymesh\" \"string filename\" \"no.ply\"", "no.ply"},
             Case{"MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Milk\"", "presets are not supported"},
             Case{"MediumInterface \"m\" \"m\"", "medium \"m\" is not defined"},
             Case{"ObjectInstance \"o\"", "object \"o\" is not defined"},
             Case{"ObjectBegin \"o\"\nObjectInstance \"p\"", "not inside ObjectBegin"},
             Case{"ObjectBegin \"o\"\nAttributeEnd", "ObjectBegin from line 2 is still open"},
             Case{"AttributeBegin", "AttributeBegin is never ended"},
             Case{"AttributeEnd", "this AttributeEnd ends nothing"},
             Case{"Camera \"perspective\"", "not after WorldBegin"},
             Case{"Transform [ 1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1 ]", "projective"},
             Case{"Transform [ 1 0 0 0  1 0 0 0  0 0 1 0  0 0 0 1 ]", "singular"},
             Case{"Scale 1 0 1", "a factor is 0"},
             Case{"Rotate 3 0 0 0", "no direction"},
             Case{"LookAt 0 0 0  0 1 0  0 1 0", "parallel to up"},
             Case{"CoordSysTransform \"x\"", "was not defined"},
             Case{"ActiveTransform StartTime", "moving things"},
             Case{"ColorSpace \"acescg\"", "ColorSpace"},
             Case{"ObjectBegin \"o\"\nAreaLightSource \"diffuse\"\nShape \"sphere\"\nObjectEnd", "lights inside ObjectBegin"},
         }) {
        const std::string message = refused_world(c.text);
        EXPECT_THAT(message, HasSubstr(c.message)) << c.text;
        EXPECT_THAT(message, ::testing::ContainsRegex("room.pbrt:[0-9]+:[0-9]+: ")) << c.text;
    }
    EXPECT_THAT(refusal("Camera \"realistic\"\nWorldBegin"), HasSubstr("Camera \"realistic\" is not supported"));
    EXPECT_THAT(refusal("Integrator \"path\" \"bool regularize\" true\nWorldBegin"), HasSubstr("regularize"));
    EXPECT_THAT(refusal("Film \"rgb\""), HasSubstr("ends before WorldBegin"));
    EXPECT_THAT(refusal("Shape \"sphere\"\nWorldBegin"), HasSubstr("not before WorldBegin"));
}

TEST(Scene, AllErrorsAreToldAtOnce) {
    const std::string message = refused_world("Material \"hair\"\nShape \"curve\"\nLightSource \"projection\"\n");
    for (const char* place : {":2:1: ", ":3:1: ", ":4:1: "}) EXPECT_THAT(message, HasSubstr(std::string("room.pbrt") + place));
}

// The warnings of a scene that is read, without the file's name: "line:column: message".
std::vector<std::string> warnings(const std::string& text, bool another_integrator = false) {
    const Folder folder;
    const Result<LoadedScene> scene = load_scene(folder.write("room.pbrt", text), another_integrator);
    EXPECT_TRUE(scene) << text << (scene ? "" : scene.error().message);
    std::vector<std::string> out;
    if (!scene) return out;
    for (const std::string& warning : scene->warnings) out.push_back(warning.substr(warning.find("room.pbrt:") + 10));
    return out;
}

TEST(Scene, WhatChangesNothingIsAWarning) {
    struct Case {
        const char *options, *world, *warning;
    };
    for (const Case& c : {
             Case{"Sampler \"halton\" \"integer pixelsamples\" 4", "", "1:1: Sampler is ignored"},
             Case{"PixelFilter \"gaussian\"", "", "1:1: PixelFilter"},
             Case{"Accelerator \"bvh\"", "", "1:1: Accelerator"},
             Case{"Option \"seed\" 3", "", "1:1: Option \"seed\" is ignored"},
             Case{"TransformTimes 0 1", "", "1:1: TransformTimes"},
             Case{"Film \"spectral\"", "", "1:1: Film \"spectral\" is ignored"},
             Case{"Film \"gbuffer\"", "", "1:1: Film \"gbuffer\" is ignored"},
             Case{"Film \"rgb\" \"string sensor\" \"canon_eos_5d\"", "", "1:1: Film: sensor \"canon_eos_5d\" is ignored"},
             Case{"Film \"rgb\" \"float iso\" 200", "", "1:1: Film: \"iso\" is ignored"},
             Case{"Film \"rgb\" \"bool savefp16\" false \"string filename\" \"x.exr\"", "",
                  "1:12: Film: ignored: \"savefp16\", \"filename\""},
             Case{"Film \"rgb\"\n \"float cropwindow\" [ 0 .5 0 1 ]", "", "2:2: Film: ignored: \"cropwindow\""},
             Case{"Film \"rgb\" \"float maxcomponentvalue\" 9", "", "1:12: Film: ignored: \"maxcomponentvalue\""},
             Case{"Film \"rgb\" \"float diagonal\" 24", "", "1:12: Film: ignored: \"diagonal\""},
             Case{"Camera \"perspective\" \"float shutterclose\" .5", "", "1:1: Camera: \"shutteropen\", \"shutterclose\" are"},
             Case{"Camera \"spherical\" \"float lensradius\" .5", "", "1:20: Camera: ignored: \"lensradius\""},
             Case{"Integrator \"sppm\"", "", "1:1: Integrator \"sppm\" is ignored: \"path\" makes"},
             Case{"Integrator \"mlt\"", "", "1:1: Integrator \"mlt\""},
             Case{"Integrator \"simplepath\"", "", "1:1: Integrator \"simplepath\""},
             Case{"Integrator \"simplevolpath\"", "", "1:1: Integrator \"simplevolpath\""},
             Case{"Integrator \"path\" \"string lightsampler\" \"bvh\"", "", "1:19: Integrator: ignored: \"lightsampler\""},
             Case{"Integrator \"path\" \"float radius\" 2", "", "1:19: Integrator: ignored: \"radius\""},
             Case{"", "Texture \"t\" \"float\" \"fbm\"", "3:1: Texture \"t\" is ignored"},
             Case{"", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer faceIndices\" 0",
                  "3:53: Shape: ignored: \"faceIndices\""},
             Case{"", "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"vector3 S\" [1 0 0 1 0 0 1 0 0]",
                  "3:53: S: tangents"},
         }) {
        EXPECT_THAT(warnings(std::string(c.options) + "\nWorldBegin\n" + c.world),
                    ::testing::ElementsAre(::testing::StartsWith(c.warning)))
            << c.options << c.world;
    }
}

TEST(Scene, IntegratorsThatMakeOurPictureNeedNoWord) {
    for (const char* name : {"path", "volpath", "bdpt"}) {
        EXPECT_THAT(warnings(std::string("Integrator \"") + name + "\" \"integer maxdepth\" 3\nWorldBegin"), IsEmpty()) << name;
    }
    EXPECT_THAT(warnings("Camera \"perspective\" \"float shutteropen\" 2 \"float shutterclose\" 3\nWorldBegin"), IsEmpty());
}

TEST(Scene, IntegratorsOfAnotherPictureAreRefusedUnlessReplaced) {
    for (const char* name : {"ambientocclusion", "function", "lightpath", "randomwalk", "directlighting", "pathh", ""}) {
        const std::string text = std::string("Integrator \"") + name + "\"\nWorldBegin\n";
        EXPECT_THAT(refusal(text), HasSubstr(std::string("room.pbrt:1:1: Integrator \"") + name + "\" is not supported"));
        EXPECT_THAT(warnings(text, true), IsEmpty()) << name;
    }
    EXPECT_THAT(warnings("Integrator \"sppm\"\nWorldBegin\n", true), IsEmpty());
}

// Every word of pbrt-v4's format that is not read is refused where it stands, if the picture would be another without it.
TEST(Scene, EveryUnsupportedWordIsNamedWhereItStands) {
    std::vector<std::string> lines;
    const auto directives = [&](const std::string& kind, std::initializer_list<const char*> types) {
        for (const char* type : types) lines.push_back(kind + " \"" + type + "\"");
    };
    directives("Shape", {"curve", "cylinder", "loopsubdiv", "nurbs"});
    directives("Material", {"coatedconductor", "coateddiffuse", "diffusetransmission", "hair", "measured", "mix", "subsurface"});
    directives("LightSource", {"goniometric", "projection"});
    directives("AreaLightSource", {"area"});
    directives("ColorSpace", {"aces2065-1"});
    for (const char* type : {"uniformgrid", "rgbgrid", "cloud", "nanovdb"})
        lines.push_back(std::string("MakeNamedMedium \"m\" \"string type\" \"") + type + "\"");

    const auto parameters = [&](const std::string& directive, std::initializer_list<const char*> unsupported) {
        for (const char* parameter : unsupported) lines.push_back(directive + " " + parameter);
    };
    const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ]";
    parameters(triangle, {"\"float alpha\" 0.5", "\"texture alpha\" \"t\""});
    parameters("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]", {"\"string emissionfilename\" \"x.exr\""});
    parameters("Shape \"sphere\"", {"\"float phimax\" 180", "\"float zmin\" 0", "\"float zmax\" 0.5"});
    parameters("Shape \"disk\"", {"\"float phimax\" 90"});
    parameters("Material \"diffuse\"", {"\"texture reflectance\" \"t\"", "\"string normalmap\" \"n.png\"", "\"float sigma\" 20",
                                        "\"texture displacement\" \"t\""});
    parameters("Material \"conductor\"", {"\"texture roughness\" \"t\"", "\"texture eta\" \"t\""});
    parameters("Material \"dielectric\"", {"\"texture uroughness\" \"t\"", "\"rgb reflectance\" [ 1 1 1 ]"});
    parameters("AreaLightSource \"diffuse\"", {"\"string filename\" \"x.exr\""});
    parameters("LightSource \"infinite\"", {"\"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ]"});
    parameters("LightSource \"spot\"", {"\"string filename\" \"x.exr\""});
    parameters("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1]",
               {"\"string preset\" \"Apple\"", "\"rgb Le\" [1 1 1]", "\"float Lescale\" 2"});
    parameters("Attribute \"shape\"", {"\"float alpha\" 0.5", "\"string emissionfilename\" \"x.exr\""});
    parameters("Attribute \"light\"", {"\"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ]"});
    parameters("Attribute \"material\"", {"\"texture reflectance\" \"t\"", "\"string normalmap\" \"n.png\""});
    parameters("Attribute \"medium\"", {"\"rgb Le\" [1 1 1]", "\"string preset\" \"Apple\""});
    parameters("Option", {"\"forcediffuse\" true", "\"disablepixeljitter\" true", "\"disablewavelengthjitter\" true", "\"new\" 1"});
    lines.push_back("ActiveTransform EndTime");

    std::string text = "WorldBegin";
    for (const std::string& line : lines) text += "\n" + line;
    const std::string message = refusal(text);
    for (std::size_t i = 0; i < lines.size(); ++i)
        EXPECT_THAT(message, HasSubstr("room.pbrt:" + std::to_string(i + 2) + ":")) << lines[i];
    for (const char* option : {"Camera \"realistic\"", "Film \"image\"", "Camera \"perspective\" \"float fovv\" 20",
                               "Film \"rgb\" \"integer yres\" 20", "Integrator \"path\" \"integer depth\" 20"}) {
        EXPECT_THAT(refusal(std::string(option) + "\nWorldBegin"), HasSubstr("room.pbrt:1:")) << option;
    }
}

TEST(Scene, InheritedParametersThatWouldBeMissedAreRefused) {
    EXPECT_THAT(refused_world("Attribute \"light\" \"string filename\" \"x.exr\"\nAreaLightSource \"diffuse\""),
                HasSubstr("room.pbrt:2:19: filename: images on area lights are not supported"));
    EXPECT_THAT(refused_world("Attribute \"light\" \"float scale\" 2\nAttributeBegin\nAttribute \"light\" \"float scale\" 3"),
                HasSubstr("room.pbrt:4:19: Attribute: \"scale\" is inherited already"));
}

TEST(Scene, TangentsMatterWhereRoughnessHasADirection) {
    const std::string shape = std::string(kTriangle) + "\"vector3 S\" [ 1 0 0  1 0 0  1 0 0 ]\n";
    EXPECT_THAT(refused_world("Material \"conductor\" \"float uroughness\" 0.1 \"float vroughness\" 0.2\n" + shape),
                HasSubstr("room.pbrt:4:1: S: tangents"));
}

TEST(SceneContent, IsThePictureNotTheText) {
    const Folder folder;
    const auto content = [&](const std::string& text) { return load_scene(folder.write("room.pbrt", text))->content; };
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty "
        "list uchar int vertex_indices\n"
        "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    folder.write("a.ply", ply);
    folder.write("b.ply", ply);
    folder.write("c.ply", ply + " ");
    folder.write("inc.pbrt", "Translate 1 0 0\n");
    const Hash128 original = content("WorldBegin\nTranslate 1 0 0\nShape \"plymesh\" \"string filename\" \"a.ply\"");
    EXPECT_EQ(
        content(
            "# a comment\nSampler \"sobol\"\nWorldBegin Translate 1.0 -0 0e3\nShape \"plymesh\" \"string filename\" [ \"a.ply\" ]"),
        original);
    EXPECT_EQ(content("WorldBegin\nInclude \"inc.pbrt\"\nShape \"plymesh\" \"string filename\" \"b.ply\""), original);
    EXPECT_NE(content("WorldBegin\nTranslate 1 0 0\nShape \"plymesh\" \"string filename\" \"c.ply\""), original);
    EXPECT_NE(content("WorldBegin\nTranslate 1 0 1e-9\nShape \"plymesh\" \"string filename\" \"a.ply\""), original);
    EXPECT_NE(content("WorldBegin\nTranslate 1 0 0\nReverseOrientation\nShape \"plymesh\" \"string filename\" \"a.ply\""),
              original);
}

}  // namespace
}  // namespace latent::render
