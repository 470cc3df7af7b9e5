// bench/reference_blocks.cpp: turns reference images made by pbrt-v4 into the CSV files of tests/transport/refs (its README.md says
// how).
//   reference_blocks REF.exr H1.exr H2.exr SPP_OF_REF SPP_OF_H1 > NAME.csv
// Means of CIE XYZ over 64 blocks of 32 x 32 pixels, and their standard errors from two independent parts h1 and h2:
//   se = sqrt(sum over the block of ((h1 - h2) / 2)^2) / 1024 x sqrt(2 spp(h1) / spp(ref))
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <vector>

namespace {

constexpr int kSize = 256, kBlock = 32;

// CIE XYZ of linear RGB as pbrt-v4 makes it (its own D65 table).
constexpr double kXyzFromRgb[3][3] = {
    {0.4124577, 0.3575758, 0.1804372}, {0.2126735, 0.7151516, 0.0721749}, {0.0193340, 0.1191919, 0.9503026}};

std::vector<std::array<double, 3>> read_xyz(const char* path) {
    Imf::InputFile file(path);
    std::vector<float> rgb[3];
    Imf::FrameBuffer frame;
    const char* names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        rgb[c].resize(kSize * kSize);
        frame.insert(names[c],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(rgb[c].data()), sizeof(float), sizeof(float) * kSize));
    }
    file.setFrameBuffer(frame);
    file.readPixels(0, kSize - 1);
    std::vector<std::array<double, 3>> xyz(kSize * kSize);
    for (int i = 0; i < kSize * kSize; ++i) {
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) xyz[i][r] += kXyzFromRgb[r][c] * static_cast<double>(rgb[c][i]);
        }
    }
    return xyz;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 6) return fmt::print(stderr, "usage: reference_blocks REF.exr H1.exr H2.exr SPP_OF_REF SPP_OF_H1\n"), 2;
    try {
        const auto ref = read_xyz(argv[1]), h1 = read_xyz(argv[2]), h2 = read_xyz(argv[3]);
        const double scale = std::sqrt(2 * std::atof(argv[5]) / std::atof(argv[4]));
        fmt::print("block_x,block_y,X,Y,Z,se_X,se_Y,se_Z\n");
        for (int by = 0; by < kSize / kBlock; ++by) {
            for (int bx = 0; bx < kSize / kBlock; ++bx) {
                double mean[3] = {}, squares[3] = {};
                for (int i = 0; i < kBlock * kBlock; ++i) {
                    const int at = (by * kBlock + i / kBlock) * kSize + bx * kBlock + i % kBlock;
                    for (int c = 0; c < 3; ++c) {
                        mean[c] += ref[at][c] / (kBlock * kBlock);
                        squares[c] += (h1[at][c] - h2[at][c]) * (h1[at][c] - h2[at][c]) / 4;
                    }
                }
                fmt::print("{},{}", bx, by);
                for (const double m : mean) fmt::print(",{:.8g}", m);
                for (const double s : squares) fmt::print(",{:.4g}", std::sqrt(s) / (kBlock * kBlock) * scale);
                fmt::print("\n");
            }
        }
    } catch (const std::exception& e) {
        return fmt::print(stderr, "reference_blocks: {}\n", e.what()), 1;
    }
    return 0;
}
