// render/transport/bidirectional/walk.h: the two subpaths, step by step, and what they hit by themselves: lights (s = 0) and the
// lens (t = 0).
#pragma once

#include "render/transport/bidirectional/subpaths.h"

namespace latent::render {

// A step of a subpath, from its last vertex in unit direction d.
struct Step {
    Vec3f d;
    float pdf = 0;  // [1/sr]; for parallel rays [1/m^2] across them
    bool parallel = false;
    float mis_shorter = 0;  // MisPartial::shorter of the vertex that it will reach
    std::uint32_t medium = kNone;
    bool dispersed = false;
    bool delta = false;      // d comes from a delta function, whatever else the vertex does
    bool scattered = false;  // some vertex before was left in another way
    SampledSpectrum beta;
    SampledSpectrum throughput{1.0f};  // the subpath's, which decides whether it goes on
};

class SubpathWalk : public SubpathSample {
 public:
    using SubpathSample::SubpathSample;

    void trace_light();
    void trace_camera(Vec2d film);

 private:
    // Names the decisions of the step that leads to vertex i, and those of scattering there.
    static std::uint32_t dimension(bool from_camera, std::size_t i, std::uint32_t what) {
        const auto vertex = static_cast<std::uint32_t>(i);
        return from_camera ? Dimension::of_camera_vertex(vertex - 1, what) : Dimension::of_light_vertex(vertex, what);
    }
    Uniform number(bool from_camera, std::size_t i, std::uint32_t what) const {
        return sample_.numbers(dimension(from_camera, i, what));
    }

    // Extends a subpath step by step until it is absorbed, leaves, or is long enough.
    void walk(Subpath& path, bool from_camera, Step& step);

    // Follows a step to the vertex that it reaches and appends that; gathers what shines on the way, or the lens that it hits.
    // False: there is none, or none that could be connected within the depth.
    bool find_vertex(Subpath& path, bool from_camera, Step& step);

    bool append(Subpath& path, bool from_camera, SubpathVertex& x, const Step& step, const LineOfSight& line, float density);

    // Square of the density of the light subpath's first point as sampled from its second vertex x, over that as the start of a
    // ray.
    float light_point_ratio2(const SubpathVertex& x, const SubpathVertex& first, const Vec3f& d, float d2) const;

    // s = 0: the camera's step ends on a light, of this id. Densities of that point: `pdf_forward` as the end of the step,
    // `pdf_point` as a sampled point of the light, `pdf_ray` as the start of a ray; `pdf_reverse`: of the last camera vertex from
    // there.
    void add_emission(SampledSpectrum value, const Step& step, float pdf_forward, float pdf_point, float pdf_ray, float pdf_reverse,
                      std::uint32_t light);
    void see_light(const SurfaceHit& hit, const Step& step, const LineOfSight& line);
    void see_infinite_lights(const Step& step, const LineOfSight& line);

    // t = 0: the light's step hits the lens on this segment, if nothing scatters it before. Lights that are a point or a direction
    // are themselves invisible, in mirrors and through glass too, as they are to a path from the camera. No other strategy makes
    // such a path, so no weight counts on this one.
    void reach_lens(const Step& step, LineOfSight line, Segment segment);
};

}  // namespace latent::render
