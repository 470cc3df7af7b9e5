// What a camera sees in a closed space without lamps: a sky shines through what encloses it.
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
    static std::vector<bool> backdrops(const LoadedScene& scene) {
        std::vector<bool> out;
        for (const ShapeDescription& shape : scene.description.shapes) out.push_back(shape.backdrop);
        return out;
    }
    // The camera looks at a wall that faces +z.
    static void expect_luminance(const LoadedScene& scene, double luminance) {
        const testing::Mean mean = testing::mean_of_picture({scene.description}, {.max_depth = 5, .seed = 1}, 4000);
        EXPECT_NEAR(mean.xyz[1], luminance, 4.5 * mean.error[1]);
        EXPECT_LT(mean.error[1], 0.01 * luminance);
    }
    Folder folder_;
};

// Irradiance / pi where the normal is z, of the radiance 0.9 + 0.3 d.y + 0.15 d.z.
constexpr double kOnWall = 0.9 + 0.15 * 2 / 3;

TEST_F(Cover, AClosedSpaceOfAnySizeIsLitThroughItsWalls) {
    for (const double half : {0.01, 3.0, 20.0, 500.0}) {
        const LoadedScene scene = load({{.half = half, .reflectance = 0.3}});
        EXPECT_THAT(scene.added,
                    ::testing::ElementsAre(HasSubstr("a soft sky is added, which shines through what encloses the camera")));
        EXPECT_EQ(scene.description.lights.size(), 1u);
        EXPECT_EQ(backdrops(scene), std::vector{true});
        expect_luminance(scene, 0.3 * kOnWall);
    }
}

const std::initializer_list<std::uint32_t> kOpenAbove = {0, 2, 1, 1, 2, 3, 0, 1, 4, 1, 5, 4, 2, 6, 3,
                                                         3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

TEST_F(Cover, OneOpenSideLetsTheSkyIn) {
    const LoadedScene scene = load_all(cubes({{.half = 3}}, kOpenAbove));
    EXPECT_EQ(backdrops(scene), std::vector{false});
    EXPECT_THAT(scene.added, ::testing::ElementsAre(HasSubstr("a soft sky with a key light is added")));
}

// A lid leaves a gap all around, of 1/100 of the sphere or 1/25.
TEST_F(Cover, AGapIsAnOpeningIfItIsWideEnough) {
    EXPECT_EQ(backdrops(load_all(cubes({{.half = 3}, {.half = 2.9, .at = {0, 0, 5.9}}}, kOpenAbove))), (std::vector{true, true}));
    EXPECT_EQ(backdrops(load_all(cubes({{.half = 3}, {.half = 2.5, .at = {0, 0, 5.5}}}, kOpenAbove))), (std::vector{false, false}));
}

// Things in a room cast shadows. About a house in the box that shows a sky, the box, the house and what stands outside do not.
TEST_F(Cover, WhatEnclosesTheCameraIsABackdropAndNothingElse) {
    EXPECT_EQ(backdrops(load({{.half = 3}, {.half = 1, .at = {0, 0, 1.5}}})), (std::vector{true, false}));
    EXPECT_EQ(backdrops(load({{.half = 90}, {.half = 1}})), (std::vector{true, true}));
    EXPECT_EQ(backdrops(load({{.half = 90}, {.half = 1}, {.half = 2, .at = {10, 0, 0}}})), (std::vector{true, true, true}));
    EXPECT_EQ(backdrops(load({{.half = 1, .at = {3, 0, 0}}})), std::vector{false});
}

TEST_F(Cover, AModelWithALightHasNoBackdrops) {
    GltfFile file = cubes({{.half = 3}}, kClosed);
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    const LoadedScene scene = load_all(file);
    EXPECT_EQ(backdrops(scene), std::vector{false});
    EXPECT_EQ(scene.description.lights.size(), 1u);
}

TEST_F(Cover, AGivenSkyShinesThroughTheWallsToo) {
    testing::write_exr(folder_ / "sky.exr", 2, 2, std::vector<float>(12, 0.5f));
    const LoadedScene scene = load({{.half = 3, .reflectance = 0.3}}, {.sky = folder_ / "sky.exr"});
    EXPECT_THAT(scene.added, ::testing::ElementsAre(HasSubstr("closed space: the sky shines through what encloses it")));
    expect_luminance(scene, 0.3 * 0.5);
}

TEST_F(Cover, WhatLetsLightPassClosesNothing) {
    GltfFile file = cubes({{.half = 3}}, kClosed);
    file.json["materials"][0]["alphaMode"] = "BLEND";
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
    EXPECT_EQ(backdrops(load_all(file)), std::vector{false});
    file = cubes({{.half = 3}}, kClosed);
    file.json["materials"][0]["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    EXPECT_EQ(backdrops(load_all(file)), std::vector{false});
}

// Not the whole picture counts, but what the walls show of it.
TEST_F(Cover, AWallIsOpaqueWhereItsAlphaIs) {
    const auto is_closed = [&](double alpha, double cutoff, double u) {
        const int code = static_cast<int>(255 * alpha);
        folder_.write("wall.tga", testing::tga({code, 0}, {77, 77}));
        GltfFile file = cubes({{.half = 3}}, kClosed);
        file.json["images"] = {{{"uri", "wall.tga"}}};
        file.json["textures"] = {{{"source", 0}}};
        Json& material = file.json["materials"][0];
        material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 1}};
        material["alphaMode"] = cutoff < 0 ? "BLEND" : "MASK";
        if (cutoff >= 0) material["alphaCutoff"] = cutoff;
        Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
        attributes["TEXCOORD_0"] = file.add_floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC2");
        attributes["TEXCOORD_1"] = file.add_floats({u, 0, u, 0, u, 0, u, 0, u, 0, u, 0, u, 0, u, 0}, "VEC2");
        return backdrops(load_all(file)) == std::vector{true};
    };
    constexpr double kLeft = 0.25, kRight = 0.75, kBlend = -1;
    EXPECT_TRUE(is_closed(1, kBlend, kLeft));
    EXPECT_TRUE(is_closed(0.95, kBlend, kLeft));
    EXPECT_FALSE(is_closed(0.8, kBlend, kLeft));
    EXPECT_FALSE(is_closed(1, kBlend, kRight));
    EXPECT_TRUE(is_closed(0.8, 0.5, kLeft));
    EXPECT_FALSE(is_closed(0.8, 0.9, kLeft));
    EXPECT_FALSE(is_closed(0.8, 0.5, kRight));
    EXPECT_TRUE(is_closed(0.8, 0, kRight));
}

TEST_F(Cover, AlphaOfVerticesCountsToo) {
    for (const bool is_opaque : {true, false}) {
        GltfFile file = cubes({{.half = 3}}, kClosed);
        file.json["materials"][0]["alphaMode"] = "BLEND";
        const double last = is_opaque ? 1 : 0;
        file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = file.add_floats(
            {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, last}, "VEC4");
        EXPECT_EQ(backdrops(load_all(file)), std::vector{is_opaque});
    }
}

TEST_F(Cover, InstancesCloseARoom) {
    GltfFile file = cubes({{.half = 3, .reflectance = 0.3}, {.half = 1, .at = {50, 0, 0}}}, kClosed);
    EXPECT_EQ(backdrops(load_all(file)), (std::vector{true, false}));
    file.json["nodes"][2]["mesh"] = 0;
    const LoadedScene scene = load_all(file);
    EXPECT_EQ(scene.description.instances.size(), 2u);
    EXPECT_TRUE(scene.description.objects[0].shapes[0].backdrop);
    expect_luminance(scene, 0.3 * kOnWall);
}

// It is seen to glow, but gives no light.
TEST_F(Cover, WhatEmitsByItselfIsSeenToDoSo) {
    GltfFile file = cubes({{.half = 30, .reflectance = 0.3}}, kClosed);
    file.json["materials"][0]["emissiveFactor"] = {0.25, 0.25, 0.25};
    file.json["materials"][0]["doubleSided"] = true;
    expect_luminance(load_all(file), 0.25 + 0.3 * kOnWall);
}

}  // namespace
}  // namespace latent::render
