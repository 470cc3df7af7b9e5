// bench/filter_error.cpp: how far a picture of few samples is from pictures of many, for bench/filters.
//   filter_error SENSITIVITY MEANS.exr LIMIT.exr PICTURE.exr     (XYZ, equal sizes)
// MEANS: the mean of each pixel's square (the box filter, many samples). LIMIT: what PICTURE's filter gives with many samples.
// Prints for PICTURE - MEANS, PICTURE - LIMIT (noise) and LIMIT - MEANS (blur and ringing): the root mean square in linear light
// (Y, over the mean Y) and in print (code values of 8 bits in sRGB, before rounding); then of LIMIT the pixels in dark outlines,
// whose luminance prints more than 8 code values below the darkest that MEANS has within 3 pixels, those among them that print
// black, below half a code value, and the least Y over the mean Y.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "bench/exr.h"
#include "color/print.h"

namespace {

using namespace latent;
using bench::Planes;

std::vector<std::array<double, 3>> printed(const Planes& picture, double sigma) {
    const color::RgbSpace& srgb = color::RgbSpace::srgb();
    const color::Print print = *color::Print::create(
        srgb, {sigma, color::Tone::kFilm, color::Gamut::kLuminance, color::Matrix3{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}});
    color::PrintReport ignored;
    std::vector<std::array<double, 3>> codes(picture.pixels());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const auto at = [&](std::size_t c) { return static_cast<double>(picture.channels[c][i]); };
        const color::Rgb rgb = print.pixel({at(0), at(1), at(2)}, ignored);
        const double light[] = {rgb.r, rgb.g, rgb.b};
        for (std::size_t c = 0; c < 3; ++c) codes[i][c] = 255 * srgb.transfer.encode(light[c]);
    }
    return codes;
}

// Code values of a grey as bright as each pixel.
std::vector<double> lightness_of(const Planes& picture, double sigma) {
    std::vector<double> codes;
    for (const float y : picture.channels[1])
        codes.push_back(255 * color::Transfer::srgb().encode(std::max(0.0, 1 - std::exp2(-sigma * static_cast<double>(y)))));
    return codes;
}

double darkest_around(const std::vector<double>& codes, const Planes& picture, std::size_t i) {
    const int x = static_cast<int>(i) % picture.width, y = static_cast<int>(i) / picture.width;
    double least = codes[i];
    for (int v = std::max(0, y - 3); v < std::min(picture.height, y + 4); ++v) {
        for (int u = std::max(0, x - 3); u < std::min(picture.width, x + 4); ++u)
            least = std::min(least, codes[static_cast<std::size_t>(v * picture.width + u)]);
    }
    return least;
}

double root_mean_square(std::size_t count, const auto& difference) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += difference(i) * difference(i);
    return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return fmt::print(stderr, "usage: filter_error SENSITIVITY MEANS.exr LIMIT.exr PICTURE.exr\n"), 2;
    try {
        const double sigma = std::stod(argv[1]);
        const Planes pictures[] = {bench::read_planes(argv[2]), bench::read_planes(argv[3]), bench::read_planes(argv[4])};
        std::vector<std::array<double, 3>> codes[3];
        const std::size_t count = pictures[0].pixels();
        for (int i = 0; i < 3; ++i) {
            if (pictures[i].pixels() != count) throw std::runtime_error("pictures of different sizes");
            codes[i] = printed(pictures[i], sigma);
        }
        const auto luminance = [&](int picture, std::size_t i) { return static_cast<double>(pictures[picture].channels[1][i]); };
        double mean = 0;
        for (std::size_t i = 0; i < count; ++i) mean += luminance(0, i) / static_cast<double>(count);
        for (const auto& [a, b] : {std::pair{2, 0}, {2, 1}, {1, 0}}) {
            fmt::print("{:.6g} {:.6g} ",
                       root_mean_square(count, [&](std::size_t i) { return luminance(a, i) - luminance(b, i); }) / mean,
                       root_mean_square(3 * count, [&](std::size_t i) { return codes[a][i / 3][i % 3] - codes[b][i / 3][i % 3]; }));
        }
        const std::vector<double> lightness[] = {lightness_of(pictures[0], sigma), lightness_of(pictures[1], sigma)};
        std::size_t dark = 0, black = 0;
        double least = luminance(1, 0);
        for (std::size_t i = 0; i < count; ++i) {
            const bool outline = lightness[1][i] < darkest_around(lightness[0], pictures[0], i) - 8;
            dark += outline;
            black += outline && lightness[1][i] < 0.5;
            least = std::min(least, luminance(1, i));
        }
        fmt::print("{} {} {:.6g}", dark, black, least / mean);
        fmt::print("\n");
    } catch (const std::exception& e) {
        return fmt::print(stderr, "filter_error: {}\n", e.what()), 1;
    }
    return 0;
}
