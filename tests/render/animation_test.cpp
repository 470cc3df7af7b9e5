// --time: a moment of an animation is the model whose nodes are where they are then.
#include <gmock/gmock.h>

#include "render/scene/content_hash.h"
#include "tests/render/models.h"
#include "tests/render/scenes.h"

namespace latent::render {
namespace {

using testing::Folder;
using testing::GltfFile;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class Animation : public ::testing::Test {
 protected:
    // Two triangles, of which an animation moves one.
    static GltfFile model() {
        GltfFile file;
        const Json position = file.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"),
                   up = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        file.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}, {"targets", {{{"POSITION", up}}}}}}}}};
        file.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
        file.json["scenes"] = {{{"nodes", {0, 1}}}};
        return file;
    }
    static void animate(GltfFile& file, const char* path, std::initializer_list<double> values, const char* type,
                        const char* interpolation) {
        Json& animation = file.json["animations"][0];
        const Json times = file.add_floats({1, 3}, "VEC1"), output = file.add_floats(values, type);
        for (const Json& accessor : {times, output}) {
            Json& kind = file.json["accessors"][accessor.get<std::size_t>()]["type"];
            if (kind == "VEC1") kind = "SCALAR";
        }
        animation["channels"].push_back({{"sampler", animation["samplers"].size()}, {"target", {{"node", 0}, {"path", path}}}});
        animation["samplers"].push_back({{"input", times}, {"output", output}, {"interpolation", interpolation}});
    }
    Result<LoadedScene> load(const GltfFile& file, std::optional<double> time = {}) const {
        return load_scene(folder_.write("a.glb", testing::as_glb(file)), false, color::RgbSpectra::kSmooth,
                          {.time = time, .stage = false});
    }
    SceneDescription described(const GltfFile& file, std::optional<double> time = {}) const {
        Result<LoadedScene> scene = load(file, time);
        if (!scene) throw std::runtime_error(scene.error().message);
        return std::move(scene->description);
    }
    // The model with these members in the node that moves.
    Hash128 at_rest(const Json& members) const {
        GltfFile file = model();
        file.json["nodes"][0].update(members);
        return content_hash(described(file));
    }
    Hash128 at(const GltfFile& file, double time) const { return content_hash(described(file, time)); }
    Folder folder_;
};

TEST_F(Animation, KeyFramesAreStepsLinesOrSplines) {
    GltfFile steps = model(), lines = model(), splines = model();
    animate(steps, "translation", {0, 0, 0, 2, 4, 8}, "VEC3", "STEP");
    animate(lines, "translation", {0, 0, 0, 2, 4, 8}, "VEC3", "LINEAR");
    // Before, value, after. Halfway, the tangents add (1 - -1) / 8 of the two seconds.
    animate(splines, "translation", {9, 9, 9, 0, 0, 0, 1, 0, 0, -1, 0, 0, 2, 4, 8, 9, 9, 9}, "VEC3", "CUBICSPLINE");
    for (const GltfFile* file : {&steps, &lines, &splines}) {
        EXPECT_EQ(at(*file, 0), at_rest({{"translation", {0, 0, 0}}}));
        EXPECT_EQ(at(*file, 1), at_rest({{"translation", {0, 0, 0}}}));
        EXPECT_EQ(at(*file, 3), at_rest({{"translation", {2, 4, 8}}}));
        EXPECT_EQ(at(*file, 9), at_rest({{"translation", {2, 4, 8}}}));
    }
    EXPECT_EQ(at(steps, 2.5), at_rest({{"translation", {0, 0, 0}}}));
    EXPECT_EQ(at(lines, 2.5), at_rest({{"translation", {1.5, 3, 6}}}));
    EXPECT_EQ(at(splines, 2), at_rest({{"translation", {1.5, 2, 4}}}));
}

TEST_F(Animation, RotationsTurnEvenlyTheShorterWay) {
    const double h = std::sqrt(0.5);
    for (const double sign : {1.0, -1.0}) {  // two ways to write one rotation
        GltfFile file = model();
        animate(file, "rotation", {0, 0, 0, 1, 0, 0, sign * h, sign * h}, "VEC4", "LINEAR");
        const Affined turned = described(file, 1 + 2.0 / 3).instances.at(0).world_from_object;  // by 30 degrees
        EXPECT_LT(max_abs(turned.x - Vec3d(std::sqrt(0.75), 0.5, 0)), 1e-6);
        EXPECT_LT(max_abs(turned.y - Vec3d(-0.5, std::sqrt(0.75), 0)), 1e-6);
    }
}

TEST_F(Animation, ScalesAndWeightsOfMorphTargetsMove) {
    GltfFile scaled = model(), morphed = model();
    animate(scaled, "scale", {1, 1, 1, 3, 1, 1}, "VEC3", "LINEAR");
    EXPECT_EQ(at(scaled, 2), at_rest({{"scale", {2, 1, 1}}}));
    animate(morphed, "weights", {0, 1}, "VEC1", "LINEAR");
    EXPECT_EQ(at(morphed, 1.5), at_rest({{"weights", {.25}}}));
}

TEST_F(Animation, WithoutAMomentTheModelRestsAndAWarningSaysSo) {
    GltfFile file = model();
    animate(file, "translation", {7, 0, 0, 2, 4, 8}, "VEC3", "LINEAR");
    const Result<LoadedScene> scene = load(file);
    ASSERT_TRUE(scene);
    EXPECT_THAT(scene->warnings, ::testing::ElementsAre(HasSubstr("rest pose; --time SECONDS shows a moment")));
    EXPECT_EQ(content_hash(scene->description), at_rest(Json::object()));
    EXPECT_THAT(load(model(), 1).error().message, HasSubstr("--time: "));
    file.json["animations"][0]["samplers"][0]["output"] = file.json["animations"][0]["samplers"][0]["input"];
    EXPECT_THAT(load(file, 1).error().message, HasSubstr("/accessors/"));
}

// Between where nodes are when it opens and when it closes.
TEST_F(Animation, AShutterMovesWhatIsRigid) {
    GltfFile file = model();
    const double h = std::sqrt(0.5);
    animate(file, "rotation", {0, 0, 0, 1, 0, 0, h, h}, "VEC4", "LINEAR");
    animate(file, "translation", {0, 0, 0, 2, 4, 8}, "VEC3", "LINEAR");
    file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
    file.json["nodes"][0]["children"] = {2};
    file.json["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 9}}});
    const auto loaded = [&](const GltfFile& model, const ModelOptions& options) {
        Result<LoadedScene> scene =
            load_scene(folder_.write("a.glb", testing::as_glb(model)), false, color::RgbSpectra::kSmooth, options);
        if (!scene) throw std::runtime_error(scene.error().message);
        scene->description = testing::in_world(std::move(scene->description));
        return std::move(*scene);
    };
    const auto expect_near = [](const Affined& a, const Affined& b) {
        EXPECT_LT(max_abs(a.x - b.x) + max_abs(a.y - b.y) + max_abs(a.z - b.z) + max_abs(a.t - b.t), 1e-6);
    };
    const ModelOptions open{.time = 1, .shutter = std::array{0.5, 1.5}, .stage = false};
    const LoadedScene blurred = loaded(file, open), first = loaded(file, {.time = 1.5, .stage = false}),
                      last = loaded(file, {.time = 2.5, .stage = false});
    const SceneDescription &scene = blurred.description, &from = first.description, &to = last.description;
    EXPECT_THAT(blurred.warnings, ::testing::IsEmpty());
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_near(scene.instances[0].world_from_object, from.instances[0].world_from_object);
    ASSERT_TRUE(scene.instances[0].end);
    expect_near(*scene.instances[0].end, to.instances[0].world_from_object);
    EXPECT_FALSE(scene.instances[1].end);
    expect_near(scene.camera.world_from_camera, from.camera.world_from_camera);
    ASSERT_TRUE(scene.camera.end);
    expect_near(*scene.camera.end, to.camera.world_from_camera);
    EXPECT_EQ(scene.shutter.open, 0);
    EXPECT_EQ(scene.shutter.close, 1);
    // A mesh that is used once moves too; after the last key frame nothing does.
    GltfFile once = file;
    once.json["scenes"][0]["nodes"] = {0};
    EXPECT_TRUE(loaded(once, open).description.instances.at(0).end);
    EXPECT_FALSE(has_motion(loaded(once, {.time = 3, .shutter = std::array{0.0, 1.0}, .stage = false}).description));
    // What emits is where the shutter opens, and a warning says so.
    GltfFile lamp = once;
    lamp.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
    lamp.json["meshes"][0]["primitives"][0]["material"] = 0;
    const LoadedScene still = loaded(lamp, open);
    EXPECT_TRUE(still.description.instances.empty());
    EXPECT_THAT(still.warnings, ::testing::ElementsAre(HasSubstr("a surface that emits does not move while the shutter is open")));
}

TEST_F(Animation, AnyOfThemIsChosenByItsNameOrNumber) {
    GltfFile first = model();
    animate(first, "translation", {0, 0, 0, 2, 4, 8}, "VEC3", "LINEAR");
    GltfFile both = first;
    both.json["animations"][0]["name"] = "walk";
    animate(both, "translation", {1, 0, 0, 3, 4, 8}, "VEC3", "LINEAR");
    Json& channels = both.json["animations"][0]["channels"];
    both.json["animations"].push_back(
        {{"name", "run"}, {"channels", {channels[1]}}, {"samplers", both.json["animations"][0]["samplers"]}});
    channels.erase(1);
    for (Json& accessor : both.json["accessors"]) {
        if (accessor["type"] == "SCALAR") accessor["max"] = {3}, accessor["min"] = {1};
    }
    const auto shown = [&](const std::string& name, std::optional<double> time) {
        return load_scene(folder_.write("a.glb", testing::as_glb(both)), false, color::RgbSpectra::kSmooth,
                          {.animation = name, .time = time, .stage = false});
    };
    for (const char* name : {"", "walk", "1"}) EXPECT_EQ(content_hash(shown(name, 2).value().description), at(first, 2)) << name;
    for (const char* name : {"run", "2"}) {
        EXPECT_EQ(content_hash(shown(name, 2).value().description), at_rest({{"translation", {2, 2, 4}}})) << name;
        EXPECT_EQ(content_hash(shown(name, {}).value().description), at_rest({{"translation", {1, 0, 0}}})) << name;
        EXPECT_THAT(shown(name, 2).value().warnings, ::testing::IsEmpty());
    }
    EXPECT_THAT(shown("", {}).value().warnings, ::testing::ElementsAre(HasSubstr("--animation names: 1 walk (3 s), 2 run (3 s)")));
    EXPECT_THAT(shown("", 2).value().warnings,
                ::testing::ElementsAre(HasSubstr("the first is shown; --animation chooses another")));
    const Result<LoadedScene> missing = shown("fly", 2);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, ErrorCode::kUsage);
    EXPECT_THAT(missing.error().message, HasSubstr("(1 walk (3 s), 2 run (3 s))"));
}

TEST_F(Animation, MotionThatIsNotEvenIsSaid) {
    const auto warnings = [&](std::initializer_list<double> times, const std::string& path, std::initializer_list<double> values) {
        GltfFile file = model();
        const Json input = file.add_floats(times, "VEC1"), output = file.add_floats(values, path == "rotation" ? "VEC4" : "VEC3");
        file.json["accessors"][input.get<std::size_t>()]["type"] = "SCALAR";
        file.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                                    {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
        const Result<LoadedScene> scene = load_scene(folder_.write("a.glb", testing::as_glb(file)), false,
                                                     color::RgbSpectra::kSmooth, {.shutter = std::array{0.0, 1.0}, .stage = false});
        if (!scene) throw std::runtime_error(scene.error().message);
        return scene->warnings;
    };
    const float h = std::sqrt(0.5f);
    const auto said = ::testing::ElementsAre(HasSubstr("/nodes/0: is blurred along a straight line"));
    EXPECT_THAT(warnings({0, .25f, .5f, .75f, 1}, "rotation", {0, 0, 0, 1, 0, 0, h, h, 0, 0, 1, 0, 0, 0, h, -h, 0, 0, 0, -1}),
                said);
    EXPECT_THAT(warnings({0, .5f, 1}, "rotation", {0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}), said);  // there and back
    EXPECT_THAT(warnings({0, .5f, 1}, "translation", {0, 0, 0, 1, 1, 0, 2, 0, 0}), said);
    EXPECT_THAT(warnings({0, 1}, "rotation", {0, 0, 0, 1, 0, 0, h, h}), ::testing::IsEmpty());
    EXPECT_THAT(warnings({0, .5f, 1}, "translation", {7, 0, 0, 8, 1, 0, 9, 2, 0}), ::testing::IsEmpty());
    EXPECT_THAT(warnings({0, .5f, 1}, "scale", {1, 1, 1, 1, 1, 1, 1, 1, 1}), ::testing::IsEmpty());
}

// A node moves along x from 1 s to 3 s.
TEST_F(Animation, WhatMovesIsInThePictureFromWhereTheShutterOpensToWhereItCloses) {
    GltfFile file = model();
    animate(file, "translation", {-20, 0, 0, 20, 0, 0}, "VEC3", "LINEAR");
    const Result<LoadedScene> loaded = load_scene(folder_.write("a.glb", testing::as_glb(file)), false, color::RgbSpectra::kSmooth,
                                                  {.shutter = std::array{0.0, 3.0}, .view = ModelView::kFront, .stage = false});
    ASSERT_TRUE(loaded) << loaded.error().message;
    const SceneDescription scene = testing::in_world(loaded->description);
    const Affined camera_from_world = scene.camera.world_from_camera.inverse().value();
    const auto seen = [&](const Affined& m) { return camera_from_world.point(m.t); };
    const auto across = [&](const Vec3d& p) { return p.x / p.z / scene.camera.x1; };
    const InstanceDescription& moving = scene.instances.at(0);
    ASSERT_TRUE(moving.end);
    EXPECT_GT(length(moving.end->t - moving.world_from_object.t), 10);
    for (const Affined& m : {moving.world_from_object, *moving.end}) {
        EXPECT_GT(seen(m).z, 0);
        EXPECT_LT(std::abs(across(seen(m))), 0.81);
    }
    EXPECT_LT(across(seen(moving.world_from_object)), -0.5);
    EXPECT_GT(across(seen(*moving.end)), 0.5);
}

}  // namespace
}  // namespace latent::render
