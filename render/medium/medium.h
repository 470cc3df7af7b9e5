// render/medium/medium.h: what absorbs and scatters between surfaces, each wavelength differently. docs/rendering.md, "Media".
#pragma once

#include <cstdint>
#include <optional>

#include "render/bsdf/phase.h"
#include "render/medium/march.h"
#include "render/sampling/sample_state.h"
#include "render/scene/bounds.h"
#include "render/spectral/sampled_spectrum.h"

namespace latent::render {

// A step along a segment. What multiple importance sampling compares are means over the k wavelengths that depend on the two ends
// alone: the same for whatever subpath takes the step, and whatever tentative collisions there are. Where the medium varies they
// are those of a coarse picture of it, near the densities that steps are drawn with.
struct MediumStep {
    bool scattered;
    float t;              // [m]: where, or the length of the segment
    float density;        // density of a vertex at t [1/m], or the probability of passing the segment
    float transmittance;  // along the way to t
    float column;         // [m]: integral of the medium's relative density along that way; its length if the medium is homogeneous
};

inline float mean_over(const SampledSpectrum& value, std::uint32_t k) {
    float sum = 0;
    for (std::uint32_t i = 0; i < k; ++i) sum += value[i];
    return sum / static_cast<float>(k);
}

class Medium {
 public:
    explicit Medium(const PhaseFunction& phase) : phase_(phase) {}
    virtual ~Medium() = default;

    // At a point; valid as long as the sample.
    virtual Phase phase(const Vec3f&, SampleState&) const { return phase_; }

    // That holds all of it, in the world: light from infinity can enter. None: it fills all space.
    virtual std::optional<Box> box() const = 0;
    virtual bool is_emissive() const = 0;
    // Varies in space: what passes through it is found in steps, so that a shadow ray takes as long as the path to its next vertex.
    virtual bool is_tracked() const { return false; }
    // Tracking takes time in proportion to this: the optical depth of a cell between whose bounds on the extinction it steps; else
    // 0.
    virtual float deepest_cell(const SpectrumLibrary&) const { return 0; }

    // Analogue tracking: draws where light scatters next, if it does on this segment. With T the transmittance in each wavelength,
    // value *= an estimate of sigma_s T over the density of a vertex there, or of T over the probability that nothing scatters.
    // `emitted`, unless null: += value times an estimate of what the segment itself sends back along it.
    virtual MediumStep sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample,
                                   SampledSpectrum& value, SampledSpectrum* emitted) const = 0;
    // A vertex after t: value *= sigma_s T.
    virtual MediumStep scatter_at(const Segment& segment, float t, SampleState& sample, SampledSpectrum& value) const = 0;
    // The whole segment: value *= T, or an estimate of it whose mean is T.
    virtual MediumStep multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const = 0;
    // density / transmittance of a vertex at p after a way of this column: makes the probability of passing a segment the density
    // of a vertex at its end.
    virtual float scattering_over_transmittance(const Vec3f& p, float column, SampleState& sample) const = 0;

 private:
    PhaseFunction phase_;
};

// What lies between two vertices: the probability of passing all of it, and the segments at both ends.
struct LineOfSight {
    float transmittance = 1;
    std::uint32_t first_medium = kNone, last_medium = kNone;
    float first_column = 0, last_column = 0;

    void add(const Segment& segment, float segment_transmittance, float column) {
        transmittance *= segment_transmittance;
        if (segment.index == 0) {
            first_medium = segment.medium;
            first_column = column;
        }
        last_medium = segment.medium;
        last_column = column;
    }
};

}  // namespace latent::render
