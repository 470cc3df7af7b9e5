#include "tests/transport/closed_forms.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>

namespace latent::render::testing {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReflectance = 0.5;

// A floor in z = 0, seen by a camera that covers +- `half` about the origin.
std::string floor_seen(double half) {
    return fmt::format(
        "LookAt 3 0 3  0 0 0  0 0 1\nCamera \"orthographic\" \"float screenwindow\" [{0} {1} {0} {1}]\nWorldBegin\n"
        "Material \"diffuse\" \"spectrum reflectance\" [360 {2} 830 {2}]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-99 -99 0  99 -99 0  0 99 0] \"integer indices\" [0 1 2]\n",
        -half, half, kReflectance);
}

// A square of side 2 `half` at height z of 2 x columns x rows triangles that face up or down.
std::string grid(double half, double z, bool up, std::uint32_t columns, std::uint32_t rows) {
    std::string text = "Shape \"trianglemesh\" \"point3 P\" [";
    auto out = std::back_inserter(text);
    for (std::uint32_t y = 0; y <= rows; ++y) {
        for (std::uint32_t x = 0; x <= columns; ++x)
            fmt::format_to(out, " {} {} {}", half * (2.0 * x / columns - 1), half * (2.0 * y / rows - 1), z);
    }
    text += "] \"integer indices\" [";
    for (std::uint32_t y = 0; y < rows; ++y) {
        for (std::uint32_t x = 0; x < columns; ++x) {
            const std::uint32_t a = y * (columns + 1) + x, b = a + 1, c = a + columns + 1, d = c + 1;
            if (up) {
                fmt::format_to(out, " {} {} {} {} {} {}", a, b, d, a, d, c);
            } else {
                fmt::format_to(out, " {} {} {} {} {} {}", a, d, b, a, c, d);
            }
        }
    }
    return text + "]\n";
}

const char* const kLamp = "AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\"\n";

// Share of a hemisphere's cosine that a square of side 2 `half`, parallel to the floor at height z, fills above the origin.
double form_factor(double half, double z) {
    const double a = half / z, s = std::sqrt(1 + a * a);
    return 4 / kPi * (a / s) * std::atan(a / s);
}

}  // namespace

ClosedForm lamp_among_large_triangles(std::uint32_t triangles, double distance) {
    const int log2 = std::bit_width(triangles / 4) - 1;
    const std::uint32_t columns = 1u << (log2 + 1) / 2, rows = 1u << log2 / 2;
    const double half = 0.01;  // too small to be found by chance: all of its light is from points drawn on it
    const std::string text =
        floor_seen(1e-3) + kLamp + grid(half, 2, false, columns, rows) + grid(half * std::sqrt(200), 3, true, columns, rows);
    return {.name = fmt::format("a lamp of {} of {} triangles{}", 2 * columns * rows, 4 * columns * rows,
                                distance == 0 ? "" : fmt::format(", moved by {:g}", distance)),
            .scene = scene_from(distance == 0 ? text : moved(text, distance)),
            .y = kReflectance * form_factor(half, 2)};
}

ClosedForm lamp_behind_lid(double gap) {
    return {.name = fmt::format("a lamp {:g} mm behind a lid, from 10 m", gap * 1e3),
            .scene = scene_from(floor_seen(1e-3) + grid(0.1, 10 - gap, false, 1, 1) + kLamp + grid(0.05, 10, false, 1, 1)),
            .y = 0,
            .whole = kReflectance * form_factor(0.05, 10)};
}

ClosedForm lamp_far_away(double distance, double cosine) {
    const double half = distance * 5e-4, z = distance * cosine, x = distance * std::sqrt(1 - cosine * cosine);
    return {.name = fmt::format("a lamp {:g} m away, cosine {:g}", distance, cosine),
            .scene = scene_from(floor_seen(1e-3 * std::min(1.0, z)) + fmt::format("Translate {} 0 0\n", x) + kLamp +
                                grid(half, z, false, 1, 1)),
            .y = kReflectance / kPi * 4 * half * half * cosine * cosine / (distance * distance)};
}

ClosedForm narrow_spot(double cone_degrees) {
    // The floor is looked at from 45 degrees, so a window of 2 `half` sees sqrt(2) times that of it upwards.
    const double height = 10, half = 1.3 * height * std::tan(cone_degrees * kPi / 180), area = 4 * half * half * std::sqrt(2);
    return {.name = fmt::format("the pool of a spot of {:g} degrees", cone_degrees),
            .scene = scene_from(floor_seen(half) +
                                fmt::format("LightSource \"spot\" \"float power\" 1 \"point3 from\" [0 0 {}] \"point3 to\" [0 0 0] "
                                            "\"float coneangle\" {} \"float conedeltaangle\" {}\n",
                                            height, cone_degrees, cone_degrees / 4)),
            .y = kReflectance / kPi / area};
}

ClosedForm narrow_beam(double cone_degrees) {
    // Light at distance z from the spot has lost e^(-sigma z); on its way to the camera at D e^(-sigma D). It is scattered evenly.
    const double sigma = 0.05, D = 5, low = 4.5, high = 5.5, half = 1.3 * high * std::tan(cone_degrees * kPi / 180);
    const double along = (std::exp(-sigma * low) - std::exp(-sigma * high)) / sigma, area = 2 * half * (high - low);
    const std::string fog = fmt::format(
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [360 0 830 0] \"spectrum sigma_s\" "
        "[360 {0} 830 {0}]\nMediumInterface \"\" \"fog\"\n",
        sigma);
    return {
        .name = fmt::format("the beam of a spot of {:g} degrees in fog", cone_degrees),
        .scene = scene_from(
            fog +
            fmt::format("LookAt {} 0 0  0 0 0  0 0 1\nCamera \"orthographic\" \"float screenwindow\" [{} {} -0.5 0.5]\nWorldBegin\n"
                        "MediumInterface \"\" \"fog\"\nLightSource \"spot\" \"float power\" 1 \"point3 from\" [0 0 5] "
                        "\"point3 to\" [0 0 0] \"float coneangle\" {} \"float conedeltaangle\" {}\n",
                        D, -half, half, cone_degrees, cone_degrees / 4)),
        .y = sigma / (4 * kPi) * along * std::exp(-sigma * D) / area};
}

ClosedForm infinite_light_of_one_pixel(std::uint32_t size, std::uint32_t x, std::uint32_t y, const std::string& rotation) {
    Scene scene = scene_under_sky(floor_seen(1e-3) + rotation + "\nLightSource \"infinite\" \"string filename\" \"sky.exr\"\n");
    LightDescription& light = scene.description.lights[0];
    ImageDescription image{size, size, std::vector<float>(3 * std::size_t{size} * size)};
    constexpr float kRadiance = 1e4f;
    std::fill_n(image.rgb.begin() + 3 * (std::ptrdiff_t{y} * size + x), 3, kRadiance);
    light.image = std::make_shared<ImageDescription>(std::move(image));

    // The mean direction of the pixel, by the equal-area octahedral map in double [Clarberg08].
    constexpr int kFine = 64;
    Vec3d mean;
    for (int i = 0; i < kFine * kFine; ++i) {
        const double u = 2 * (x + (i % kFine + 0.5) / kFine) / size - 1, v = 2 * (y + (i / kFine + 0.5) / kFine) / size - 1;
        const double up = std::abs(u), vp = std::abs(v), outside = up + vp - 1, r = 1 - std::abs(outside);
        const double phi = (r == 0 ? 1 : (vp - up) / r + 1) * kPi / 4, s = r * std::sqrt(2 - r * r);
        mean +=
            Vec3d{std::copysign(std::cos(phi), u) * s, std::copysign(std::sin(phi), v) * s, outside > 0 ? r * r - 1 : 1 - r * r} *
            (1.0 / (kFine * kFine));
    }
    const double cosine = light.world_from_light.vector(mean).z;
    return {.name = fmt::format("pixel ({}, {}) of an infinite light of {} x {}{}", x, y, size, size,
                                rotation.empty() ? "" : ", " + rotation),
            .scene = std::move(scene),
            .y = kReflectance / kPi * static_cast<double>(kRadiance) * 4 * kPi / (static_cast<double>(size) * size) * cosine};
}

}  // namespace latent::render::testing
