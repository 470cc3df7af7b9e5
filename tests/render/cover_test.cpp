// What a camera sees in a closed space without lamps: where no sky comes in, what hides it shines.
#include <gmock/gmock.h>

#include "tests/render/models.h"
#include "tests/render/scenes.h"
#include "tests/transport/picture_mean.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

struct Cube {
    double half;                    // of its side, its middle at the origin
    double reflectance = 0.5;       // of a matt grey
    std::array<double, 3> at = {};  // its middle
};

// A cube each, and a camera at the origin.
GltfFile cubes(const std::vector<Cube>& cubes, std::initializer_list<std::uint32_t> faces) {
    GltfFile file;
    const Json position =
                   file.add_floats({-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1}, "VEC3"),
               indices = file.add_indices(faces);
    file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"aspectRatio", 1}}}}};
    file.json["nodes"] = {{{"camera", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    for (const Cube& cube : cubes) {
        const std::size_t i = file.json["nodes"].size();
        file.json["materials"].push_back(
            {{"pbrMetallicRoughness",
              {{"baseColorFactor", {cube.reflectance, cube.reflectance, cube.reflectance, 1}}, {"metallicFactor", 0}}},
             {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
        file.json["meshes"].push_back(
            {{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}, {"material", i - 1}}}}});
        file.json["nodes"].push_back({{"mesh", i - 1}, {"translation", cube.at}, {"scale", {cube.half, cube.half, cube.half}}});
        file.json["scenes"][0]["nodes"].push_back(i);
    }
    return file;
}

const std::initializer_list<std::uint32_t> kClosed = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

class Cover : public ::testing::Test {
 protected:
    LoadedScene load(const std::vector<Cube>& seen, const ModelOptions& options = {}) const {
        return load_all(cubes(seen, kClosed), options);
    }
    LoadedScene load_all(const GltfFile& file, const ModelOptions& options = {}) const {
        return load_scene(folder_.write("room.glb", as_glb(file)), false, color::RgbSpectra::kSmooth, options).value();
    }
    // Of each shape, whether it shines.
    static std::vector<bool> shining(const LoadedScene& scene) {
        std::vector<bool> shine;
        for (const ShapeDescription& shape : scene.description.shapes) shine.push_back(shape.area_light != kNone);
        return shine;
    }
    Folder folder_;
};

TEST_F(Cover, AFarBoxShinesInItsOwnColour) {
    for (const double reflectance : {0.2, 0.5}) {
        LoadedScene scene = load({{.half = 30, .reflectance = reflectance}, {.half = 2, .at = {0, 0, 4}}});
        EXPECT_THAT(scene.added, ::testing::Contains(HasSubstr("closed space: the far surfaces around it shine")));
        EXPECT_EQ(scene.description.lights.size(), 1u);
        scene.description.max_depth = 0;  // the camera looks away from the cube
        const testing::Mean mean = testing::mean_of_picture({scene.description}, {.max_depth = 0, .seed = 1}, 2000);
        EXPECT_NEAR(mean.xyz[1], reflectance, 0.002 + 4.5 * mean.error[1]);
        EXPECT_LT(mean.error[1], 0.002);
    }
}

// A matt wall at the distance that the lamp is made for has the radiance of a white one times its reflectance.
TEST_F(Cover, ARoomGetsALampAtTheCamera) {
    const LoadedScene scene = load({{.half = 3}});
    EXPECT_THAT(scene.added, ::testing::Contains(HasSubstr("closed space: a lamp is added at the camera")));
    EXPECT_EQ(shining(scene), std::vector<bool>{false});
    ASSERT_EQ(scene.description.lights.size(), 2u);
    const LightDescription& lamp = scene.description.lights.back();
    EXPECT_EQ(lamp.kind, LightKind::kPoint);
    EXPECT_EQ(lamp.from, scene.description.camera.world_from_camera.t);
    EXPECT_GT(lamp.scale, std::numbers::pi * 9);      // the middle of a wall
    EXPECT_LT(lamp.scale, std::numbers::pi * 9 * 3);  // a corner
}

TEST_F(Cover, OneOpenSideLetsTheSkyIn) {
    const LoadedScene scene =
        load_all(cubes({{.half = 3}}, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6}));
    EXPECT_EQ(shining(scene), std::vector<bool>{false});
    EXPECT_EQ(scene.description.lights.size(), 1u);
}

// The sky, but not what stands under it; a room in a house is none, whatever lies about the house.
TEST_F(Cover, OnlyAFarBoxThatIsSeenIsASky) {
    EXPECT_EQ(shining(load({{.half = 30}, {.half = 2, .at = {0, 0, 4}}})), (std::vector{true, false}));
    EXPECT_EQ(shining(load({{.half = 30}, {.half = 2, .at = {0, 0, 24}}})), (std::vector{false, false}));
    EXPECT_EQ(shining(load({{.half = 90}, {.half = 1}})), (std::vector{false, false}));
    EXPECT_EQ(shining(load({{.half = 15}, {.half = 1, .at = {0, 0, 2}}})), (std::vector{false, false}));
    EXPECT_EQ(load({{.half = 1, .at = {3, 0, 0}}}).description.lights.size(), 1u);
}

TEST_F(Cover, WhatLetsLightPassClosesNothing) {
    GltfFile file = cubes({{.half = 3}}, kClosed);
    file.json["materials"][0]["alphaMode"] = "BLEND";
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
    EXPECT_EQ(load_all(file).description.lights.size(), 1u);
    file = cubes({{.half = 3}}, kClosed);
    file.json["materials"][0]["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    EXPECT_EQ(load_all(file).description.lights.size(), 1u);
}

TEST_F(Cover, InstancesCloseARoom) {
    GltfFile file = cubes({{.half = 3}, {.half = 1, .at = {50, 0, 0}}}, kClosed);
    EXPECT_EQ(load_all(file).description.lights.size(), 2u);
    file.json["nodes"][2]["mesh"] = 0;
    EXPECT_EQ(load_all(file).description.instances.size(), 2u);
    EXPECT_EQ(load_all(file).description.lights.size(), 2u);
}

TEST_F(Cover, WhatEmitsByItselfStaysAsItIs) {
    GltfFile file = cubes({{.half = 30}, {.half = 2, .at = {0, 0, 4}}}, kClosed);
    file.json["materials"][0]["emissiveFactor"] = {0.25, 0.25, 0.25};
    const LoadedScene scene = load_all(file);
    ASSERT_EQ(scene.description.area_lights.size(), 1u);
    EXPECT_EQ(scene.description.area_lights[0].picture, kNone);
}

}  // namespace
}  // namespace latent::render
