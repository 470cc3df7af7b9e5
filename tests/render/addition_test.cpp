// --add: a scene in two files is the scene in one, and a model is lit and seen as a pbrt file says.
#include <gmock/gmock.h>

#include "render/scene/content_hash.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using ::testing::HasSubstr;

constexpr const char* kSideCamera = "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n";
constexpr const char* kOneTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class Addition : public ::testing::Test {
 protected:
    Result<LoadedScene> try_load(const std::string& name, const std::string& text, const std::vector<std::string>& additions) {
        std::vector<std::filesystem::path> files;
        for (const std::string& addition : additions)
            files.push_back(folder_.write("more" + std::to_string(files.size()) + ".pbrt", addition));
        return load_scene(folder_.write(name, text), false, color::RgbSpectra::kSmooth, {}, files);
    }
    SceneDescription load(const std::string& name, const std::string& text, const std::vector<std::string>& additions = {}) {
        Result<LoadedScene> scene = try_load(name, text, additions);
        if (!scene) throw std::runtime_error(scene.error().message);
        EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
        return std::move(scene->description);
    }
    Folder folder_;
};

// Each uses every kind of table: textures, materials, media, area lights, objects.
std::string furnished(const std::string& name, const char* number) {
    return "AttributeBegin\nTranslate 0 " + std::string(number) + " 0\nTexture \"" + name +
           "\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [ ." + number + " .5 .5 ]\nMakeNamedMaterial \"" + name +
           "\" \"string type\" \"diffuse\" \"texture reflectance\" \"" + name + "\"\nMakeNamedMaterial \"both " + name +
           "\" \"string type\" \"mix\" \"string materials\" [ \"" + name + "\" \"" + name + "\" ] \"float amount\" ." + number +
           "\nMakeNamedMedium \"" + name + "\" \"string type\" \"homogeneous\" \"float scale\" " + number +
           "\nMakeNamedMedium \"twice " + name + "\" \"string type\" \"latent:sum\" \"string latent:media\" [ \"" + name + "\" \"" +
           name + "\" ]\nObjectBegin \"" + name + "\"\nNamedMaterial \"both " + name +
           "\"\nShape \"sphere\"\nObjectEnd\nObjectInstance \"" + name + "\"\nTranslate 3 0 0\nObjectInstance \"" + name +
           "\"\nMediumInterface \"twice " + name + "\" \"\"\nNamedMaterial \"" + name +
           "\"\nShape \"sphere\"\nMediumInterface \"\" \"\"\nAreaLightSource \"diffuse\" \"float scale\" " + number +
           "\nShape \"sphere\" \"float radius\" .5\nLightSource \"point\" \"float scale\" " + number + "\nAttributeEnd\n";
}

TEST_F(Addition, ASceneInTwoFilesIsTheSceneInOne) {
    const std::string begin = std::string(kSideCamera) + "WorldBegin\n";
    const Hash128 whole = content_hash(load("a.pbrt", begin + furnished("a", "1") + furnished("b", "2") + furnished("c", "3")));
    // Names are those of a file.
    EXPECT_EQ(
        content_hash(load("a.pbrt", begin + furnished("a", "1"), {furnished("a", "2"), "WorldBegin\n" + furnished("a", "3")})),
        whole);
    EXPECT_NE(content_hash(load("a.pbrt", begin + furnished("a", "1"), {furnished("a", "2")})), whole);
}

TEST_F(Addition, BringsItsCameraWithItsFilmAndItsIntegrator) {
    const std::string other =
        "Film \"rgb\" \"integer xresolution\" 30 \"integer yresolution\" 20\nIntegrator \"bdpt\" \"integer maxdepth\" 9\n";
    const SceneDescription seen = load("a.pbrt", std::string(kSideCamera) + "WorldBegin\n" + furnished("a", "1"),
                                       {other + "Translate 0 0 7\n" + kSideCamera + "WorldBegin\n"}),
                           same = load("b.pbrt", other + "Translate 0 0 7\n" + kSideCamera + "WorldBegin\n" + furnished("a", "1"));
    EXPECT_EQ(content_hash(seen), content_hash(same));
    EXPECT_EQ(seen.film.width, 30u);
    EXPECT_EQ(seen.integrator, "bdpt");
    EXPECT_EQ(seen.max_depth, 9u);
    const SceneDescription kept = load(
        "a.pbrt", std::string(kSideCamera) + "Integrator \"bdpt\" \"integer maxdepth\" 7\nWorldBegin\n", {furnished("a", "1")});
    EXPECT_EQ(kept.integrator, "bdpt");
    EXPECT_EQ(kept.max_depth, 7u);
    // Paths through a model have any length, unless it is said.
    EXPECT_EQ(load("a.obj", kOneTriangle).max_depth, kUnlimited);
    EXPECT_EQ(load("a.obj", kOneTriangle, {furnished("a", "1")}).max_depth, kUnlimited);
    EXPECT_EQ(load("a.obj", kOneTriangle, {"Integrator \"path\" \"integer maxdepth\" 3\n"}).max_depth, 3u);
}

TEST_F(Addition, LightsAModelInsteadOfTheSkyThatItLacks) {
    const char* const lamp = "Translate 1 2 3\nLightSource \"point\"\n";
    const SceneDescription alone = load("a.obj", kOneTriangle), lit = load("a.obj", kOneTriangle, {lamp});
    ASSERT_EQ(lit.lights.size(), 1u);
    EXPECT_EQ(lit.lights[0].kind, LightKind::kPoint);
    const Vec3d place = lit.lights[0].world_from_light.t + lit.origin;
    EXPECT_LT(max_abs(place - Vec3d(1, 2, 3)), 1e-9);
    EXPECT_EQ(lit.shapes.size() + 1, alone.shapes.size());  // without a ground
    // A lamp with a shape, too; the model is framed as it is by itself.
    const SceneDescription glowing =
        load("a.obj", kOneTriangle, {"AreaLightSource \"diffuse\" \"float scale\" .1\nTranslate 50 0 0\nShape \"sphere\"\n"});
    EXPECT_TRUE(glowing.lights.empty());
    const auto place_of_camera = [](const SceneDescription& scene) { return scene.camera.world_from_camera.t + scene.origin; };
    EXPECT_LT(max_abs(place_of_camera(glowing) - place_of_camera(alone)), 1e-12);
}

TEST_F(Addition, AModelIsNotMirroredByACameraOfPbrt) {
    const auto axes = [&](const std::string& camera) {
        return load("a.obj", kOneTriangle, {camera + "WorldBegin\n"}).camera.world_from_camera;
    };
    const Affined plain = axes(kSideCamera), turned = axes(std::string("Scale -1 1 1\n") + kSideCamera);
    EXPECT_LT(max_abs(plain.x - Vec3d(-1, 0, 0)), 1e-12);  // seen from -z, +x of a right-handed world is on the left
    EXPECT_LT(max_abs(plain.x - turned.x) + max_abs(plain.y - turned.y) + max_abs(plain.z - turned.z), 1e-12);
}

TEST_F(Addition, WhatCannotBeAddedIsRefused) {
    const auto refused = [&](const std::string& addition) {
        const Result<LoadedScene> scene = try_load("a.obj", kOneTriangle, {addition});
        return scene ? "" : scene.error().message;
    };
    EXPECT_THAT(refused(std::string(kSideCamera) + "Shape \"sphere\"\n"),
                HasSubstr("more0.pbrt:3:1: Shape: must come after WorldBegin"));
    EXPECT_THAT(refused("NamedMaterial \"a\"\nShape \"sphere\"\n"),
                HasSubstr("more0.pbrt:1:1: material \"a\" is not defined anywhere"));
    EXPECT_THAT(refused("Shape \"ball\"\n"), HasSubstr("more0.pbrt:1:1: "));
    const Result<LoadedScene> model = load_scene(folder_.write("a.obj", kOneTriangle), false, color::RgbSpectra::kSmooth, {},
                                                 {folder_.write("b.obj", kOneTriangle)});
    EXPECT_THAT(model.error().message, HasSubstr("b.obj: must be in the language of pbrt"));
}

}  // namespace
}  // namespace latent::render
