// tests/transport/world_builder.h: scenes written as text, loaded and ready to trace.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "render/load/load_scene.h"
#include "render/program/make_integrator.h"
#include "render/world/world.h"
#include "tests/render/scenes.h"
#include "tests/support/paths.h"
#include "tests/transport/measured_examples.h"

namespace latent::render::testing {

struct Scene {
    SceneDescription description;

    std::unique_ptr<World> world() const {
        Result<std::unique_ptr<World>> world = World::build(description, "sse4.2");
        if (!world) throw std::runtime_error(world.error().message);
        return std::move(*world);
    }
    // XYZ records, unless settings say otherwise.
    std::unique_ptr<Integrator> integrator(IntegratorSettings settings) const {
        if (settings.positions.sampler == sampledb::PositionSampler::kNone)
            settings.positions = {sampledb::PositionSampler::kPixels, 0, 0, 64, 64};
        settings.positions.shift_u = static_cast<std::uint32_t>(settings.seed * 2654435761u);
        settings.positions.shift_v = static_cast<std::uint32_t>(settings.seed * 2246822519u);
        if (settings.max_depth == 0) settings.max_depth = description.max_depth;
        Result<std::unique_ptr<Integrator>> integrator = make_integrator(description, settings);
        if (!integrator) throw std::runtime_error(integrator.error().message);
        return std::move(*integrator);
    }
};

inline Scene scene_of(Result<LoadedScene> loaded) {
    if (!loaded) throw std::runtime_error(loaded.error().message);
    return {std::move(loaded->description)};
}
// `text` is a whole .pbrt file.
inline Scene scene_from(const std::string& text) { return scene_of(load(text)); }
// The same beside "sky.exr", 8 x 8 pixels: a coloured sky with a warm sun about its +z, and "metal.bsdf", a measured metal.
inline Scene scene_under_sky(const std::string& text) {
    const Folder folder;
    std::vector<float> rgb;
    for (int i = 0; i < 64; ++i) {
        const int x = i % 8, y = i / 8;
        const bool sun = (x == 3 || x == 4) && y == 4;
        const float blue = 0.3f + 0.1f * static_cast<float>(x), green = 0.2f + 0.05f * static_cast<float>(y);
        rgb.insert(rgb.end(), {sun ? 12.0f : 0.2f, sun ? 9.0f : green, sun ? 6.0f : blue});
    }
    write_exr(folder / "sky.exr", 8, 8, rgb);
    static const Bytes metal =
        MeasuredFile(measured({.alpha_x = 0.25f, .alpha_y = 0.4f, .side = 24, .directions = 6, .turns = 9})).bytes();
    folder.write("metal.bsdf", {reinterpret_cast<const char*>(metal.data()), metal.size()});
    return scene_of(load_scene(folder.write("room.pbrt", text)));
}
// The text of a scene whose camera and everything else stand `distance` further along each axis.
inline std::string moved(std::string text, double distance) {
    text.insert(text.find("Camera "), fmt::format("Translate {0} {0} {0}\n", -distance));
    const std::string begin = "WorldBegin\n";
    text.insert(text.find(begin) + begin.size(), fmt::format("Translate {0} {0} {0}\n", distance));
    return text;
}
// A file of the project's scenes/.
inline Scene scene_named(const std::string& name) { return scene_of(load_scene(latent::testing::in_tree("scenes/" + name))); }

}  // namespace latent::render::testing
