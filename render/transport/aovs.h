// render/transport/aovs.h: what a sample sees, beside light: the first surface on its ray, and the first one that is no mirror and
// no clear glass. docs/rendering.md, "AOVs".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "color/spectrum.h"
#include "render/sampling/sample_state.h"
#include "render/transport/aov_settings.h"
#include "render/world/world.h"

namespace latent::render {

struct Seen {
    Vec2f lens{};    // where the ray met the lens, on the unit disk
    float time = 0;  // from 0, when the shutter opens, to 1
    // At the first surface that scatters light in other ways than a mirror or smooth glass, seen in or through these.
    std::array<float, 3> albedo{};  // XYZ under D65; white has Y = 1
    Vec3f normal{};
    // At the first surface.
    float depth = 0;
    Vec3f position{};
    std::uint32_t object = 0, material = 0;  // counted from 1; 0: none
};

// Appends a row to the columns of aov_columns(settings).
void append(const AovSettings& settings, const Seen& seen, std::span<sampledb::ExtraColumn> columns);

class Aovs {
 public:
    // At most `max_depth` reflections and refractions are followed, and no more than kMaxDeltas.
    Aovs(const World& world, const AovSettings& settings, std::uint32_t max_depth);
    // Along the ray of film point (u, v), with the numbers that the camera subpath takes: no record's light changes by it. Media
    // are looked through.
    Seen look(SampleState& sample, const Camera& camera, double u, double v) const;

 private:
    static constexpr std::uint32_t kMaxDeltas = 64;

    std::array<float, 3> xyz_of(const SampledSpectrum& albedo, const Wavelengths& w) const;

    const World& world_;
    bool looks_;  // at surfaces
    bool follows_deltas_;
    std::uint32_t max_deltas_;
    // CIE 1931 times D65, at integer nm: three values, and a fourth, 0, for vectors; their sums, with Y = 1.
    std::array<std::array<float, 4>, color::kIntegerNmCount> lit_observer_{};
    std::array<float, 3> white_{};
};

}  // namespace latent::render
