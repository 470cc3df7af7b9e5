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

// Each wall emits its reflectance r and reflects r of what comes: L = r + r L.
TEST_F(Cover, AClosedRoomIsAFurnace) {
    for (const double reflectance : {0.2, 0.5}) {
        const LoadedScene scene = load({{.half = 3, .reflectance = reflectance}});
        EXPECT_THAT(scene.added, ::testing::ElementsAre(HasSubstr("has no light, and no sky reaches the camera")));
        EXPECT_TRUE(scene.description.lights.empty());
        const testing::Mean mean = testing::mean_of_picture({scene.description}, {.max_depth = kUnlimited, .seed = 1}, 20000);
        EXPECT_LT(mean.error[1], 0.01);
        EXPECT_NEAR(mean.xyz[1], reflectance / (1 - reflectance), 4.5 * mean.error[1]);
    }
}

TEST_F(Cover, OneOpenSideLetsTheSkyIn) {
    const LoadedScene scene =
        load_all(cubes({{.half = 3}}, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6}));
    EXPECT_EQ(shining(scene), std::vector<bool>{false});
    EXPECT_EQ(scene.description.lights.size(), 1u);
}

// The box that shows the sky, but not what stands in it; a room in a house, if the camera sees nothing else.
TEST_F(Cover, TheOutermostThatIsSeenShines) {
    EXPECT_EQ(shining(load({{.half = 9}, {.half = 1, .at = {3, 0, 0}}})), (std::vector{true, false}));
    EXPECT_EQ(shining(load({{.half = 9}, {.half = 1}})), (std::vector{false, true}));
    EXPECT_EQ(shining(load({{.half = 1, .at = {3, 0, 0}}})), std::vector{false});
}

TEST_F(Cover, WhatEmitsByItselfStaysAsItIs) {
    GltfFile file = cubes({{.half = 3}}, kClosed);
    file.json["materials"][0]["emissiveFactor"] = {0.25, 0.25, 0.25};
    const LoadedScene scene = load_all(file);
    ASSERT_EQ(scene.description.area_lights.size(), 1u);
    EXPECT_EQ(scene.description.area_lights[0].picture, kNone);
}

TEST_F(Cover, ASkyOfOnesOwnIsTakenInstead) {
    testing::write_exr(folder_ / "sky.exr", 2, 1, std::vector<float>(6, 0.5f));
    EXPECT_EQ(shining(load({{.half = 3}}, {.sky = folder_ / "sky.exr"})), std::vector{false});
}

}  // namespace
}  // namespace latent::render
