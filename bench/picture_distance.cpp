// bench/picture_distance.cpp: how far a picture is from another, for bench/preview.
//   picture_distance REFERENCE.exr PICTURE.exr
// Prints the mean over all pixels of the absolute difference of the second channel, relative to the mean of the reference.
#include <fmt/format.h>

#include <cmath>
#include <exception>

#include "bench/exr.h"

namespace {

double distance(const latent::bench::Planes& reference, const latent::bench::Planes& picture) {
    if (picture.width != reference.width || picture.height != reference.height)
        throw std::runtime_error("the pictures differ in size");
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < reference.pixels(); ++i) {
        const double expected = static_cast<double>(reference.channels[1][i]);
        difference += std::abs(static_cast<double>(picture.channels[1][i]) - expected);
        sum += expected;
    }
    if (!(sum > 0)) throw std::runtime_error("the reference is black");
    return difference / sum;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return fmt::print(stderr, "usage: picture_distance REFERENCE.exr PICTURE.exr\n"), 2;
    try {
        fmt::print("{:.4g}\n", distance(latent::bench::read_planes(argv[1]), latent::bench::read_planes(argv[2])));
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "picture_distance: {}\n", e.what());
        return 1;
    }
}
