// render/light/quadric_light.h: a disk, a cylinder or a part of a sphere of an area light. Points are drawn evenly from its area.
#pragma once

#include "render/light/area_emission.h"

namespace latent::render {

class QuadricLight : public AreaEmission {
 public:
    // The shape must outlive the light.
    QuadricLight(const ShapeDescription& shape, const AreaEmission& area) : AreaEmission(area), shape_(&shape) {}

    LightBounds bounds() const;
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const;
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const;

 private:
    Interaction sample(Uniform u, Uniform v) const;

    const ShapeDescription* shape_;
};

}  // namespace latent::render
