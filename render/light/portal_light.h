// render/light/portal_light.h: a sky, of one radiance or a picture, that shines through a portal alone.
#pragma once

#include <cstdint>

#include "render/light/environment_map.h"
#include "render/light/portal.h"
#include "render/light/scene_ball.h"

namespace latent::render {

// Directions are drawn from those that the portal shows. For a picture, half are drawn by its luminance instead; those beside
// the portal are of no use. Rays come through a disk about the portal, outside of the scene.
class PortalLight {
 public:
    static constexpr bool kIsInfinite = true, kIsDelta = false;
    // The portal and the map must outlive the light; no map: the same from all directions. `ball`: of the scene.
    PortalLight(const LightDescription& light, const Portal& portal, const EnvironmentMap* map, std::uint32_t spectrum,
                const SceneBall& ball);

    const Emission& emission() const { return emission_; }
    // What a portal lets in, were the picture the same everywhere.
    double extent() const { return std::numbers::pi * portal_->area() * (map_ ? map_->mean_luminance() : 1); }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    float pdf_omega(const Vec3f& from, const LightSampleContext&, const LightHit& hit) const;
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;
    float pdf_position() const { return disk_.pdf_position(); }
    float pdf_direction(const Vec3f&, const Vec3f& d) const;
    bool multiply_emission(const EmissionPoint& at, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        if (at.is_met && !portal_->shows(at.p, -d)) return false;  // other points were drawn behind the portal
        emission_.multiply(spectra, value);
        return map_ == nullptr || map_->multiply(-d, spectra, value);
    }
    // Whether it lights p from direction w, if nothing is between them.
    bool reaches(const Vec3f& p, const Vec3f& w) const { return portal_->shows(p, w); }

 private:
    const Portal* portal_;
    const EnvironmentMap* map_;
    Emission emission_;
    SceneBall disk_;  // about the portal
    float distance_;  // from there to outside of the scene
};

}  // namespace latent::render
