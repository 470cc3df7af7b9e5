#include "render/scene/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::render {
namespace {

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

constexpr std::uint32_t kDeepest = 256;
constexpr double kMaxEvaluated = 10'000;  // textures for one value, or materials of one mixture

// How deep each of `count` things reaches that are made of each other, and how many it is made of, found from the bottom: each
// round settles those whose parts are.
struct Depths {
    std::vector<std::uint32_t> depth;
    std::vector<double> size;   // itself, and each part as often as it is used
    std::vector<bool> settled;  // else it is made of itself, or of one that is
};
template <class PartsOf>
Depths depths_of(std::size_t count, const PartsOf& parts_of) {
    std::vector<std::vector<std::uint32_t>> users(count);
    std::vector<std::size_t> open(count);
    std::vector<std::uint32_t> ready;
    Depths out{std::vector<std::uint32_t>(count, 1), std::vector<double>(count, 1), std::vector<bool>(count, false)};
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::vector<std::uint32_t> parts = parts_of(i);
        for (const std::uint32_t part : parts) users[part].push_back(i);
        open[i] = parts.size();
        if (parts.empty()) ready.push_back(i);
    }
    while (!ready.empty()) {
        const std::uint32_t i = ready.back();
        ready.pop_back();
        out.settled[i] = true;
        for (const std::uint32_t user : users[i]) {
            out.depth[user] = std::max(out.depth[user], out.depth[i] + 1);
            out.size[user] += out.size[i];
            if (--open[user] == 0) ready.push_back(user);
        }
    }
    return out;
}

}  // namespace

bool is_even(const Affined& m, double tolerance) {
    const double scale = length(m.x);
    const Vec3d x = m.x / scale, y = m.y / scale, z = m.z / scale;
    const auto near = [&](double a, double b) { return std::abs(a - b) <= tolerance; };
    return scale > 0 && near(length(y), 1) && near(length(z), 1) && near(dot(x, y), 0) && near(dot(y, z), 0) && near(dot(z, x), 0);
}

Refusals check_camera(const CameraDescription& d) {
    Refusals refusals;
    if (!is_even(d.world_from_camera, 1e-4))
        refusals.push_back(
            "Camera: its transformation skews or stretches; use only rotations, translations, mirrors and uniform scales");
    if (d.end && refusals.empty() && !is_even(*d.end, 1e-4)) {
        refusals.push_back("Camera: its transformation at EndTime skews or stretches");
    } else if (d.end && refusals.empty()) {
        const double scale = length(d.end->x) / length(d.world_from_camera.x);
        if (!(std::abs(scale - 1) < 1e-4) || d.end->swaps_handedness() != d.world_from_camera.swaps_handedness())
            refusals.push_back("Camera: the scale of its transformation must be the same at StartTime and EndTime");
    }
    if (d.kind != CameraKind::kPerspective && d.lens_radius > 0)
        refusals.push_back("Camera: \"lensradius\" is supported with perspective cameras only");
    return refusals;
}

bool is_stretched(const ShapeDescription& quadric) { return !is_even(quadric.to_world, 1e-5); }

Refusals check_area_light(const ShapeDescription& shape) {
    const auto refuse = [](const std::string& what) { return Refusals{"an area light on " + what + " is not supported"}; };
    switch (shape.kind) {
        case ShapeKind::kTriangles:
            return {};
        case ShapeKind::kSphere:
            return is_stretched(shape) ? refuse("a sphere that is stretched") : Refusals{};
        case ShapeKind::kDisk:  // stays even
            return {};
        case ShapeKind::kCylinder:
            return is_stretched(shape) ? refuse("a cylinder that is stretched") : Refusals{};
        case ShapeKind::kTube:
            return refuse("a tube");
        case ShapeKind::kBilinear:
            break;
    }
    if (shape.ribbon)
        return {
            "an area light on a \"ribbon\" that bends, twists or tapers is not supported; a curve of type \"cylinder\" may emit"};
    return refuse("a patch that is not a parallelogram");
}

std::vector<std::pair<std::uint32_t, std::string>> check_textures(const std::vector<TextureDescription>& textures) {
    std::vector<std::pair<std::uint32_t, std::string>> refused;
    const Depths depths = depths_of(textures.size(), [&](std::uint32_t i) { return inputs_of(textures[i]); });
    for (std::uint32_t i = 0; i < textures.size(); ++i) {
        if (!depths.settled[i]) refused.emplace_back(i, "Texture: is made of itself");
        if (depths.depth[i] == kDeepest + 1)
            refused.emplace_back(i, fmt::format("Texture: more than {} textures, one made of the other", kDeepest));
        const auto is_too_large = [&](std::uint32_t texture) { return depths.size[texture] > kMaxEvaluated; };
        if (is_too_large(i) && std::ranges::none_of(inputs_of(textures[i]), is_too_large))
            refused.emplace_back(i, fmt::format("Texture: evaluates more than {} textures for one value", kMaxEvaluated));
    }
    return refused;
}

std::vector<std::uint32_t> endless_mixtures(const std::vector<MaterialDescription>& materials) {
    const Depths depths = depths_of(materials.size(), [&](std::uint32_t i) {
        std::vector<std::uint32_t> mixed;
        for (const std::uint32_t m : materials[i].mixed) {
            if (m != kNone) mixed.push_back(m);
        }
        return mixed;
    });
    std::vector<std::uint32_t> refused;
    for (std::uint32_t i = 0; i < materials.size(); ++i) {
        const auto is_too_large = [&](std::uint32_t part) { return part != kNone && depths.size[part] > kMaxEvaluated; };
        const bool is_first_too_large = is_too_large(i) && std::ranges::none_of(materials[i].mixed, is_too_large);
        if (!depths.settled[i] || depths.depth[i] == kDeepest + 1 || is_first_too_large) refused.push_back(i);
    }
    return refused;
}

std::vector<std::uint32_t> sums_of_too_many(const std::vector<MediumDescription>& media) {
    const auto parts_of = [&](std::uint32_t i) {
        std::vector<std::uint32_t> parts;
        for (const std::uint32_t m : media[i].summed) {
            if (m != kNone) parts.push_back(m);
        }
        return parts;
    };
    const Depths depths = depths_of(media.size(), parts_of);
    std::vector<std::uint32_t> refused;
    for (std::uint32_t i = 0; i < media.size(); ++i) {
        // One that is too deep has too many parts.
        bool too_many = !depths.settled[i] || depths.depth[i] > kMaxSummed;
        std::vector<std::uint32_t> open = parts_of(i);
        std::size_t leaves = 0;
        while (!too_many && !open.empty()) {
            const std::vector<std::uint32_t> parts = parts_of(open.back());
            open.pop_back();
            open.insert(open.end(), parts.begin(), parts.end());
            leaves += parts.empty() ? 1 : 0;
        }
        if (too_many || leaves > kMaxSummed) refused.push_back(i);
    }
    return refused;
}

}  // namespace latent::render
