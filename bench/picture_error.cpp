// bench/picture_error.cpp: the mean squared error of a renderer's pictures, for bench/equal_time.
//   picture_error REF.csv SEED1.exr SEED2.exr ...     (256 x 256, equally many samples each; REF.csv of tests/transport/refs)
// The error of one picture is its variance, from the differences of the pictures, plus the square of what they have in common: the
// difference of their mean from the reference in blocks of 32 x 32 pixels, less the squared errors of both. All are means over
// X, Y, Z and the picture. Prints the sum; the same without the 0.1 % of pixels where one picture exceeds the others the most; and
// the relative difference of the whole picture's Y from the reference.
#include <fmt/format.h>

#include <exception>
#include <numeric>

#include "bench/picture.h"

namespace {

using namespace latent::bench;
using namespace latent::render::testing;

struct Pixel {
    double excess = 0;    // of the brightest picture over the mean, X + Y + Z
    double variance = 0;  // mean of X, Y, Z
};

Pixel pixel_of(const std::vector<Picture>& pictures, std::size_t i) {
    const double n = static_cast<double>(pictures.size());
    std::array<double, 3> mean{};
    for (const Picture& p : pictures) {
        for (std::size_t c = 0; c < 3; ++c) mean[c] += p[i][c] / n;
    }
    Pixel pixel;
    for (const Picture& p : pictures) {
        double excess = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            excess += p[i][c] - mean[c];
            pixel.variance += (p[i][c] - mean[c]) * (p[i][c] - mean[c]) / (n - 1) / 3;
        }
        pixel.excess = std::max(pixel.excess, excess);
    }
    return pixel;
}

double mean_variance(const std::vector<Pixel>& pixels) {
    return std::accumulate(pixels.begin(), pixels.end(), 0.0, [](double sum, const Pixel& p) { return sum + p.variance; }) /
           static_cast<double>(pixels.size());
}

double squared_bias(const Estimate& ours, const Estimate& reference) {
    double sum = 0;
    for (std::size_t b = 0; b < 64; ++b) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = ours.mean.xyz[b][c] - reference.mean.xyz[b][c];
            sum += difference * difference - ours.error.xyz[b][c] * ours.error.xyz[b][c] -
                   reference.error.xyz[b][c] * reference.error.xyz[b][c];
        }
    }
    return std::max(0.0, sum / (64 * 3));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) return fmt::print(stderr, "usage: picture_error REF.csv SEED.exr SEED.exr...\n"), 2;
    try {
        const Estimate reference = read_reference(argv[1]);
        std::vector<Picture> pictures;
        std::vector<Blocks> blocks;
        for (int i = 2; i < argc; ++i) {
            pictures.push_back(read_picture(argv[i]));
            blocks.push_back(blocks_of(pictures.back()));
        }
        const Estimate ours = mean_of(blocks);
        std::vector<Pixel> pixels;
        for (std::size_t i = 0; i < kPixels; ++i) pixels.push_back(pixel_of(pictures, i));
        const double bias = squared_bias(ours, reference), all = mean_variance(pixels);
        std::sort(pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) { return a.excess < b.excess; });
        pixels.resize(kPixels - kPixels / 1000);
        fmt::print("{:.6g} {:.6g} {:.6g}\n", all + bias, mean_variance(pixels) + bias, compare(ours, reference, 1).whole_relative);
    } catch (const std::exception& e) {
        return fmt::print(stderr, "picture_error: {}\n", e.what()), 1;
    }
    return 0;
}
