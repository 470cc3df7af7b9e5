#include "tools/convert/film_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "image/fourier.h"

namespace latent::convert {
namespace {

constexpr int kSide = 2048;  // um, of both patterns, whose cells are 1 um wide
using Plane = std::vector<float>;

// From the middle of a cell to that of the first one, around the edges.
double distance(int cell) { return std::min(cell, kSide - cell); }

std::size_t place(int x, int y) { return static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x); }

int radius_of(double reach_um, double pixel_um, int most) {
    return std::min(most, static_cast<int>(std::ceil(std::min(reach_um, kSide / 2.0) / pixel_um)) + 1);
}

}  // namespace

image::Kernel sharpness_kernel(const film::Triple& half, double pixel_um, int max_radius) {
    // Light falls off by e in 1 / (2 pi half): what goes farther than 12 times that is 3e-5 of it.
    const double reach = 12 * 1000 / (2 * std::numbers::pi * std::ranges::min(half));
    image::Kernel kernel(radius_of(reach, pixel_um, max_radius));
    const image::SquareFourier fourier(kSide);
    image::Pattern pattern{kSide, Plane(static_cast<std::size_t>(kSide) * kSide)};
    Plane re(pattern.light.size()), im(re.size());
    std::vector<double> cycles(kSide);  // per mm
    for (int i = 0; i < kSide; ++i) cycles[static_cast<std::size_t>(i)] = 1000 * distance(fourier.frequency(i)) / kSide;
    for (std::size_t c = 0; c < 3; ++c) {
        std::ranges::fill(im, 0.0F);
        constexpr double kScale = 1.0 / (static_cast<double>(kSide) * kSide);
        for (std::size_t y = 0; y < kSide; ++y) {
            for (std::size_t x = 0; x < kSide; ++x) {
                const double f = std::sqrt(cycles[x] * cycles[x] + cycles[y] * cycles[y]);
                re[y * kSide + x] = static_cast<float>(film::contrast_left(half[c], f) * kScale);
            }
        }
        fourier.inverse(re.data(), im.data());
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x)
                pattern.light[place((x + kSide / 2) % kSide, (y + kSide / 2) % kSide)] = re[place(x, y)];
        }
        std::array<float, 3> weights{};
        weights[c] = 1;
        image::add_pattern(pattern, 1 / pixel_um, weights, kernel);
    }
    return kernel;
}

image::Kernel returned_kernel(const film::Triple& share, double cell_um, int max_radius) {
    image::Kernel kernel(radius_of(kSide / 2.0, cell_um, max_radius));
    image::Pattern pattern{kSide, Plane(static_cast<std::size_t>(kSide) * kSide)};
    double sum = 0;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const double dx = x - kSide / 2, dy = y - kSide / 2, light = film::returned_light(std::sqrt(dx * dx + dy * dy));
            pattern.light[place(x, y)] = static_cast<float>(light);
            sum += light;
        }
    }
    for (float& light : pattern.light) light = static_cast<float>(static_cast<double>(light) / sum);
    std::array<float, 3> weights{};
    for (std::size_t c = 0; c < 3; ++c) weights[c] = static_cast<float>(share[c]);
    image::add_pattern(pattern, 1 / cell_um, weights, kernel);
    return kernel;
}

int returned_cell(double pixel_um) {
    constexpr double kMax = 10;  // um
    return std::max(1, static_cast<int>(kMax / pixel_um));
}

}  // namespace latent::convert
