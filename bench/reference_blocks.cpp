// bench/reference_blocks.cpp: turns pictures made by pbrt-v4 into the CSV files of tests/transport/refs (its README.md says how):
// means of CIE XYZ over 64 blocks of 32 x 32 pixels, and their standard errors.
//   reference_blocks PART.exr PART.exr... > NAME.csv
//     independent parts of equally many samples: their mean; errors from the spread of the parts' block means.
//   reference_blocks --halves REF.exr H1.exr H2.exr SPP_OF_REF SPP_OF_H1 > NAME.csv
//     a mean of which two parts are at hand: errors from their differences pixel by pixel,
//     se = sqrt(sum over the block of ((h1 - h2) / 2)^2) / 1024 x sqrt(2 spp(h1) / spp(ref))
#include <fmt/format.h>

#include <cstdlib>
#include <exception>

#include "bench/picture.h"

namespace {

using namespace latent::bench;
using namespace latent::render::testing;

Estimate from_parts(int count, char** paths) {
    std::vector<Blocks> parts;
    for (int i = 0; i < count; ++i) parts.push_back(blocks_of(read_picture(paths[i])));
    return mean_of(parts);
}

Estimate from_halves(char** arguments) {
    const Picture ref = read_picture(arguments[0]), h1 = read_picture(arguments[1]), h2 = read_picture(arguments[2]);
    const double scale = std::sqrt(2 * std::atof(arguments[4]) / std::atof(arguments[3]));
    Estimate e{blocks_of(ref), {kSide / kBlock, std::vector<std::array<double, 3>>(64)}};
    for (std::size_t i = 0; i < kPixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) e.error.xyz[block_of(i)][c] += (h1[i][c] - h2[i][c]) * (h1[i][c] - h2[i][c]) / 4;
    }
    for (auto& block : e.error.xyz) {
        for (double& squares : block) squares = std::sqrt(squares) / (kBlock * kBlock) * scale;
    }
    return e;
}

}  // namespace

int main(int argc, char** argv) {
    const bool halves = argc == 7 && std::string(argv[1]) == "--halves";
    if (!halves && (argc < 9 || argv[1][0] == '-')) {
        fmt::print(stderr,
                   "usage: reference_blocks PART.exr... (8 parts or more)\n"
                   "       reference_blocks --halves REF.exr H1.exr H2.exr SPP_OF_REF SPP_OF_H1\n");
        return 2;
    }
    try {
        const Estimate e = halves ? from_halves(argv + 2) : from_parts(argc - 1, argv + 1);
        fmt::print("block_x,block_y,X,Y,Z,se_X,se_Y,se_Z\n");
        for (std::size_t b = 0; b < 64; ++b) {
            fmt::print("{},{}", b % 8, b / 8);
            for (const double mean : e.mean.xyz[b]) fmt::print(",{:.8g}", mean);
            for (const double error : e.error.xyz[b]) fmt::print(",{:.4g}", error);
            fmt::print("\n");
        }
    } catch (const std::exception& e) {
        return fmt::print(stderr, "reference_blocks: {}\n", e.what()), 1;
    }
    return 0;
}
