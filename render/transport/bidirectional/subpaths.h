// render/transport/bidirectional/subpaths.h: the two subpaths of one sample of bidirectional path tracing. docs/rendering.md,
// "Bidirectional path tracing".
#pragma once

#include <cstdint>
#include <vector>

#include "render/transport/bidirectional/weights.h"
#include "render/transport/scattering.h"
#include "render/transport/transport.h"

namespace latent::render {

// Densities are per area (per volume in a medium), for a point at infinity per solid angle; they hold for the whole step, with the
// probability of passing media on the way.
struct SubpathVertex {
    SampledSpectrum beta;  // what arrives here: of importance, or of light
    Interaction at;
    Vec3f normal;                // normal of the surface, the light or the lens; 0: none
    Vec3f wo;                    // to the previous vertex
    Scattering scattering;       // not of the first vertex
    float pdf_forward = 0;       // density from this side
    float to_previous_area = 0;  // times a direction's density [1/sr] here: density of the previous vertex from here
    MisPartial mis;
    std::uint32_t medium = kNone;  // that it was reached through
    MediumInterface media;         // on the sides of its surface
    bool dispersed = false;
    bool in_medium = false;  // not on a surface, a light or the lens
    bool backdrop = false;   // no light subpath meets it

    bool connectible() const { return !scattering.is_delta(); }
    float cosine(const Vec3f& w) const { return normal == Vec3f{} ? 1 : abs_dot(normal, w); }
    // The same for a step that comes here from where w leads; 0: it cannot hit this vertex.
    float cosine_from(const Vec3f& w) const { return !backdrop && scattering.is_met_from(w) ? cosine(w) : 0; }
    std::uint32_t medium_towards(const Vec3f& w) const { return media.towards(w, at.ng, medium); }
};

using Subpath = std::vector<SubpathVertex>;
struct Subpaths {
    Subpath camera, light;
    std::uint32_t start_light = 0;  // the light that the light subpath starts on
};

// S_i of vertex i, connected: `pdf_reverse` its density from the other side, `previous_pdf_reverse` that of the vertex before it.
inline float mis_sum(const Subpath& path, std::size_t i, float pdf_reverse, float previous_pdf_reverse) {
    const SubpathVertex& x = path[i];
    const float shorter = i == 0 ? 0 : mis_term(previous_pdf_reverse, path[i - 1].pdf_forward, x.mis.shorter);
    return mis_term(pdf_reverse, x.pdf_forward, x.mis.end + shorter);
}

// What tracing and joining the subpaths of a sample share.
class SubpathSample {
 public:
    // `seen`: what the camera sees.
    SubpathSample(const World& world, const IntegratorSettings& settings, const TracedSample& sample, Subpaths& subpaths,
                  Radiance& seen)
        : world_(world),
          lights_(world.lights()),
          settings_(settings),
          max_vertices_(settings.max_depth == kUnlimited ? kUnlimited : settings.max_depth + 2),
          sample_(sample.state),
          camera_(sample.camera),
          records_(sample.records),
          subpaths_(subpaths),
          seen_(seen) {}

 protected:
    Uniform camera_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_camera_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    Uniform light_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_light_vertex(static_cast<std::uint32_t>(vertex), what));
    }

    // By a light subpath (t = 0): not where backdrops may hide the lens, which such a subpath does not meet.
    bool lens_can_be_hit() const { return camera_.has_lens() && !world_.has_backdrops(); }

    // The line's share in the density of its end x: the probability of passing the line, or, in a medium, the density of being
    // stopped at x.
    float distance_pdf(const SubpathVertex& x, std::uint32_t medium, float column, float transmittance) const {
        if (medium == kNone || !x.in_medium) return transmittance;
        return transmittance * world_.medium(medium).scattering_over_transmittance(x.at.p, column, sample_);
    }
    float distance_pdf(const SubpathVertex& first, const LineOfSight& line) const {
        return distance_pdf(first, line.first_medium, line.first_column, line.transmittance);
    }

    void write_light(const CameraPoint& point, const SampledSpectrum& value, bool dispersed) {
        Radiance radiance(settings_.light_groups, sample_);
        radiance.add(value, dispersed, lights_[subpaths_.start_light].id());
        records_.light(point, radiance);
    }

    const World& world_;
    const LightSet& lights_;
    const IntegratorSettings& settings_;
    const std::size_t max_vertices_;  // vertices of a path, those on the light and on the lens included
    SampleState& sample_;
    const Camera& camera_;
    SampleRecords& records_;
    Subpaths& subpaths_;
    Radiance& seen_;
};

}  // namespace latent::render
