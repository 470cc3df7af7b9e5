#include "render/load/gltf/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "render/load/gltf/accessors.h"

namespace latent::render {

namespace {

using Numbers = std::span<const float>;

// Along the shorter arc between two rotations.
std::vector<double> slerp(Numbers a, Numbers b, double t) {
    double cosine = 0;
    for (std::size_t i = 0; i < 4; ++i) cosine += double{a[i]} * b[i];
    const double sign = cosine < 0 ? -1 : 1, angle = std::acos(std::min(std::abs(cosine), 1.0)), sine = std::sin(angle);
    const double from = sine > 1e-6 ? std::sin((1 - t) * angle) / sine : 1 - t, to = sine > 1e-6 ? std::sin(t * angle) / sine : t;
    std::vector<double> out;
    for (std::size_t i = 0; i < 4; ++i) out.push_back(from * a[i] + sign * to * b[i]);
    return out;
}

// A sampler: key frames, at rising times, of `components` numbers each, with tangents on both sides if it is a spline.
struct KeyFrames {
    std::vector<float> times, values;
    std::size_t components;
    enum class Kind { kStep, kLinear, kSpline } kind;

    std::size_t numbers_per_frame() const { return kind == Kind::kSpline ? 3 * components : components; }
    // part 0: the tangent before, 1: the value, 2: the tangent after.
    Numbers at(std::size_t frame, std::size_t part = 1) const {
        return Numbers(values).subspan(frame * numbers_per_frame() + (kind == Kind::kSpline ? part * components : 0), components);
    }
    std::vector<double> value(double seconds, bool is_rotation) const {
        const auto after = std::ranges::upper_bound(times, seconds, {}, [](float t) { return double{t}; });
        const auto next = static_cast<std::size_t>(after - times.begin());
        const Numbers before = at(next == 0 ? 0 : next - 1);
        if (next == 0 || next == times.size() || kind == Kind::kStep) return {before.begin(), before.end()};
        const double span = double{times[next]} - times[next - 1], t = (seconds - times[next - 1]) / span;
        if (kind == Kind::kLinear && is_rotation) return slerp(before, at(next), t);
        std::vector<double> out;
        for (std::size_t i = 0; i < components; ++i) {
            const double a = before[i], b = at(next)[i];
            if (kind == Kind::kLinear) {
                out.push_back((1 - t) * a + t * b);
            } else {
                const double rise = t * t * (3 - 2 * t), leave = t * (1 - t) * (1 - t), arrive = t * t * (t - 1);
                out.push_back((1 - rise) * a + rise * b + span * (leave * at(next - 1, 2)[i] + arrive * at(next, 0)[i]));
            }
        }
        return out;
    }
};

std::optional<KeyFrames> read_key_frames(const GltfDocument& document, const GltfValue& sampler, std::size_t components,
                                         bool are_weights) {
    std::optional<std::vector<float>> times = read_floats(document, sampler["input"], 1),
                                      values = read_floats(document, sampler["output"], are_weights ? 1 : components);
    if (!times || !values) return std::nullopt;
    const std::string word = sampler["interpolation"].text("LINEAR");
    using Kind = KeyFrames::Kind;
    KeyFrames out{std::move(*times), std::move(*values), components,
                  word == "STEP"          ? Kind::kStep
                  : word == "CUBICSPLINE" ? Kind::kSpline
                                          : Kind::kLinear};
    if (out.kind == Kind::kLinear && word != "LINEAR")
        sampler["interpolation"].warn(fmt::format("\"{}\" is unknown, and read as LINEAR", word));
    const std::size_t parts = out.kind == Kind::kSpline ? 3 : 1;
    if (out.times.empty() || std::ranges::adjacent_find(out.times, std::greater_equal<>()) != out.times.end()) {
        sampler["input"].error("times must rise");
        return std::nullopt;
    }
    if (are_weights) out.components = out.values.size() / out.times.size() / parts;
    if (out.components == 0 || out.values.size() != out.times.size() * out.numbers_per_frame()) {
        sampler["output"].error(fmt::format("does not have as many items as {} key frames need", out.times.size()));
        return std::nullopt;
    }
    return out;
}

// Whether the middle of a motion is more than a tenth of its way off the line between its ends.
bool strays(const std::optional<std::array<double, 3>>& start, const std::optional<std::array<double, 3>>& end,
            const std::optional<std::array<double, 3>>& middle, double share) {
    if (!start || !end || !middle) return false;
    double off = 0, way = 0, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double a = (*start)[i], b = (*end)[i], m = (*middle)[i];
        off = std::max(off, std::abs(m - ((1 - share) * a + share * b)));
        way = std::max({way, std::abs(b - a), std::abs(m - a)});
        size = std::max({size, std::abs(a), std::abs(b)});
    }
    return off > 0.1 * way && off > 1e-5 * size;
}
// The same of a turn, by more than 0.2.
bool strays(const std::optional<std::array<double, 4>>& start, const std::optional<std::array<double, 4>>& end,
            const std::optional<std::array<double, 4>>& middle, double share) {
    if (!start || !end || !middle) return false;
    const auto floats = [](const std::array<double, 4>& q) { return std::vector<float>(q.begin(), q.end()); };
    const std::vector<double> even = slerp(floats(*start), floats(*end), share);
    double cosine = 0, size = 0;
    for (std::size_t i = 0; i < 4; ++i) cosine += even[i] * (*middle)[i], size += (*middle)[i] * (*middle)[i];
    return 2 * std::acos(std::min(std::abs(cosine) / std::sqrt(size), 1.0)) > 0.2;
}

}  // namespace

std::vector<GltfNodePose> poses_at(const GltfDocument& document, std::size_t index, double seconds) {
    const GltfValue root = document.root(), nodes = root["nodes"], animation = root["animations"][index];
    std::vector<GltfNodePose> poses(nodes.size());
    for (std::size_t i = 0; i < animation["channels"].size(); ++i) {
        const GltfValue channel = animation["channels"][i], target = channel["target"];
        const std::optional<std::uint32_t> node = target["node"].index(nodes),
                                           sampler = channel["sampler"].index(animation["samplers"]);
        if (!node || !sampler) continue;  // an extension's target, or an error
        const std::string path = target["path"].text();
        const bool is_rotation = path == "rotation", are_weights = path == "weights";
        if (path != "translation" && path != "scale" && !is_rotation && !are_weights) {
            target["path"].warn(fmt::format("\"{}\" is not supported, and does not move", path));
            continue;
        }
        const auto frames = read_key_frames(document, animation["samplers"][*sampler], is_rotation ? 4 : 3, are_weights);
        if (!frames) continue;
        std::vector<double> value = frames->value(seconds, is_rotation);
        GltfNodePose& pose = poses[*node];
        if (are_weights) {
            pose.weights = std::move(value);
        } else if (is_rotation) {
            pose.rotation = {value[0], value[1], value[2], value[3]};
        } else {
            (path == "scale" ? pose.scale : pose.translation) = std::array{value[0], value[1], value[2]};
        }
    }
    return poses;
}

std::vector<std::uint32_t> uneven_nodes(const GltfDocument& document, std::size_t animation, double from, double to) {
    const std::vector<GltfNodePose> start = poses_at(document, animation, from), end = poses_at(document, animation, to);
    std::vector<bool> is_uneven(start.size());
    for (const double share : {0.21, 0.47, 0.83}) {  // whole turns have none of them in common
        const std::vector<GltfNodePose> middle = poses_at(document, animation, from + share * (to - from));
        for (std::size_t i = 0; i < start.size(); ++i) {
            const GltfNodePose &a = start[i], &b = end[i], &m = middle[i];
            if (strays(a.translation, b.translation, m.translation, share) || strays(a.scale, b.scale, m.scale, share) ||
                strays(a.rotation, b.rotation, m.rotation, share))
                is_uneven[i] = true;
        }
    }
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < is_uneven.size(); ++i) {
        if (is_uneven[i]) out.push_back(i);
    }
    return out;
}

std::vector<std::string> animation_names(const GltfDocument& document) {
    const GltfValue root = document.root(), animations = root["animations"];
    std::vector<std::string> out;
    for (std::size_t i = 0; i < animations.size(); ++i) {
        const GltfValue name = animations[i]["name"], samplers = animations[i]["samplers"];
        double seconds = 0;
        for (std::size_t s = 0; s < samplers.size(); ++s) {
            const std::optional<std::uint32_t> times = samplers[s]["input"].index(root["accessors"]);
            if (!times) continue;
            const GltfValue last = root["accessors"][*times]["max"];
            if (last.size() == 1) seconds = std::max(seconds, last.numbers(std::array<double, 1>{0})[0]);
        }
        out.push_back(
            fmt::format("{}{} ({:.3g} s)", i + 1, name.is_text() && !name.text().empty() ? " " + name.text() : "", seconds));
    }
    return out;
}

}  // namespace latent::render
