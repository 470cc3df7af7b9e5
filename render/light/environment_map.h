// render/light/environment_map.h: an image of all directions, on the equal-area square. docs/rendering.md, "Lights".
#pragma once

#include "render/light/rgb_illuminant.h"
#include "render/math/equal_area.h"
#include "render/sampling/pixel_distribution.h"
#include "render/scene/description.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// Every pixel is a constant: rgb as a spectrum times the light's illuminant.
class EnvironmentMap {
 public:
    EnvironmentMap(std::shared_ptr<const ImageDescription> image, const Affined& world_from_light, SpectrumLibrary& library,
                   color::RgbSpectra kind);

    Vec3f sample(Uniform u, Uniform v) const;  // unit direction
    float pdf_omega(const Vec3f& w) const;
    // True: every direction is in the image.
    bool multiply(const Vec3f& w, SampledSpectra& spectra, SampledSpectrum& value) const;

    double mean_luminance() const { return mean_luminance_; }
    // The mean square of luminance over its squared mean: 1 where it is the same everywhere.
    double contrast() const { return contrast_; }
    double luminous_intensity() const { return 4 * std::numbers::pi * mean_luminance_; }  // integral of luminance over solid angle
    double upper_illuminance() const;  // integral over z > 0 of light space of luminance times cosine

 private:
    struct Pixel {
        std::uint32_t x, y;
    };
    Pixel pixel(const Vec3f& w) const;

    std::shared_ptr<const ImageDescription> image_;
    Affinef world_from_light_, light_from_world_;  // rotations
    RgbIlluminant colors_;
    PixelDistribution pixels_;  // by luminance
    double mean_luminance_ = 0, contrast_ = 1;
};

}  // namespace latent::render
