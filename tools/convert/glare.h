// tools/convert/glare.h: how a lens or an eye spreads the light of a point. Equations: docs/color.md, "Light that spreads".
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "image/blades.h"
#include "image/kernel.h"
#include "tools/convert/field_of_view.h"

namespace latent::convert {

struct Source;

struct Glare {
    std::string text;  // as it was asked for
    bool eye = false;
    // For a lens:
    double f_number = 8;  // that of the circle through the corners between blades
    image::Blades blades{};
    std::filesystem::path aperture{};  // a picture of it, how much light passes; "": blades
    // For an eye:
    FieldOfView field{};
    double age = 30;  // years
};

// "blades:6,f:8", "blades:6:15:0.2,f:8", "f:16", "eye", "eye,age:70,field:60", "FILE.exr,f:8". Errors: kUsage.
Result<Glare> parse_glare(std::string_view text);

// A wavelength, and how much of it each channel of a picture gets.
struct Wavelength {
    double nm = 0;
    std::array<float, 3> weights{};
};
// Weights of white light in the channels of `source`; each channel adds up to 1.
std::vector<Wavelength> wavelengths_of(const Source& source);

// `pixel_um`: the size of a pixel on the sensor. Light goes no farther than `max_radius` pixels. Errors: of reading the picture of
// an aperture.
Result<image::Kernel> lens_kernel(const Glare& glare, double pixel_um, const std::vector<Wavelength>& light, int max_radius);
// `pixel_degrees`: the angle of a pixel.
image::Kernel eye_kernel(const Glare& glare, double pixel_degrees, int radius);

// For a picture that was taken on a frame whose longer side is `frame_mm`.
Result<image::Kernel> glare_kernel(const Glare& glare, const Source& source, double frame_mm, int max_radius);

}  // namespace latent::convert
