// render/transport/bidirectional/join.h: joining the two subpaths: a light's point for the camera subpath (s = 1), the lens for the
// light subpath (t = 1), vertex to vertex (s, t >= 2).
#pragma once

#include "render/transport/bidirectional/subpaths.h"

namespace latent::render {

class SubpathJoin : public SubpathSample {
 public:
    using SubpathSample::SubpathSample;

    void join_all(Connections connections);
    // t = 1: the whole light subpath.
    void join_lens();

 private:
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
};

}  // namespace latent::render
