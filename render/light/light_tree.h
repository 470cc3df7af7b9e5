// render/light/light_tree.h: a choice among many lights by what each may send to a point [EstevezKulla18]. docs/rendering.md,
// "Choice of lights".
#pragma once

#include <cstdint>
#include <vector>

#include "render/bsdf/light_sample_context.h"
#include "render/light/light_bounds.h"
#include "render/math/vec.h"
#include "render/sampling/uniform.h"

namespace latent::render {

// A light that was chosen, and with which probability; 0: none can shine there. `rest`: what the choice leaves of its number.
struct ChosenLight {
    std::uint32_t light = 0;
    float probability = 0;
    Uniform rest{};
};

// A binary tree of bounds. From the root on, a half is chosen by its importance: a bound on the light that it sends to the point,
// where distance counts from the middle. A light that can shine on a point has a probability there that is greater than 0.
// Does not change once built: any thread.
class LightTree {
 public:
    static constexpr std::uint32_t kMaxDepth = 62;
    static constexpr std::size_t kMaxLights = std::size_t{1} << 31;

    LightTree() = default;
    // Light i has bounds[i]; those without intensity are never chosen.
    explicit LightTree(const std::vector<LightBounds>& bounds);

    bool is_empty() const { return pairs_.empty(); }
    ChosenLight choose(Uniform u, const Vec3f& p, const LightSampleContext& context) const;
    // That `choose` chooses light i.
    float probability(std::uint32_t i, const Vec3f& p, const LightSampleContext& context) const;
    // Whether any of them may shine on p.
    bool reaches(const Vec3f& p, const LightSampleContext& context) const;
    std::uint32_t depth() const { return depth_; }  // how many choices lead to the deepest light

 private:
    // Two halves side by side, as 4 lanes of floats take them.
    struct Pair {
        void set(std::uint32_t half, const LightBounds& bounds);

        float x[2]{}, y[2]{}, z[2]{}, radius2[2]{};   // the ball
        float axis_x[2]{}, axis_y[2]{}, axis_z[2]{};  // turned about: towards who is lit
        float cos_spread[2]{}, sin_spread[2]{}, cos_falloff[2]{}, intensity[2]{};
        std::uint32_t sides[2]{};  // the bits of a cosine that count: not the sign, if both sides are alike
        std::uint32_t next[2]{};   // a pair, or with kLeaf a light
    };
    static constexpr std::uint32_t kLeaf = 1u << 31;

    // The importance of both halves, times what they have in common.
    struct Halves {
        double first, second;
    };
    static Halves importance(const Pair& pair, const Vec3f& p, const LightSampleContext& context);

    LightBounds build(std::uint32_t pair, std::uint32_t half, const std::vector<LightBounds>& bounds, std::uint32_t* first,
                      std::uint32_t* end, std::uint32_t depth, std::uint64_t trail);

    std::vector<Pair> pairs_;           // the first one: the root, and nothing beside it
    std::vector<std::uint64_t> trail_;  // for each light, the choices that lead there, the first one lowest, below a 1; 0: none do
    std::uint32_t depth_ = 0;
};

}  // namespace latent::render
