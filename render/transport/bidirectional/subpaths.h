// render/transport/bidirectional/subpaths.h: one sample of bidirectional path tracing: two subpaths, and what joining them gives.
// docs/rendering.md, "Bidirectional path tracing".
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
    Vec3f normal;                // of the surface, the light or the lens; 0: none
    Vec3f wo;                    // to the previous vertex
    Scattering scattering;       // not of the first vertex
    float pdf_forward = 0;       // density from this side
    float to_previous_area = 0;  // times a direction's density [1/sr] here: density of the previous vertex from here
    MisPartial mis;
    std::uint32_t medium = kNone;  // that it was reached through
    std::uint32_t inside_medium = kNone, outside_medium = kNone;
    bool dispersed = false;
    bool in_medium = false;  // not on a surface, a light or the lens

    bool connectible() const { return !scattering.is_delta(); }
    float cosine(const Vec3f& w) const { return normal == Vec3f{} ? 1 : abs_dot(normal, w); }
    std::uint32_t medium_towards(const Vec3f& w) const {
        if (inside_medium == outside_medium) return medium;
        return dot(w, at.ng) > 0 ? outside_medium : inside_medium;
    }
};

using Subpath = std::vector<SubpathVertex>;
struct Subpaths {
    Subpath camera, light;
};

// S_i of vertex i, connected: `pdf_reverse` its density from the other side, `previous_pdf_reverse` that of the vertex before it.
inline float mis_sum(const Subpath& path, std::size_t i, float pdf_reverse, float previous_pdf_reverse) {
    const SubpathVertex& x = path[i];
    const float shorter = i == 0 ? 0 : mis_term(previous_pdf_reverse, path[i - 1].pdf_forward, x.mis.shorter);
    return mis_term(pdf_reverse, x.pdf_forward, x.mis.end + shorter);
}

// A step of a subpath, from its last vertex in unit direction d.
struct Step {
    Vec3f d;
    float pdf = 0;  // [1/sr]; of parallel rays [1/m^2] across them
    bool parallel = false;
    float mis_shorter = 0;  // MisPartial::shorter of the vertex that it will reach
    std::uint32_t medium = kNone;
    bool dispersed = false;
    bool delta = false;      // d comes from a delta function, whatever else the vertex does
    bool scattered = false;  // some vertex before was left in another way
    SampledSpectrum beta;
    SampledSpectrum throughput{1.0f};  // of the subpath, which decides whether it goes on
};

class Bidirectional {
 public:
    Bidirectional(const World& world, const IntegratorSettings& settings, const RecordMaker& records, SampleState& sample,
                  Subpaths& subpaths, Radiance& radiance, sampledb::Records& out, RadianceFaults& faults)
        : world_(world),
          lights_(world.lights()),
          connect_all_(settings.connections == Connections::kAll),
          max_vertices_(settings.max_depth == kUnlimited ? kUnlimited : settings.max_depth + 2),
          records_(records),
          sample_(sample),
          camera_subpath_(subpaths.camera),
          light_subpath_(subpaths.light),
          radiance_(radiance),
          out_(out),
          faults_(faults) {}

    void trace(double u, double v);

 private:
    Uniform camera_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_camera_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    Uniform light_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_light_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    // Numbers of the step that leads to vertex i, and of scattering there.
    Uniform number(bool from_camera, std::size_t i, std::uint32_t what) const {
        return from_camera ? camera_number(i - 1, what) : light_number(i, what);
    }

    void trace_camera(double u, double v);
    void trace_light();

    // Extends a subpath step by step until it is absorbed, leaves, or is long enough.
    void walk(Subpath& path, bool from_camera, Step& step);

    // Follows a step to the vertex that it reaches and appends that; gathers what shines on the way, or the lens that it meets.
    // False: there is none, or none that could be connected within the depth.
    bool find_vertex(Subpath& path, bool from_camera, Step& step);

    bool append(Subpath& path, bool from_camera, SubpathVertex& x, const Step& step, const LineOfSight& line, float density);

    // Square of the density of the light subpath's first point as sampled from its second vertex x, over that as the start of a
    // ray.
    float light_point_ratio2(const SubpathVertex& x, const SubpathVertex& first, const Vec3f& d, float d2) const;

    // The line's share in the density of its end x: the probability of passing the line, or, in a medium, the density of being
    // stopped at x.
    float distance_pdf(const SubpathVertex& x, std::uint32_t medium, float column, float transmittance) const {
        if (medium == kNone || !x.in_medium) return transmittance;
        return transmittance * world_.medium(medium).scattering_over_transmittance(x.at.p, column, sample_);
    }
    float distance_pdf(const SubpathVertex& first, const LineOfSight& line) const {
        return distance_pdf(first, line.first_medium, line.first_column, line.transmittance);
    }

    // s = 0: the camera's step ends on a light. Densities of that point: `pdf_forward` as the end of the step, `pdf_point` as a
    // sampled point of the light, `pdf_ray` as the start of a ray; `pdf_reverse`: of the last camera vertex from there.
    void add_emission(SampledSpectrum value, const Step& step, float pdf_forward, float pdf_point, float pdf_ray,
                      float pdf_reverse);
    void see_light(const SurfaceHit& hit, const Step& step, const LineOfSight& line);
    void see_infinite_lights(const Step& step, const LineOfSight& line);

    // t = 0: the light's step meets the lens on this segment, if nothing scatters it before. Lights that are a point or a direction
    // are themselves invisible, in mirrors and through glass too, as they are to a path from the camera. No other strategy makes
    // such a path, so no weight counts on this one.
    void reach_lens(const Step& step, LineOfSight line, Segment segment);
    void splat(const CameraPoint& point, const SampledSpectrum& value, bool dispersed);

    // s = 1: a point of a light for camera vertex i.
    void join_light(std::size_t i);

    // t = 1: light vertex i seen from a point of the lens.
    void join_lens(std::size_t i);

    // s, t >= 2: light vertex i with camera vertex j.
    void join(std::size_t i, std::size_t j, float factor);

    // value *= f |w_light.ns| / |w_light.ng| |w_camera.ng|: what light vertex y sends towards the camera, over the cosine's share
    // of d^2.
    static void multiply_light_side(const SubpathVertex& y, const Vec3f& w_camera, SampledSpectrum& value);

    // Combinatory optimisation [R06 4.6.3]: of the m pairs of connectible vertices that give a path of the same length, one, times
    // m.
    void join_one_of_each_length();

    const World& world_;
    const LightSet& lights_;
    const bool connect_all_;
    const std::size_t max_vertices_;  // vertices of a path, those on the light and on the lens included
    const RecordMaker& records_;
    SampleState& sample_;
    Subpath& camera_subpath_;
    Subpath& light_subpath_;
    std::uint32_t start_light_ = 0;  // the light that the light subpath starts on
    Radiance& radiance_;
    sampledb::Records& out_;
    RadianceFaults& faults_;
};

}  // namespace latent::render
