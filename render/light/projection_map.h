// render/light/projection_map.h: a picture that a point projects. docs/rendering.md, "Lights".
#pragma once

#include <memory>

#include "render/light/rgb_illuminant.h"
#include "render/sampling/pixel_distribution.h"
#include "render/scene/description.h"

namespace latent::render {

// In light space, which looks along z, the picture fills the rectangle |x| <= reach_x, |y| <= reach_y of the plane z = 1; `fov`
// spans its shorter side. A pixel is a constant intensity. Directions are drawn by the pixels' luminance and solid angle: the
// density of (x, y) times dA/domega = (1 + x^2 + y^2)^(3/2).
class ProjectionMap {
 public:
    ProjectionMap(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light, double fov_degrees,
                  SpectrumLibrary& library, color::RgbSpectra kind);

    Vec3f sample(Uniform u, Uniform v) const;  // unit direction
    float pdf_omega(const Vec3f& w) const;     // 0 beside the picture
    // False: beside the picture.
    bool multiply(const Vec3f& w, SampledSpectra& spectra, SampledSpectrum& value) const;

    double luminous_intensity() const { return luminous_intensity_; }  // integral of luminance over solid angle
    Vec3f axis() const { return world_from_light_.z; }
    float corner() const;  // 1 - cos of the angle between the axis and the picture's corners

 private:
    struct Place {
        std::uint32_t x, y;  // pixel
        float area_per_solid_angle;
    };
    bool find(const Vec3f& w, Place& out) const;

    std::shared_ptr<const ImageDescription> image_;
    Affinef world_from_light_, light_from_world_;  // rotations
    double reach_x_, reach_y_;
    RgbIlluminant colors_;
    PixelDistribution pixels_;  // by luminance times solid angle
    double luminous_intensity_ = 0;
};

}  // namespace latent::render
