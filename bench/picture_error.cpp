// bench/picture_error.cpp: mean squared error of a picture against a reference, less the reference's own noise (for
// bench/equal_time).
//   picture_error PICTURE.exr REFERENCE.exr REFERENCE.exr...     (256 x 256; the reference in independent parts of equal quality)
// Prints the mean over pixels and X, Y, Z; the same without 0.1 % of the pixels, those that are too bright by the most; and the
// relative difference of the whole picture's Y.
#include <fmt/format.h>

#include <exception>
#include <numeric>

#include "bench/picture.h"

using namespace latent::bench;

namespace {

// By pixel: excess over the reference (sum of X, Y, Z), and squared error less the variance of the reference's mean.
struct Pixel {
    double excess = 0, squares = 0;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) return fmt::print(stderr, "usage: picture_error PICTURE.exr REFERENCE.exr REFERENCE.exr...\n"), 2;
    try {
        const Picture picture = read_picture(argv[1]);
        std::vector<Picture> parts;
        for (int i = 2; i < argc; ++i) parts.push_back(read_picture(argv[i]));
        const double n = static_cast<double>(parts.size());
        std::vector<Pixel> pixels(kPixels);
        double ours = 0, reference = 0;
        for (std::size_t i = 0; i < kPixels; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                double mean = 0, spread = 0;
                for (const Picture& part : parts) mean += part[i][c] / n;
                for (const Picture& part : parts) spread += (part[i][c] - mean) * (part[i][c] - mean);
                const double difference = picture[i][c] - mean;
                pixels[i].excess += difference;
                pixels[i].squares += (difference * difference - spread / (n - 1) / n) / 3;
                if (c == 1) ours += picture[i][c], reference += mean;
            }
        }
        const auto mean_square = [](const std::vector<Pixel>& p) {
            return std::accumulate(p.begin(), p.end(), 0.0, [](double sum, const Pixel& q) { return sum + q.squares; }) /
                   static_cast<double>(p.size());
        };
        const double all = mean_square(pixels);
        std::sort(pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) { return a.excess < b.excess; });
        pixels.resize(kPixels - kPixels / 1000);
        fmt::print("{:.6g} {:.6g} {:.6g}\n", all, mean_square(pixels), ours / reference - 1);
    } catch (const std::exception& e) {
        return fmt::print(stderr, "picture_error: {}\n", e.what()), 1;
    }
    return 0;
}
