// bench/block_noise.cpp: how much pictures of independent seeds differ, at equal samples: rows of docs/rendering.md, "The numbers
// of a sample".
//   block_noise SCENE.pbrt|lamp|spot [SAMPLES [SEEDS]]     samples of one picture (65536); seeds (16)
// Prints, by path and by bdpt, the root mean square of the standard deviation of Y over 8 x 8 and over 64 x 64 blocks of the film,
// in percent of the mean of the picture. `lamp` and `spot`: a grey floor under one light (tests/transport/lit_floor.h).
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "tests/transport/blocks.h"
#include "tests/transport/lit_floor.h"

namespace {

using namespace latent::render;
using namespace latent::render::testing;

double noise_of(const std::vector<Blocks>& pictures) {
    const Estimate e = mean_of(pictures);
    double variance = 0, sum = 0;
    for (std::size_t b = 0; b < e.mean.xyz.size(); ++b) {
        variance += e.error.xyz[b][1] * e.error.xyz[b][1] * static_cast<double>(pictures.size());
        sum += e.mean.xyz[b][1];
    }
    return std::sqrt(variance * static_cast<double>(e.mean.xyz.size())) / sum;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: block_noise SCENE.pbrt|lamp|spot [SAMPLES [SEEDS]]\n");
        return 2;
    }
    const std::string name = argv[1];
    const std::uint64_t samples = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 65'536;
    const int seeds = argc > 3 ? std::max(2, std::atoi(argv[3])) : 16;
    const Scene scene = name == "lamp"   ? scene_from(floor_under_lamp())
                        : name == "spot" ? scene_from(floor_under_spot())
                                         : scene_of(load_scene(name));
    fmt::print("{}: {} samples of each of {} seeds, % of Y\n", name, samples, seeds);
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        std::vector<Blocks> coarse, fine;
        for (int seed = 1; seed <= seeds; ++seed) {
            const std::unique_ptr<Integrator> integrator = scene.integrator({.kind = kind,
                                                                             .max_depth = 0,
                                                                             .record = latent::sampledb::RecordKind::kXyz,
                                                                             .seed = static_cast<std::uint64_t>(seed)});
            BlockSums in_8(8), in_64(64);
            latent::sampledb::Records records;
            RadianceFaults faults;
            for (std::uint64_t n = 0; n < samples; ++n) {
                records.clear();
                integrator->trace(n, records, faults);
                in_8.add(records);
                in_64.add(records);
            }
            coarse.push_back(in_8.picture(samples));
            fine.push_back(in_64.picture(samples));
        }
        fmt::print("  {:5} 8 x 8: {:.3f}   64 x 64: {:.3f}\n", kind == IntegratorKind::kPath ? "path" : "bdpt",
                   100 * noise_of(coarse), 100 * noise_of(fine));
        std::fflush(stdout);
    }
    return 0;
}
