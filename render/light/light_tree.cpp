#include "render/light/light_tree.h"

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cassert>

#include "render/math/elementary.h"

namespace latent::render {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;  // the same arithmetic on every processor
using HalfOfLanes = hn::FixedTag<float, 2>;

// Cosines are off by less; bounds leave room for it.
constexpr float kSlack = 1e-5f;
constexpr float kMinCosine = 1e-4f;

// Lights that are farther or brighter count as these, so that products of both stay finite.
constexpr double kFarthest = 1e30;  // squared distance
constexpr double kBrightest = 1e30;

constexpr std::uint32_t kBuckets = 12;

struct Split {
    int axis = -1;  // -1: none
    double at = 0;  // middles below it are on one side
};

double coordinate(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// Where both halves together have the least measure, among kBuckets equal slices of each axis.
Split best_split(const std::vector<LightBounds>& bounds, const std::uint32_t* first, const std::uint32_t* end) {
    Box middles;
    for (const std::uint32_t* i = first; i != end; ++i) middles.add(bounds[*i].center);
    const Vec3d size = middles.high - middles.low;
    const double widest = max_abs(size);
    Split best;
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double low = coordinate(middles.low, axis), extent = coordinate(size, axis);
        if (!(extent > 0)) continue;
        std::array<std::optional<LightBounds>, kBuckets> slices;
        const auto add = [](std::optional<LightBounds>& sum, const LightBounds& b) { sum = sum ? *sum + b : b; };
        for (const std::uint32_t* i = first; i != end; ++i) {
            const double slice = (coordinate(bounds[*i].center, axis) - low) / extent * kBuckets;
            add(slices[std::min(static_cast<std::uint32_t>(slice), kBuckets - 1)], bounds[*i]);
        }
        std::array<double, kBuckets> cost{};  // cost of a split behind each slice
        std::optional<LightBounds> below, above;
        for (std::uint32_t s = 0; s + 1 < kBuckets; ++s) {
            if (slices[s]) add(below, *slices[s]);
            cost[s] += below->measure();
        }
        for (std::uint32_t s = kBuckets - 1; s > 0; --s) {
            if (slices[s]) add(above, *slices[s]);
            cost[s - 1] += above->measure();
        }
        for (std::uint32_t s = 0; s + 1 < kBuckets; ++s) {
            const double c = cost[s] * widest / extent;  // no long thin halves
            if (c < least) {
                least = c;
                best = {axis, low + extent * (s + 1) / kBuckets};
            }
        }
    }
    return best;
}

}  // namespace

void LightTree::Pair::set(std::uint32_t half, const LightBounds& b) {
    x[half] = static_cast<float>(b.center.x);
    y[half] = static_cast<float>(b.center.y);
    z[half] = static_cast<float>(b.center.z);
    const double radius = b.radius + 4e-7 * (max_abs(b.center) + b.radius) + 1e-15;
    radius2[half] = static_cast<float>(std::min(radius * radius, kFarthest));
    axis_x[half] = static_cast<float>(-b.axis.x);
    axis_y[half] = static_cast<float>(-b.axis.y);
    axis_z[half] = static_cast<float>(-b.axis.z);
    const SinCos spread = sincos_turns(b.spread);
    cos_spread[half] = b.spread < 0.5f ? spread.cos : -2;
    sin_spread[half] = b.spread < 0.5f ? spread.sin : 0;
    cos_falloff[half] = sincos_turns(b.falloff).cos - kSlack;
    intensity[half] = static_cast<float>(std::clamp(b.intensity, double{std::numeric_limits<float>::min()}, kBrightest));
    sides[half] = b.both_sides ? 0x7fffffffu : 0xffffffffu;
}

// For each half: intensity cos cos / distance^2, where both cosines are the greatest that any point of its ball can have. The
// lower lanes hold the one at the surface, the upper ones that at the light. One formula serves both: a normal is a cone, as a
// light's directions are.
LightTree::Halves LightTree::importance(const Pair& pair, const Vec3f& p, const LightSampleContext& context) {
    const Lanes d;
    const HalfOfLanes h;
    const auto twice = [&](const float* v) { return hn::Combine(d, hn::LoadU(h, v), hn::LoadU(h, v)); };
    const auto at_both = [&](float surface, const float* light) {
        return hn::Combine(d, hn::LoadU(h, light), hn::Set(h, surface));
    };
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto other = [&](auto v) {
        return hn::Sqrt(hn::Max(zero, one - v * v));
    };  // the sine for a cosine, or the other way round

    const auto x = twice(pair.x) - hn::Set(d, p.x), y = twice(pair.y) - hn::Set(d, p.y), z = twice(pair.z) - hn::Set(d, p.z);
    const auto to2 = x * x + y * y + z * z, radius2 = twice(pair.radius2),
               distance2 = hn::Min(hn::Max(to2, radius2), hn::Set(d, static_cast<float>(kFarthest)));
    const auto inverse = one / hn::Sqrt(distance2);
    const auto sin_ball = hn::Sqrt(radius2) * inverse, cos_ball = other(sin_ball);

    const bool all_about = context.n == Vec3f{};
    const float all = std::bit_cast<float>(context.both_sides ? 0x7fffffffu : 0xffffffffu);
    const auto sides = hn::Combine(d, hn::BitCast(h, hn::LoadU(hn::RebindToUnsigned<HalfOfLanes>(), pair.sides)), hn::Set(h, all));
    const auto along =
        x * at_both(context.n.x, pair.axis_x) + y * at_both(context.n.y, pair.axis_y) + z * at_both(context.n.z, pair.axis_z);
    const auto cos = hn::And(sides, along * inverse), sin = other(cos);
    const auto cos_spread = at_both(all_about ? -2.0f : 1.0f, pair.cos_spread), sin_spread = at_both(0, pair.sin_spread);
    const auto cos_out = cos * cos_spread + sin * sin_spread, sin_out = sin * cos_spread - cos * sin_spread;  // beyond the cone
    const auto beside = cos_out * cos_ball + sin_out * sin_ball;                                              // and beyond the ball
    const auto greatest = hn::IfThenElse(hn::Or(cos >= cos_spread, cos_out >= cos_ball), one, beside);
    const auto lit = hn::IfThenElse(greatest < at_both(-kSlack, pair.cos_falloff), zero, hn::Max(greatest, hn::Set(d, kMinCosine)));

    float cosines[4], squares[4];
    hn::StoreU(hn::IfThenElse(to2 > radius2, lit, one), d, cosines);
    hn::StoreU(distance2, d, squares);
    const auto bound = [&](int half) {
        return static_cast<double>(pair.intensity[half]) * static_cast<double>(cosines[half] * cosines[half + 2]);
    };
    return {bound(0) * static_cast<double>(squares[1]), bound(1) * static_cast<double>(squares[0])};
}

LightTree::LightTree(const std::vector<LightBounds>& bounds) : trail_(bounds.size()) {
    assert(bounds.size() < kMaxLights);
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < bounds.size(); ++i) {
        if (bounds[i].intensity > 0) order.push_back(i);
    }
    if (order.empty()) return;
    pairs_.reserve(order.size());
    pairs_.resize(1);
    build(0, 0, bounds, order.data(), order.data() + order.size(), 0, 0);
}

LightBounds LightTree::build(std::uint32_t pair, std::uint32_t half, const std::vector<LightBounds>& bounds, std::uint32_t* first,
                             std::uint32_t* end, std::uint32_t depth, std::uint64_t trail) {
    const auto count = static_cast<std::uint32_t>(end - first);
    if (count == 1) {
        pairs_[pair].set(half, bounds[*first]);
        pairs_[pair].next[half] = *first | kLeaf;
        trail_[*first] = trail | std::uint64_t{1} << depth;
        depth_ = std::max(depth_, depth);
        return bounds[*first];
    }
    std::uint32_t* middle = first + count / 2;  // where nothing else tells them apart, or the tree would become too deep
    if (depth + static_cast<std::uint32_t>(std::bit_width(count)) < kMaxDepth) {
        if (const Split split = best_split(bounds, first, end); split.axis >= 0) {
            std::uint32_t* const at = std::stable_partition(
                first, end, [&](std::uint32_t i) { return coordinate(bounds[i].center, split.axis) < split.at; });
            if (at != first && at != end) middle = at;
        }
    }
    const auto next = static_cast<std::uint32_t>(pairs_.size());
    pairs_.emplace_back();
    const LightBounds below = build(next, 0, bounds, first, middle, depth + 1, trail),
                      above = build(next, 1, bounds, middle, end, depth + 1, trail | std::uint64_t{1} << depth);
    const LightBounds both = below + above;
    pairs_[pair].set(half, both);
    pairs_[pair].next[half] = next;
    return both;
}

bool LightTree::reaches(const Vec3f& p, const LightSampleContext& context) const {
    return !pairs_.empty() && importance(pairs_[0], p, context).first > 0;
}

ChosenLight LightTree::choose(Uniform u, const Vec3f& p, const LightSampleContext& context) const {
    double rest = static_cast<double>(u.bits >> 11) * 0x1p-53, probability = 1;
    std::uint32_t next = pairs_[0].next[0];
    while ((next & kLeaf) == 0) {
        const Halves halves = importance(pairs_[next], p, context);
        const double sum = halves.first + halves.second;
        if (!(sum > 0)) return {};
        rest *= sum;
        const bool second = !(rest < halves.first) && halves.second > 0;
        const double part = second ? halves.second : halves.first;
        rest = std::clamp((second ? rest - halves.first : rest) / part, 0.0, 1 - 0x1p-53);
        probability *= part / sum;
        next = pairs_[next].next[second];
    }
    return {next & ~kLeaf, static_cast<float>(probability), {static_cast<std::uint64_t>(rest * 0x1p53) << 11}};
}

float LightTree::probability(std::uint32_t i, const Vec3f& p, const LightSampleContext& context) const {
    if (trail_[i] == 0) return 0;
    double probability = 1;
    std::uint32_t next = pairs_[0].next[0];
    for (std::uint64_t trail = trail_[i]; trail != 1; trail >>= 1) {
        const Halves halves = importance(pairs_[next], p, context);
        const bool second = trail & 1;
        const double part = second ? halves.second : halves.first;
        if (!(part > 0)) return 0;
        probability *= part / (halves.first + halves.second);
        next = pairs_[next].next[second];
    }
    return static_cast<float>(probability);
}

}  // namespace latent::render
