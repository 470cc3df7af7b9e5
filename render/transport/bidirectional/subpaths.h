// render/transport/bidirectional/subpaths.h: one sample of bidirectional path tracing: two subpaths, and what joining them gives.
// docs/rendering.md, "Bidirectional".
#pragma once

#include "render/transport/bidirectional/bdpt.h"
#include "render/transport/transport.h"

namespace latent::render {

using Subpath = std::vector<SubpathVertex>;

// A step of a subpath, from its last vertex in unit direction d.
struct Step {
    Vec3f d;
    float pdf = 0;  // [1/sr]; of parallel rays [1/m^2] across them
    bool parallel = false;
    float before = 0;  // of the vertex that it will reach
    std::uint32_t medium = kNone;
    bool dispersed = false;
    Batch beta;
    Batch through{1.0f};  // throughput of the subpath, for its odds of going on
};

class Bidirectional {
 public:
    Bidirectional(const World& world, const IntegratorSettings& settings, const RecordMaker& records, SampleState& sample,
                  Subpath& eye, Subpath& light, const StrategyFault& fault, Radiance& camera, sampledb::Records& out,
                  RadianceFaults& faults)
        : world_(world),
          lights_(world.lights()),
          all_(settings.connections == Connections::kAll),
          most_(settings.max_depth == kUnlimited ? kUnlimited : settings.max_depth + 2),
          records_(records),
          sample_(sample),
          eye_(eye),
          light_(light),
          fault_(fault),
          camera_(camera),
          out_(out),
          faults_(faults) {}

    void trace(double u, double v);

 private:
    Uniform eye_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_camera_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    Uniform light_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_light_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    // Numbers of the step that leads to vertex i, and of scattering there.
    Uniform number(bool from_eye, std::size_t i, std::uint32_t what) const {
        return from_eye ? eye_number(i - 1, what) : light_number(i, what);
    }

    // Of strategy (s, t), `others` the sum of (p_j / p)^2 over the other strategies.
    float weight(std::size_t s, std::size_t t, float others) const {
        return (s == fault_.s && t == fault_.t ? fault_.factor : 1) / (1 + others);
    }

    void trace_eye(double u, double v);

    void trace_light();

    // Extends a subpath step by step until it is absorbed, leaves, or is long enough.
    void walk(Subpath& path, bool from_eye, Step& step);

    // Follows a step to the vertex that it reaches and appends that; gathers what shines on the way, or the lens that it meets.
    // False: there is none, or none that could be connected within the depth.
    bool find_vertex(Subpath& path, bool from_eye, Step& step);

    bool append(Subpath& path, bool from_eye, SubpathVertex& x, const Step& step, const Line& line, float density);

    // Square of the density of the light subpath's first point as sampled from its second vertex x, over that as the start of a
    // ray.
    float resampled(const SubpathVertex& x, const SubpathVertex& first, const Vec3f& d, float d2) const;

    // Density, for the end x of a line, of what the line has to do with it: the odds of passing the line, or, in a medium, of being
    // stopped at x.
    float passed_to(const SubpathVertex& x, std::uint32_t medium, float length, float passing) const {
        return medium == kNone || !x.in_medium ? passing
                                               : passing * scattering_over_passing(world_.medium(medium), length, sample_.spectra);
    }
    float passed_to(const SubpathVertex& first, const Line& line) const {
        return passed_to(first, line.first_medium, line.first_length, line.passing);
    }

    // s = 0: the eye's step ends on light i. `forward`: density of that point; `point` and `ray`: densities of the same by sampling
    // a point of the light, and as the start of a ray; `reverse`: density of the eye's last vertex from there.
    void add_emission(Batch value, const Step& step, float forward, float point, float ray, float reverse);
    void see_light(const SurfaceHit& hit, const Step& step, const Line& line);
    void see_sky(const Step& step, const Line& line);

    // t = 0: the light's step meets the lens before it has gone `limit`. Lights that are a point or a direction are themselves
    // invisible, in mirrors and through glass too, as they are to a path from the eye. No other strategy makes such a path, so no
    // weight counts on this one.
    void reach_lens(const Step& step, const Line& so_far, const Ray& ray, float limit);
    void splat(const CameraPoint& point, const Batch& value, bool dispersed);

    // s = 1: a point of a light for eye vertex i.
    void join_light(std::size_t i);

    // t = 1: light vertex i seen from a point of the lens.
    void join_lens(std::size_t i);

    // s, t >= 2: light vertex i with eye vertex j.
    void join(std::size_t i, std::size_t j, float factor);

    // value *= f |w_light.ns| / |w_light.ng| |w_eye.ng|: what light vertex y sends towards the eye, over the cosine's share of d^2.
    static void multiply_light_side(const SubpathVertex& y, const Vec3f& w_eye, Batch& value);

    // Combinatory optimisation [R06 4.6.3]: of the m pairs of connectible vertices that give a path of the same length, one, times
    // m.
    void join_one_of_each_length();

    const World& world_;
    const Lights& lights_;
    const bool all_;
    const std::size_t most_;  // vertices of a path, those on the light and on the lens included
    const RecordMaker& records_;
    SampleState& sample_;
    Subpath& eye_;
    Subpath& light_;
    const StrategyFault& fault_;
    std::uint32_t chosen_ = 0;  // the light that the light subpath starts on
    Radiance& camera_;
    sampledb::Records& out_;
    RadianceFaults& faults_;
};

}  // namespace latent::render
