#include "render/scene/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::render {
namespace {

// Whether the images of the axes are as long as the first and square to each other, to `tolerance` of that length.
bool is_even(const Affined& m, double tolerance) {
    const double scale = length(m.x);
    const Vec3d x = m.x / scale, y = m.y / scale, z = m.z / scale;
    const auto near = [&](double a, double b) { return std::abs(a - b) <= tolerance; };
    return scale > 0 && near(length(y), 1) && near(length(z), 1) && near(dot(x, y), 0) && near(dot(y, z), 0) && near(dot(z, x), 0);
}

// Indices of the textures that one is made of.
std::vector<std::uint32_t> inputs_of(const TextureDescription& d) {
    std::vector<std::uint32_t> inputs;
    const auto add = [&](const auto& input) {
        if (input.is_textured()) inputs.push_back(input.texture);
    };
    for (const FloatInput& input : d.numbers) add(input);
    for (const SpectrumInput& input : d.spectra) add(input);
    add(d.amount);
    return inputs;
}

}  // namespace

Refusals check_camera(const CameraDescription& d) {
    Refusals refusals;
    if (!is_even(d.world_from_camera, 1e-4))
        refusals.push_back(
            "Camera: its transformation skews or stretches; use only rotations, translations, mirrors and uniform scales");
    if (d.kind != CameraKind::kPerspective && d.lens_radius > 0)
        refusals.push_back("Camera: \"lensradius\" is supported with perspective cameras only");
    return refusals;
}

Refusals check_area_light(const ShapeDescription& shape) {
    const auto refuse = [](const std::string& what) { return Refusals{"an area light on " + what + " is not supported"}; };
    switch (shape.kind) {
        case ShapeKind::kTriangles:
            return {};
        case ShapeKind::kSphere:
            return is_even(shape.to_world, 1e-5) ? Refusals{} : refuse("a sphere that is stretched");
        case ShapeKind::kDisk:
            return refuse("a disk");
        case ShapeKind::kBilinear:
            break;
    }
    return refuse("a patch that is not a parallelogram");
}

std::vector<std::pair<std::uint32_t, std::string>> check_textures(const std::vector<TextureDescription>& textures) {
    constexpr std::uint32_t kDeepest = 256;
    // How deep a texture reaches, found from the bottom: each round settles those whose inputs are settled.
    std::vector<std::vector<std::uint32_t>> users(textures.size());
    std::vector<std::size_t> open(textures.size());
    std::vector<std::uint32_t> depth(textures.size(), 1), ready;
    std::vector<std::pair<std::uint32_t, std::string>> refused;
    for (std::uint32_t i = 0; i < textures.size(); ++i) {
        const std::vector<std::uint32_t> inputs = inputs_of(textures[i]);
        for (const std::uint32_t input : inputs) users[input].push_back(i);
        open[i] = inputs.size();
        if (inputs.empty()) ready.push_back(i);
    }
    while (!ready.empty()) {
        const std::uint32_t i = ready.back();
        ready.pop_back();
        if (depth[i] == kDeepest + 1)
            refused.emplace_back(i, fmt::format("Texture: more than {} textures, one made of the other", kDeepest));
        for (const std::uint32_t user : users[i]) {
            depth[user] = std::max(depth[user], depth[i] + 1);
            if (--open[user] == 0) ready.push_back(user);
        }
    }
    for (std::uint32_t i = 0; i < textures.size(); ++i) {
        if (open[i] > 0) refused.emplace_back(i, "Texture: is made of itself");
    }
    return refused;
}

}  // namespace latent::render
