// What a model is shown with: the camera, the sky and the ground that it lacks, and what the command line says about them.
#include "render/load/model/stage.h"

#include <gmock/gmock.h>

#include "render/math/equal_area.h"
#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::as_glb;
using ::testing::ElementsAre;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class Stage : public ::testing::Test {
 protected:
    Result<LoadedScene> try_load(const std::string& name, const std::string& text, const ModelOptions& options = {}) {
        return load_scene(folder_.write(name, text), false, color::RgbSpectra::kSmooth, options);
    }
    LoadedScene load(const std::string& name, const std::string& text, const ModelOptions& options = {}) {
        Result<LoadedScene> scene = try_load(name, text, options);
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(*scene);
    }
    // A square, and a node for each of `cameras`.
    static GltfFile with_cameras(const std::vector<std::string>& cameras) {
        GltfFile file;
        const Json position = file.add_floats({-1, -1, -3, 1, -1, -3, 1, 1, -3}, "VEC3");
        file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"material", 0}}}}}};
        file.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
        file.json["nodes"] = {{{"mesh", 0}}};
        file.json["scenes"] = {{{"nodes", {0}}}};
        file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"aspectRatio", 1}}}}};
        for (const std::string& name : cameras) {
            const std::size_t node = file.json["nodes"].size();
            file.json["nodes"].push_back({{"camera", 0}, {"name", name}, {"translation", {0, 0, static_cast<double>(node)}}});
            file.json["scenes"][0]["nodes"].push_back(node);
        }
        return file;
    }
    Folder folder_;
};

double radiance(const ImageDescription& image, const Vec3f& d) {
    const Vec2f p = square_from_sphere(d);
    const auto index = [](float x, std::uint32_t size) {
        return std::min(static_cast<std::size_t>(x * static_cast<float>(size)), std::size_t{size} - 1);
    };
    const float* rgb = &image.rgb[3 * (index(p.y, image.height) * image.width + index(p.x, image.width))];
    EXPECT_EQ(rgb[0], rgb[1]);
    EXPECT_EQ(rgb[0], rgb[2]);
    return static_cast<double>(rgb[0]);
}

TEST_F(Stage, TheSkyIsEvenWhereItIsSeenAndBrightestInItsKeyLight) {
    const LightDescription sky = load("m.obj", kTriangle).description.lights.at(0);
    ASSERT_TRUE(sky.image);
    EXPECT_NEAR(radiance(*sky.image, {0, 1, 0}), 0.7 + 25 * std::exp(25 * (0.8 / std::sqrt(1.25) - 1)), 0.02);
    EXPECT_NEAR(radiance(*sky.image, {0, -1, 0}), 0.4, 1e-6);
    EXPECT_NEAR(radiance(*sky.image, {1, -0.01f, 0}), 0.4, 1e-4);
    EXPECT_NEAR(radiance(*sky.image, {0, -0.01f, -1}), 0.4, 1e-6);
    EXPECT_NEAR(radiance(*sky.image, Vec3f(normalize(Vec3d(0.5, 0.8, 0.6)))),
                25 + 0.4 - 0.32 * 0.36 / 1.25 + 0.24 / std::sqrt(1.25), 0.1);
}

// A chrome ball shows them: what is behind the camera is neither the grey of the background nor even.
TEST_F(Stage, MirrorsSeeADarkHorizonAndTwoSoftBoxesBehindTheCamera) {
    const LightDescription sky = load("m.obj", kTriangle).description.lights.at(0);
    EXPECT_NEAR(radiance(*sky.image, {0, -0.01f, 1}), 0.08, 0.002);
    const auto at = [&](double x, double y, double z) { return radiance(*sky.image, Vec3f(normalize(Vec3d(x, y, z)))); };
    EXPECT_GT(at(-0.75, 0.5, 0.45), 2);
    EXPECT_GT(at(0.95, 0.5, -0.2), 3);
    EXPECT_LT(at(-0.95, 0.5, -0.2), 0.7);
    EXPECT_LT(at(0, 0.3, 1), 0.4);
}

// So that nobody sees where the ground ends.
TEST_F(Stage, TheGroundIsAsBrightAsTheSkyBelowTheHorizon) {
    const SceneDescription scene = load("m.obj", kTriangle).description;
    const ShapeDescription& ground = scene.shapes.at(1);
    const ImageDescription& sky = *scene.lights.at(0).image;
    double irradiance = 0;
    const double pixel = 4 * std::numbers::pi / (static_cast<double>(sky.width) * sky.height);
    for (std::uint32_t y = 0; y < sky.height; ++y) {
        for (std::uint32_t x = 0; x < sky.width; ++x) {
            const Vec3f d = sphere_from_square({(static_cast<float>(x) + 0.5f) / static_cast<float>(sky.width),
                                                (static_cast<float>(y) + 0.5f) / static_cast<float>(sky.height)});
            irradiance += pixel * std::max(static_cast<double>(d.y), 0.0) * static_cast<double>(sky.rgb[3 * (y * sky.width + x)]);
        }
    }
    const double reflectance = scene.materials.at(ground.material).spectra.at("reflectance").value(550);
    EXPECT_NEAR(reflectance * irradiance / std::numbers::pi, 0.4, 0.4 * 2e-3);
    EXPECT_LT(reflectance, 0.5);
    // It is whole about the model and gone at its edge.
    const MeshDescription& mesh = *ground.mesh;
    EXPECT_EQ(mesh.colors.front()[3], 1);
    EXPECT_EQ(mesh.colors.back()[3], 0);
    for (const Vec3f& p : mesh.positions) EXPECT_LT((Vec3d(p) + scene.origin).y, 0);  // below the lowest vertex
}

TEST_F(Stage, AGroundIsOnlyUnderModelsWithoutCameraAndLights) {
    const auto shapes = [&](const std::string& name, const std::string& text, const ModelOptions& options = {}) {
        return load(name, text, options).description.shapes.size();
    };
    EXPECT_EQ(shapes("m.obj", kTriangle), 2u);
    EXPECT_EQ(shapes("m.obj", kTriangle, {.stage = false}), 1u);
    EXPECT_EQ(shapes("a.glb", as_glb(with_cameras({}))), 2u);
    EXPECT_EQ(shapes("a.glb", as_glb(with_cameras({"a"}))), 1u);
    folder_.write("m.mtl", "newmtl a\nKe 9 9 9\n");
    EXPECT_EQ(shapes("m.obj", std::string("mtllib m.mtl\nusemtl a\n") + kTriangle), 1u);
    EXPECT_THAT(load("m.obj", kTriangle).added, ElementsAre(HasSubstr("has no camera"), HasSubstr("and a ground are added")));
    EXPECT_THAT(load("a.glb", as_glb(with_cameras({"a"})), {.stage = false}).added,
                ::testing::Contains(HasSubstr("has a camera, and so no ground: --no-stage changes nothing")));
}

TEST_F(Stage, APictureOfAModelWithoutACameraHasAnyShape) {
    const auto film = [&](const std::string& name, const std::string& text, std::optional<double> aspect) {
        const SceneDescription scene = load(name, text, {.aspect = aspect}).description;
        EXPECT_NEAR(scene.camera.x1 / scene.camera.y1, static_cast<double>(scene.film.width) / scene.film.height, 1e-9);
        return std::pair(scene.film.width, scene.film.height);
    };
    EXPECT_EQ(film("m.obj", kTriangle, std::nullopt), std::pair(1280u, 720u));
    EXPECT_EQ(film("m.obj", kTriangle, 1), std::pair(1280u, 1280u));
    EXPECT_EQ(film("m.obj", kTriangle, 0.5), std::pair(1280u, 2560u));
    EXPECT_EQ(film("a.glb", as_glb(with_cameras({"a"})), 0.5), film("a.glb", as_glb(with_cameras({"a"})), std::nullopt));
}

// Viewers show it so. A file with cameras is a scene, and so may be an OBJ file, which cannot have any.
TEST_F(Stage, AnObjectWithLightsIsShownUnderTheSkyToo) {
    GltfFile file = with_cameras({"a"});
    file.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 9;
    const auto lights = [&](const ModelOptions& options = {}) {
        const LoadedScene scene = load("a.glb", as_glb(file), options);
        return std::pair(scene.description.lights.size(), scene.description.shapes.size());
    };
    EXPECT_EQ(lights(), std::pair(std::size_t{0}, std::size_t{1}));
    file.json.erase("cameras");
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    EXPECT_EQ(lights(), std::pair(std::size_t{1}, std::size_t{2}));
    EXPECT_EQ(lights({.stage = false}), std::pair(std::size_t{0}, std::size_t{1}));
    EXPECT_THAT(load("a.glb", as_glb(file)).added,
                ElementsAre(HasSubstr("has no camera"), HasSubstr("is an object with lights of its own")));
}

TEST_F(Stage, AModelIsSeenAcrossFourFifthsOfThePictureFromEachSide) {
    const std::vector<Vec3d> corners = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}, {0, 0, 3}, {2, 0, 3}, {0, 1, 3}, {2, 1, 3}};
    for (const ModelView view : {ModelView::kThreeQuarter, ModelView::kFront, ModelView::kTop}) {
        for (const bool is_z_up : {false, true}) {
            const ModelOptions options{.view = view, .is_z_up = is_z_up};
            const CameraDescription camera = framing(corners, {}, options);
            const Affined from_world = camera.world_from_camera.inverse().value();
            double left = 1, right = -1, below = 1, above = -1;
            for (const Vec3d& p : corners) {
                const Vec3d seen = from_world.point(p);
                EXPECT_GT(seen.z, 0);
                left = std::min(left, seen.x / seen.z / camera.x1), right = std::max(right, seen.x / seen.z / camera.x1);
                below = std::min(below, seen.y / seen.z / camera.y1), above = std::max(above, seen.y / seen.z / camera.y1);
            }
            EXPECT_NEAR(std::max(right - left, above - below) / 2, 0.8, 1e-3);
            const Vec3d up = world_from_stage(options).y;
            EXPECT_EQ(up, is_z_up ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0));
            if (view != ModelView::kTop) {
                EXPECT_GT(dot(camera.world_from_camera.y, up), 0.9);
            }
            if (view == ModelView::kTop) {
                EXPECT_NEAR(dot(camera.world_from_camera.z, up), -1, 1e-12);
            }
            if (view == ModelView::kFront) {
                EXPECT_NEAR(dot(camera.world_from_camera.z, up), 0, 1e-12);
            }
        }
    }
}

TEST_F(Stage, CamerasAreChosenByNameOrNumber) {
    const std::string glb = as_glb(with_cameras({"left", "right", "", "2"}));
    const auto z_of = [&](const std::string& name) {
        const LoadedScene scene = load("a.glb", glb, {.camera = name});
        return (scene.description.camera.world_from_camera.t + scene.description.origin).z;
    };
    EXPECT_NEAR(z_of(""), 1, 1e-12);
    EXPECT_NEAR(z_of("left"), 1, 1e-12);
    EXPECT_NEAR(z_of("right"), 2, 1e-12);
    EXPECT_THAT(load("a.glb", glb, {.camera = "right"}).warnings, IsEmpty());
    EXPECT_NEAR(z_of("1"), 1, 1e-12);
    EXPECT_NEAR(z_of("3"), 3, 1e-12);
    EXPECT_NEAR(z_of("2"), 4, 1e-12);  // a name comes before a number
    EXPECT_THAT(load("a.glb", glb, {.camera = "right"}).notes, IsEmpty());
    EXPECT_THAT(load("a.glb", glb).notes,
                ElementsAre(HasSubstr("/cameras: the first is used; --camera chooses another by number or name: "
                                      "1 left, 2 right, 3, 4 2")));
    for (const char* none : {"top", "0", "5", "+1", "1 "})
        EXPECT_THAT(try_load("a.glb", glb, {.camera = none}).error().message,
                    AllOf(HasSubstr(std::string("--camera ") + none + ": "),
                          HasSubstr("has no camera of this name or number (1 left, 2 right, 3, 4 2)")));
    EXPECT_EQ(try_load("m.pbrt", "WorldBegin\nShape \"sphere\"\nLightSource \"infinite\"\n", {.camera = "a"}).error().code,
              ErrorCode::kUsage);
}

TEST_F(Stage, ALensIsFocusedOnTheMiddleOrWhereItIsSaid) {
    const std::string glb = as_glb(with_cameras({"a"}));  // at z = 1, the square at -3
    const auto camera = [&](const ModelOptions& options) { return load("a.glb", glb, options).description.camera; };
    EXPECT_EQ(camera({}).lens_radius, 0);
    EXPECT_EQ(camera({.lens_radius = 0.25}).lens_radius, 0.25);
    EXPECT_NEAR(camera({.lens_radius = 0.25}).focal_distance, 4, 1e-9);
    EXPECT_EQ(camera({.lens_radius = 0.25, .focus = 2}).focal_distance, 2);
}

TEST_F(Stage, ASkyStandsUprightOverTheModel) {
    std::vector<float> rgb;  // 1 in the upper half, 0 below
    for (int i = 0; i < 512; ++i) rgb.insert(rgb.end(), 3, i < 256 ? 1.0f : 0.0f);
    testing::write_exr(folder_ / "sky.exr", 32, 16, rgb);
    for (const bool is_z_up : {false, true}) {
        const LoadedScene scene = load("m.obj", kTriangle, {.is_z_up = is_z_up, .sky = (folder_ / "sky.exr").string()});
        ASSERT_EQ(scene.description.lights.size(), 1u);
        EXPECT_EQ(scene.description.shapes.size(), 1u);
        const LightDescription& sky = scene.description.lights[0];
        const Affined light_from_world = sky.world_from_light.inverse().value();
        const Vec3d up = is_z_up ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0);
        EXPECT_EQ(radiance(*sky.image, Vec3f(light_from_world.vector(up))), 1);
        EXPECT_EQ(radiance(*sky.image, Vec3f(light_from_world.vector(-up))), 0);
    }
    EXPECT_THAT(try_load("m.obj", kTriangle, {.sky = "none.exr"}).error().message, HasSubstr("none.exr"));
}

// Its exporter writes a lamp of W watts as 683 W / (4 pi) candela, and the radiance of emission as it is.
TEST_F(Stage, EmissionOfBlenderIsInTheUnitOfItsLamps) {
    const auto scale = [&](const char* generator, bool has_lamp, std::vector<std::string>& added) {
        GltfFile file = with_cameras({"a"});
        file.json["asset"]["generator"] = generator;
        if (has_lamp) {
            file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
            file.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
            file.json["scenes"][0]["nodes"].push_back(2);
        }
        const LoadedScene scene = load("a.glb", as_glb(file));
        added = scene.added;
        return scene.description.area_lights.at(0).scale;
    };
    std::vector<std::string> added;
    EXPECT_EQ(scale("Khronos glTF Blender I/O v4.2.70", true, added), 683);
    EXPECT_THAT(added, ElementsAre(HasSubstr("was written by Blender"), HasSubstr("by its own lights alone")));
    EXPECT_EQ(scale("Khronos glTF Blender I/O v4.2.70", false, added), 1);
    EXPECT_EQ(scale("another", true, added), 1);
    EXPECT_THAT(added, ElementsAre(HasSubstr("by its own lights alone")));
}

TEST_F(Stage, ASkyIsInTheUnitOfTheLampsOfBlender) {
    testing::write_exr(folder_ / "sky.exr", 2, 1, std::vector<float>(6, 0.5f));
    for (const auto& [generator, factor] : {std::pair{"Khronos glTF Blender I/O v4.2.70", 683.0}, std::pair{"another", 1.0}}) {
        GltfFile file = with_cameras({"a"});
        file.json["asset"]["generator"] = generator;
        file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
        const LoadedScene scene = load("a.glb", as_glb(file), {.sky = folder_ / "sky.exr"});
        EXPECT_EQ(scene.description.lights.back().scale, factor);
    }
}

}  // namespace
}  // namespace latent::render
