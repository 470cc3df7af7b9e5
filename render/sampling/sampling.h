// render/sampling/sampling.h: uniform numbers to points and directions, and choices by weight. Densities beside each.
// docs/rendering.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "render/math/elementary.h"
#include "render/math/vec.h"

namespace latent::render {

inline constexpr float kInvPi = 1 / kPi;
inline constexpr float kInv4Pi = 1 / (4 * kPi);

// Unit disk, uniform: density 1 / pi. Concentric, so that neighbours stay neighbours [ShirleyChiu97].
inline Vec2f sample_disk(float u, float v) {
    const float x = 2 * u - 1, y = 2 * v - 1;
    if (x == 0 && y == 0) return {0, 0};
    const bool wide = std::abs(x) > std::abs(y);
    const float r = wide ? x : y;
    const SinCos a = sincos_of_turns(wide ? y / x * 0.125f : 0.25f - x / y * 0.125f);
    return {r * a.cos, r * a.sin};
}
// Hemisphere about z: density cos / pi.
inline Vec3f sample_cosine_hemisphere(float u, float v) {
    const Vec2f d = sample_disk(u, v);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}
// Directions at cosine c about z, turned by `turns`.
inline Vec3f direction_at(float c, float turns) {
    const float s = std::sqrt(std::max(0.0f, 1 - c * c));
    const SinCos a = sincos_of_turns(turns);
    return {s * a.cos, s * a.sin, c};
}
// Sphere: density 1 / (4 pi).
inline Vec3f sample_sphere(float u, float v) { return direction_at(1 - 2 * u, v); }
// Triangle, uniform: barycentric weights of its second and third vertex [Heitz19]; density 1 / area.
inline Vec2f sample_triangle(float u, float v) { return u < v ? Vec2f{0.5f * u, v - 0.5f * u} : Vec2f{u - 0.5f * v, 0.5f * v}; }

// Chooses i with probability weight[i] / sum in one step [Walker77].
class Choice {
 public:
    Choice() = default;
    explicit Choice(const std::vector<double>& weight);
    std::uint32_t sample(float u) const {
        const float x = u * static_cast<float>(slots_.size());
        const std::uint32_t slot = std::min(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(slots_.size() - 1));
        return x - static_cast<float>(slot) < slots_[slot].keep ? slot : slots_[slot].other;
    }
    float probability(std::uint32_t i) const { return slots_[i].probability; }
    std::size_t size() const { return slots_.size(); }

 private:
    struct Slot {
        float keep, probability;
        std::uint32_t other;
    };
    std::vector<Slot> slots_;
};

}  // namespace latent::render
