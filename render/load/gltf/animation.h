// render/load/gltf/animation.h: where a moment of an animation puts nodes [glTF2 3.11]. docs/models.md, "glTF".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/load/gltf/document.h"

namespace latent::render {

// What takes the place of a node's own values.
struct GltfNodePose {
    std::optional<std::array<double, 3>> translation{}, scale{};
    std::optional<std::array<double, 4>> rotation{};  // x y z w, of about unit length
    std::optional<std::vector<double>> weights{};     // those of morph targets

    bool is_placed() const { return translation || rotation || scale; }
};

// The pose of each node, `seconds` into /animations/N. Its first and last key frames hold beyond its ends. Channels
// that cannot be read are errors.
std::vector<GltfNodePose> poses_at(const GltfDocument& document, std::size_t animation, double seconds);

// Nodes that do not go evenly, along a straight line and by the shorter turn, from where they are at one moment to where they are
// at another.
std::vector<std::uint32_t> uneven_nodes(const GltfDocument& document, std::size_t animation, double from, double to);

// Each with its number from 1, its name, if it has one, and how long it takes: "1 walk (0.7 s)".
std::vector<std::string> animation_names(const GltfDocument& document);

}  // namespace latent::render
