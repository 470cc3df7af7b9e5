// bench/reference_blocks.cpp: turns pictures made by pbrt-v4 into the CSV files of tests/transport/refs (its README.md says how):
// means of CIE XYZ over 64 blocks of 32 x 32 pixels, and their standard errors.
//   reference_blocks PART.exr PART.exr... > NAME.csv                    the mean of independent parts of equally many samples
//   reference_blocks --mean REF.exr N PART.exr PART.exr... > NAME.csv   REF, the mean of N parts of which some are at hand
// Each pixel's variance s^2 comes from the parts, and se = sqrt(sum of s^2 over the block / N) / 1024: there are few parts, but
// many pixels. This takes the noise of pixels for independent; what it says is compared, on stderr, with how much the parts' block
// means differ.
#include <fmt/format.h>

#include <cstdlib>
#include <exception>

#include "bench/picture.h"

namespace {

using namespace latent::bench;
using namespace latent::render::testing;

// The mean of `parts`; of n such parts the error would be as given.
Estimate estimate(const std::vector<Picture>& parts, double n) {
    std::vector<Blocks> blocks;
    for (const Picture& part : parts) blocks.push_back(blocks_of(part));
    const Estimate spread = mean_of(blocks);
    Estimate e = spread;
    const double count = static_cast<double>(parts.size());
    for (auto& block : e.error.xyz) block = {};
    for (std::size_t i = 0; i < kPixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            double mean = 0, squares = 0;
            for (const Picture& part : parts) mean += part[i][c] / count;
            for (const Picture& part : parts) squares += (part[i][c] - mean) * (part[i][c] - mean);
            e.error.xyz[block_of(i)][c] += squares / (count - 1) / n;
        }
    }
    double ratio = 0;
    for (std::size_t b = 0; b < 64; ++b) {
        for (std::size_t c = 0; c < 3; ++c) {
            double& error = e.error.xyz[b][c];
            error = std::sqrt(error) / (kBlock * kBlock);
            ratio += spread.error.xyz[b][c] * spread.error.xyz[b][c] * count / (error * error * n) / (64 * 3);
        }
    }
    fmt::print(stderr, "variance of block means by their spread / by pixels: {:.2f}, {} x 64 x 3 degrees of freedom\n", ratio,
               parts.size() - 1);
    return e;
}

}  // namespace

int main(int argc, char** argv) {
    const bool has_mean = argc > 1 && std::string(argv[1]) == "--mean";
    const int first = has_mean ? 4 : 1;
    if (argc < first + 2) {
        fmt::print(stderr, "usage: reference_blocks [--mean REF.exr N] PART.exr PART.exr...\n");
        return 2;
    }
    try {
        std::vector<Picture> parts;
        for (int i = first; i < argc; ++i) parts.push_back(read_picture(argv[i]));
        Estimate e = estimate(parts, has_mean ? std::atof(argv[3]) : static_cast<double>(parts.size()));
        if (has_mean) e.mean = blocks_of(read_picture(argv[2]));
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
