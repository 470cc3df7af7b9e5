// bench/validate_blocks.cpp: one row of docs/validation.md: developed pictures of several seeds against a reference's block means.
//   validate_blocks NAME CHANNELS REF.csv SEED1.exr SEED2.exr ...     (256 x 256, XYZ, box filter)
// Says on stderr what of CHANNELS (XYZ, or XY where blue is exempt) is beyond the limits of that page; exit status 1 if anything
// is.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <exception>
#include <string>

#include "bench/picture.h"

using namespace latent::bench;
using namespace latent::render::testing;

int main(int argc, char** argv) {
    if (argc < 6) return fmt::print(stderr, "usage: validate_blocks NAME CHANNELS REF.csv SEED.exr SEED.exr...\n"), 2;
    try {
        const std::string judged = argv[2];
        const Estimate reference = read_reference(argv[3]);
        std::vector<Blocks> pictures;
        for (int i = 4; i < argc; ++i) pictures.push_back(blocks_of(read_picture(argv[i])));
        const Estimate ours = mean_of(pictures);
        std::array<std::vector<double>, 3> errors;  // of X, Y, Z [%], sorted
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t b = 0; b < 64; ++b) {
                errors[c].push_back(100 * std::hypot(ours.error.xyz[b][c], reference.error.xyz[b][c]) / reference.mean.xyz[b][c]);
            }
            std::sort(errors[c].begin(), errors[c].end());
        }
        fmt::print("| {} | {} | {:.2f} | {:.2f} |", argv[1], pictures.size(), errors[1][31], errors[1][63]);
        fmt::print(stderr, "{}: median and worst error of blocks in X {:.2f} {:.2f}, in Z {:.2f} {:.2f} %\n", argv[1],
                   errors[0][31], errors[0][63], errors[2][31], errors[2][63]);
        std::string beyond;
        for (std::size_t c = 0; c < 3; ++c) {
            const Verdict v = compare(ours, reference, c);
            fmt::print(" {:+.2f} ± {:.2f} | {:.2f} | {:.2f} |", 100 * v.whole_relative, 100 * v.whole_error, v.worst_z, v.mean_z2);
            if (judged.find("XYZ"[c]) == std::string::npos) continue;
            const auto limit = [&](bool met, const char* what) { beyond += met ? "" : fmt::format(" {} of {};", what, "XYZ"[c]); };
            limit(errors[c][31] <= 0.5, "median error");
            limit(errors[c][63] <= 2, "worst error");
            limit(v.worst_z < 4.5, "worst z");
            limit(v.mean_z2 >= 0.6 && v.mean_z2 <= 1.5, "mean z^2");
            limit(std::abs(v.whole_relative) <= 0.003 || std::abs(v.whole_z) <= 3.5, "whole picture");
        }
        fmt::print("\n");
        fmt::print(stderr, "{}: {}\n", argv[1], beyond.empty() ? "within the limits" : "beyond the limits:" + beyond);
        return beyond.empty() ? 0 : 1;
    } catch (const std::exception& e) {
        return fmt::print(stderr, "validate_blocks: {}\n", e.what()), 2;
    }
}
