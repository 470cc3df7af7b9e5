// render/world/world.h: a scene as transport sees it: what is where, and what it does to light at the wavelengths of a sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/camera/camera.h"
#include "render/geometry/geometry.h"
#include "render/light/light_set.h"
#include "render/material/material.h"
#include "render/math/motion.h"
#include "render/medium/march.h"
#include "render/medium/medium.h"
#include "render/sampling/sample_state.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"
#include "render/texture/footprint.h"
#include "render/texture/textures.h"
#include "render/world/textured_opacity.h"

namespace latent::render {

class World {
 public:
    // `simd`: of Geometry. Errors: kUnsupported, kOutOfRange; those of Textures.
    static Result<std::unique_ptr<World>> build(const SceneDescription& scene, const std::string& simd,
                                                const TextureSettings& textures = {});
    const Textures& textures() const { return textures_; }

    const Geometry& geometry() const { return *geometry_; }
    // At the start of its motion. What it is, it is at all times: only its place and its axes change.
    const Camera& camera() const { return camera_; }
    // The camera as it is at `time`, if it moves.
    std::optional<Camera> camera_at(float time) const;
    // Whether what is seen depends on the time within the shutter's; if so, that of a sample.
    bool moves() const { return shutter_open_ != shutter_close_; }
    float time(Uniform u) const { return std::clamp(shutter_open_ + u * (shutter_close_ - shutter_open_), 0.0f, 1.0f); }
    // A point as the scene's files have it.
    Vec3d in_file(const Vec3f& p) const { return Vec3d(p) + origin_; }
    const LightSet& lights() const { return *lights_; }
    const SpectrumLibrary& library() const { return library_; }
    const Medium& medium(std::uint32_t i) const { return *media_[i]; }
    bool has_media() const { return !media_.empty(); }
    bool has_dispersion() const { return has_dispersion_; }
    bool has_backdrops() const { return has_backdrops_; }
    // What is beyond everything, where no surface says otherwise. Light from infinity comes through no medium without end.
    std::uint32_t medium_at_infinity() const { return medium_at_infinity_; }
    bool is_endless(std::uint32_t medium) const { return medium != kNone && !media_[medium]->box(); }

    // What the surface at `hit` does to light; valid as long as `spectra` stays at this sample.
    Bsdf bsdf(const SurfaceHit& hit, SampledSpectra& spectra, std::uint32_t kept) const {
        const Material& material = materials_[hit.material];
        TexturePoint point;
        point.spectra = &spectra;
        return material.is_textured() ? textured_bsdf(hit, point, kept) : material.bsdf(hit, point, kept);
    }

    // The medium in which the sample's line along unit d begins at a light source or a lens, which was said to be in `given`;
    // render::medium_at_start.
    std::uint32_t medium_at_start(Vec3f& p, const Vec3f& d, std::uint32_t given, const SampleState& sample) const {
        return has_media() ? render::medium_at_start(*geometry_, p, d, sample.time, given) : kNone;
    }

    // Light along a straight line that starts in `medium`: value *= transmittance, through interfaces and media.
    // False: something stands in the way. To a point, or along unit w as far as it goes. `seen`: from the camera, which backdrops
    // hide things from.
    bool connect(const Interaction& from, const Interaction& to, std::uint32_t medium, SampleState& sample, SampledSpectrum& value,
                 LineOfSight& line, bool seen = false) const;
    bool connect_infinite(const Interaction& from, const Vec3f& w, std::uint32_t medium, SampleState& sample,
                          SampledSpectrum& value, LineOfSight& line) const;

 private:
    World(const Camera& camera, const Footprint& footprint) : camera_(camera), footprint_(footprint) {}
    Bsdf textured_bsdf(SurfaceHit hit, TexturePoint& point, std::uint32_t kept) const;
    std::uint32_t find_medium_at_infinity() const;
    bool connect(const Ray& ray, float length, std::uint32_t medium, SampleState& sample, SampledSpectrum& value,
                 LineOfSight& line) const;

    Camera camera_;
    std::optional<Motion> camera_motion_;
    float shutter_open_ = 0, shutter_close_ = 0;  // equal: nothing moves meanwhile
    Vec3d origin_;
    Footprint footprint_;
    SpectrumLibrary library_;
    Textures textures_;
    TexturedOpacity opacity_{textures_, footprint_};
    std::unique_ptr<const Geometry> geometry_;
    std::vector<Material> materials_;
    std::vector<std::unique_ptr<const Medium>> media_;
    std::unique_ptr<LightSet> lights_;
    std::uint32_t medium_at_infinity_ = kNone;
    bool has_dispersion_ = false, has_backdrops_ = false;
};

}  // namespace latent::render
