// render/load/gltf/animation.h: where a moment of an animation puts nodes [glTF2 3.11]. docs/models.md, "glTF".
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/load/gltf/document.h"

namespace latent::render {

// What takes the place of a node's own values.
struct GltfNodePose {
    std::optional<std::array<double, 3>> translation{}, scale{};
    std::optional<std::array<double, 4>> rotation{};  // x y z w, of about unit length
    std::optional<std::vector<double>> weights{};     // of morph targets

    bool is_placed() const { return translation || rotation || scale; }
};

// The pose of each node, `seconds` into the file's first animation. Its first and last key frames hold beyond its ends. Channels
// that cannot be read are errors.
std::vector<GltfNodePose> poses_at(const GltfDocument& document, double seconds);

}  // namespace latent::render
