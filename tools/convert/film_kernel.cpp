#include "tools/convert/film_kernel.h"

#include <algorithm>
#include <cmath>

#include "image/fourier.h"

namespace latent::convert {
namespace {

constexpr int kCells = 2048;  // of 1 um, along a side: light returns within 1 mm
using Plane = std::vector<float>;

// From the middle of a cell to that of the first one, around the edges.
double distance(int cell) { return std::min(cell, kCells - cell); }

// Of the light that returns, adding up to 1: its spectrum, which is real.
Plane returned_spectrum(const image::SquareFourier& fourier) {
    Plane light(static_cast<std::size_t>(kCells) * kCells), zero(light.size());
    double sum = 0;
    for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
            const double value = film::returned_light(std::sqrt(distance(x) * distance(x) + distance(y) * distance(y)));
            light[static_cast<std::size_t>(y) * kCells + static_cast<std::size_t>(x)] = static_cast<float>(value);
            sum += value;
        }
    }
    for (float& value : light) value = static_cast<float>(static_cast<double>(value) / sum);
    fourier.forward(light.data(), zero.data());
    return light;
}

}  // namespace

image::Kernel film_kernel(const FilmBlur& blur, double pixel_um, int most_radius) {
    const image::SquareFourier fourier(kCells);
    Plane returned;
    if (std::ranges::any_of(blur.returned, [](double share) { return share > 0; })) returned = returned_spectrum(fourier);
    // Sharpness alone reaches some tens of micrometres.
    constexpr double kSharpReach = 250;
    const double reach = (returned.empty() ? kSharpReach : kCells / 2) / pixel_um;
    image::Kernel kernel(std::min(most_radius, static_cast<int>(std::ceil(reach)) + 1));
    image::Pattern pattern{kCells, Plane(static_cast<std::size_t>(kCells) * kCells)};
    Plane re(pattern.light.size()), im(re.size());
    std::vector<double> cycles(kCells);
    for (int i = 0; i < kCells; ++i) cycles[static_cast<std::size_t>(i)] = 1000 * distance(fourier.frequency(i)) / kCells;
    for (std::size_t c = 0; c < 3; ++c) {
        std::ranges::fill(im, 0.0F);
        const double share = blur.returned[c], scale = 1.0 / (static_cast<double>(kCells) * kCells);
        for (std::size_t y = 0; y < kCells; ++y) {
            for (std::size_t x = 0; x < kCells; ++x) {
                const std::size_t i = y * kCells + x;
                // What stays where it fell is left out, unless the film blurs it.
                double spread = share > 0 ? share * static_cast<double>(returned[i]) : 0;
                if (blur.half) {
                    const double f = std::sqrt(cycles[x] * cycles[x] + cycles[y] * cycles[y]);
                    spread = (1 - share + spread) * film::contrast_left((*blur.half)[c], f);
                }
                re[i] = static_cast<float>(spread * scale);
            }
        }
        fourier.inverse(re.data(), im.data());
        for (std::size_t y = 0; y < kCells; ++y) {
            for (std::size_t x = 0; x < kCells; ++x)
                pattern.light[(y + kCells / 2) % kCells * kCells + (x + kCells / 2) % kCells] = re[y * kCells + x];
        }
        std::array<float, 3> weights{};
        weights[c] = 1;
        image::add_pattern(pattern, 1 / pixel_um, weights, kernel);
    }
    return kernel;
}

}  // namespace latent::convert
