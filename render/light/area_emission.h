// render/light/area_emission.h: what a point of a surface emits, whatever the surface's shape: on a side, or on both, one radiance
// for all directions or one that falls off with a power of the cosine, the same everywhere or as a picture has it.
#pragma once

#include <optional>

#include "render/light/light_type.h"
#include "render/scene/description.h"
#include "render/texture/texture.h"

namespace latent::render {

// How emission varies over a shape: a picture, and holes.
struct EmissionPattern {
    const Geometry* geometry;
    std::uint32_t shape;  // index into SceneDescription::shapes
    std::optional<SpectrumSource> picture{};
    FloatSource alpha{.value = 1};

    // value *= that of a point.
    void multiply(std::uint32_t primitive, const EmissionPoint& at, SampledSpectra& spectra, SampledSpectrum& value) const;
};

// What area lights share: each is one of these, of a shape that draws the points. LightType's verbs, but for those that draw.
class AreaEmission {
 public:
    static constexpr bool kIsInfinite = false, kIsDelta = false;
    // `spectrum`: of the library. `pattern` outlives this; null: the same everywhere.
    AreaEmission(const AreaLightDescription& light, std::uint32_t spectrum, const Emitter& emitter, const EmissionPattern* pattern);

    const Emission& emission() const { return emission_; }
    double extent() const {
        return std::numbers::pi * static_cast<double>(area_) * (two_sided_ ? 2 : 1) * mean_ * (2 / (exponent_ + 2.0));
    }
    // In the same box as the light, which shines from a flat surface with normal n, or all about.
    LightBounds flat(LightBounds out, const Vec3d& n) const {
        out.point(n, 0, 0.25f);
        out.both_sides = two_sided_;
        out.concentration = (exponent_ + 2.0) / (2 * std::numbers::pi * (two_sided_ ? 2 : 1));
        return out;
    }
    bool shines(const Vec3f& ng, const Vec3f& d) const { return two_sided_ || dot(ng, d) > 0; }

    float pdf_position() const { return 1 / area_; }
    // Density [1/sr at `from`] of a point drawn evenly from the area.
    float pdf_of_area(const Vec3f& from, const Vec3f& p, const Vec3f& ng) const {
        const Vec3f to = p - from;
        const float d2 = length_squared(to), cosine = abs_dot(to, ng) / std::sqrt(d2);
        return cosine > 0 ? d2 / (cosine * area_) : 0;
    }
    float pdf_omega(const Vec3f& from, const LightSampleContext&, const LightHit& hit) const {
        return pdf_of_area(from, hit.p, hit.ng);
    }
    // The rest of a ray that starts at `at`: its direction by what either side that shines sends there.
    void sample_direction(const Interaction& at, Uniform s, Uniform t, LightRay& out) const;
    float pdf_direction(const Vec3f& ng, const Vec3f& d) const {
        const float c = dot(ng, d), even = two_sided_ ? 0.5f * kInvPi * std::abs(c) : kInvPi * std::max(0.0f, c);
        return exponent_ == 0 ? even : even * 0.5f * (exponent_ + 2) * falloff(ng, d);
    }
    bool multiply_emission(const EmissionPoint& at, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        if (!shines(at.ng, d)) return false;
        emission_.multiply(spectra, value);
        if (exponent_ != 0) value *= falloff(at.ng, d);
        if (pattern_ != nullptr) pattern_->multiply(primitive_, at, spectra, value);
        return true;
    }

 private:
    // |cos|^exponent of d to the normal.
    float falloff(const Vec3f& ng, const Vec3f& d) const;

    Emission emission_;
    float area_;
    float mean_;  // luminance of the picture
    float exponent_;
    bool two_sided_;
    std::uint32_t inside_medium_, outside_medium_, primitive_;
    const EmissionPattern* pattern_;
};

}  // namespace latent::render
