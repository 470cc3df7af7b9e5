// Morph targets and skins of glTF: the bent mesh is the mesh that was modelled so.
#include <gmock/gmock.h>

#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::as_glb;
using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// A square at `x`, of one node.
GltfFile square(double x = 0) {
    GltfFile file;
    const Json position = file.add_floats({x, 0, 0, x + 1, 0, 0, x + 1, 1, 0, x, 1, 0}, "VEC3"),
               normal = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3"),
               indices = file.add_indices({0, 1, 2, 0, 2, 3});
    file.json["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", indices}}}}}};
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    return file;
}

class Pose : public ::testing::Test {
 protected:
    Result<LoadedScene> load(const GltfFile& file) const {
        return load_scene(folder_.write("a.glb", as_glb(file)), false, color::RgbSpectra::kSmooth, {.stage = false});
    }
    SceneDescription described(const GltfFile& file) const {
        const Result<LoadedScene> scene = load(file);
        if (!scene) throw std::runtime_error(scene.error().message);
        EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
        return scene->description;
    }
    Hash128 hash(const GltfFile& file) const { return content_hash(described(file)); }
    Folder folder_;
};

TEST_F(Pose, WeightsOfTheNodeOrElseOfTheMeshMoveTheTargets) {
    const Hash128 moved = hash(square(1)), still = hash(square());
    GltfFile file = square();
    const Json right = file.add_floats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3"),
               up = file.add_floats({0, 5, 0, 0, 5, 0, 0, 5, 0, 0, 5, 0}, "VEC3");
    file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", right}}, {{"POSITION", up}}};
    EXPECT_EQ(hash(file), still);
    file.json["meshes"][0]["weights"] = {1, 0};
    EXPECT_EQ(hash(file), moved);
    file.json["nodes"][0]["weights"] = {0, 0};
    EXPECT_EQ(hash(file), still);
    file.json["nodes"][0]["weights"] = {1, 0};
    file.json["meshes"][0].erase("weights");
    EXPECT_EQ(hash(file), moved);
    // Two nodes of one mesh, each in its own pose.
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"] = {0, 1};
    EXPECT_EQ(described(file).shapes.size(), 2u);
    file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = file.add_floats({1, 0, 0}, "VEC3");
    EXPECT_THAT(load(file).error().message, HasSubstr("/targets/0/POSITION: has 1 items for 4 vertices"));
}

TEST_F(Pose, TargetsTurnNormals) {
    GltfFile file = square();
    file.json["meshes"][0]["primitives"][0]["targets"] = {
        {{"NORMAL", file.add_floats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3")}}};
    file.json["meshes"][0]["weights"] = {1};
    const float half = std::sqrt(0.5f);
    const SceneDescription scene = described(file);
    ASSERT_FALSE(scene.shapes.at(0).mesh->normals.empty());
    for (const Vec3f& n : scene.shapes[0].mesh->normals) EXPECT_NEAR(length(n - Vec3f(half, 0, half)), 0, 1e-6);
}

// Two joints, one of them moved by (1, 0, 0) and the other turned by a quarter about z; the square's own node is elsewhere.
TEST_F(Pose, SkinsFollowTheirJointsAndNotTheirNode) {
    const auto skinned = [](std::initializer_list<double> weights) {
        GltfFile file = square();
        Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
        const std::size_t joints = file.add_bytes(std::string("\0\1\0\0\0\1\0\0\0\1\0\0\0\1\0\0", 16));
        file.json["accessors"].push_back({{"bufferView", joints}, {"componentType", 5121}, {"type", "VEC4"}, {"count", 4}});
        attributes["JOINTS_0"] = file.json["accessors"].size() - 1;
        attributes["WEIGHTS_0"] = file.add_fractions(weights, "VEC4", 5126);
        file.json["skins"] = {{{"joints", {2, 3}}}};
        const double half = std::sqrt(0.5);
        file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {7, 7, 7}}},
                              {{"children", {2}}, {"translation", {2, 0, 0}}},
                              {{"translation", {-1, 0, 0}}},
                              {{"rotation", {0, 0, half, half}}}};
        file.json["scenes"] = {{{"nodes", {0, 1, 3}}}};
        return file;
    };
    EXPECT_EQ(hash(skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})), hash(square(1)));
    EXPECT_EQ(hash(skinned({.5, 0, 0, 0, .5, 0, 0, 0, .5, 0, 0, 0, .5, 0, 0, 0})), hash(square(1)));  // shares of their sum
    const auto corner = [&](const GltfFile& file) {                                                   // that was at (1, 1, 0)
        const SceneDescription scene = testing::in_world(described(file));
        return scene.shapes.at(0).mesh->positions.at(2);
    };
    EXPECT_NEAR(length(corner(skinned({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0})) - Vec3f(-1, 1, 0)), 0, 1e-6);
    EXPECT_NEAR(length(corner(skinned({.5, .5, 0, 0, .5, .5, 0, 0, .5, .5, 0, 0, .5, .5, 0, 0})) - Vec3f(0.5f, 1, 0)), 0, 1e-6);

    GltfFile outside = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    outside.json["scenes"][0]["nodes"] = {0};  // without the joints
    EXPECT_EQ(hash(outside), hash(square(1)));

    GltfFile bound = skinned({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    const std::size_t matrices = bound.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1,  // bound where it is now
                                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1},
                                                  "VEC4");
    bound.json["accessors"][matrices].update({{"type", "MAT4"}, {"count", 2}});
    bound.json["skins"][0]["inverseBindMatrices"] = matrices;
    EXPECT_EQ(hash(bound), hash(square()));
    GltfFile out_of_range = skinned({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
    out_of_range.json["skins"][0]["joints"] = Json::array({3});
    EXPECT_THAT(load(out_of_range).error().message, HasSubstr("JOINTS_0: joint 1 is out of range; the skin has 1"));
}

}  // namespace
}  // namespace latent::render
