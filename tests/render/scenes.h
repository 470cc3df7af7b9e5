// tests/render/scenes.h: scenes written on the spot, for tests.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "image/exr_writer.h"
#include "render/load/load_scene.h"
#include "tests/faults/process.h"

namespace latent::render::testing {

// A folder of its own for the running test, gone with it.
struct Folder : latent::testing::TemporaryFolder {
    std::filesystem::path write(const std::string& file, const std::string& text) const {
        std::ofstream(*this / file, std::ios::binary) << text;
        return *this / file;
    }
};

// A picture of linear rgb.
inline void write_exr(const std::filesystem::path& path, int width, int height, const std::vector<float>& rgb,
                      const image::ExrTags& tags = {}) {
    Result<OutputFile> out = OutputFile::create(path, true);
    ASSERT_TRUE(out);
    const image::Rect window{0, 0, width, height};
    Result<std::unique_ptr<image::RowWriter>> writer = image::create_exr(std::move(*out), window, window, false, tags, 1);
    ASSERT_TRUE(writer && (*writer)->write_rows(std::as_bytes(std::span(rgb))) && (*writer)->finish() && (*writer)->publish());
}

// An uncompressed TGA of one row with these alphas; it is white unless greys are given.
inline std::string tga(const std::vector<int>& alphas, const std::vector<int>& greys = {}) {
    std::string out(18, '\0');
    out[2] = 2;
    out[12] = static_cast<char>(alphas.size());
    out[14] = 1;
    out[16] = 32;
    out[17] = 8;
    for (std::size_t i = 0; i < alphas.size(); ++i)
        out += std::string(3, static_cast<char>(greys.empty() ? 255 : greys[i])) + static_cast<char>(alphas[i]);
    return out;
}

// The same scene with every place as the file has it, counted from the origin of the world, objects from theirs.
inline SceneDescription in_world(SceneDescription scene) {
    const auto put_back = [](std::vector<ShapeDescription>& shapes, const Vec3d& origin) {
        for (ShapeDescription& shape : shapes) {
            shape.to_world.t += origin;
            if (!shape.mesh) continue;
            MeshDescription mesh = *shape.mesh;
            for (Vec3f& p : mesh.positions) p = Vec3f(Vec3d(p) + origin);
            shape.mesh = std::make_shared<MeshDescription>(std::move(mesh));
        }
    };
    put_back(scene.shapes, scene.origin);
    scene.camera.world_from_camera.t += scene.origin;
    if (scene.camera.end) scene.camera.end->t += scene.origin;
    for (LightDescription& light : scene.lights) {
        light.world_from_light.t += scene.origin;
        if (!light.portal) continue;
        for (Vec3d& corner : *light.portal) corner += scene.origin;
    }
    for (InstanceDescription& instance : scene.instances) {
        const auto move = [&](Affined& map) { map.t = map.point(-scene.objects[instance.object].origin) + scene.origin; };
        move(instance.world_from_object);
        if (instance.end) move(*instance.end);
    }
    for (ObjectDescription& object : scene.objects) {
        put_back(object.shapes, object.origin);
        object.origin = {};
    }
    scene.origin = {};
    return scene;
}

// Loads `text` as room.pbrt.
inline Result<LoadedScene> load(const std::string& text) {
    const Folder folder;
    return load_scene(folder.write("room.pbrt", text));
}
// The same with WorldBegin in front.
inline Result<LoadedScene> load_world(const std::string& text) { return load("WorldBegin\n" + text); }

// The message of a scene that is refused; empty, and a failure, if it is not.
inline std::string refusal(const std::string& text) {
    const Result<LoadedScene> scene = load(text);
    if (!scene) return scene.error().message;
    ADD_FAILURE() << "was accepted:\n" << text;
    return "";
}
// The same with WorldBegin in front.
inline std::string refused_world(const std::string& text) { return refusal("WorldBegin\n" + text); }

}  // namespace latent::render::testing
