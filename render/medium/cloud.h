// render/medium/cloud.h: pbrt-v4's cloud: a density of gradient noise that thins out upwards. docs/rendering.md, "Media".
#pragma once

#include "render/medium/heterogeneous.h"
#include "render/scene/volume.h"

namespace latent::render {

// At a point p of the medium's space, y up. Two octaves of the noise's gradient bend the point f p, f the frequency:
//   q <- q + w D(l q),   w = wispiness / 20, wispiness / 40;   l = 10, 19.9
// Five octaves of noise at q and the height make the density, which is within [0, 1]:
//   clamp(clamp(4.5 (1 - y) density sum of 2^-i noise(1.99^(i-1) q), i = 1 .. 5) + 2 max(0, 1/2 - y))
class CloudMedium final : public ScaledMedium {
 public:
    CloudMedium(const PhaseFunction& phase, const Affined& medium_from_unit, const Affined& unit_from_world, std::uint32_t sigma_t,
                std::uint32_t sigma_s, const CloudVolume& volume);

    bool is_emissive() const override { return false; }
    float density(const Vec3f& p) const override;
    bool emission(const Vec3f&, SampleState&, SampledSpectrum&) const override { return false; }

 private:
    Affinef medium_from_unit_;
    CloudVolume volume_;
};

}  // namespace latent::render
