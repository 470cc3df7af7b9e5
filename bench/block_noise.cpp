// bench/block_noise.cpp: how much pictures of independent seeds differ, at equal samples: rows of docs/rendering.md, "The numbers
// of a sample".
//   block_noise SCENE.pbrt|lamp|spot [SAMPLES [SEEDS [pixels|halton]]]     samples of one picture (65536); seeds (16)
// The sampler is told of 64 x 64 pixels. Prints, by path and by bdpt, the root mean square of the standard deviation of Y over 32 x
// 32, 45 x 45, 64 x 64, 96 x 96 and 128 x 128 blocks of the film, in percent of the mean of the picture: without the noisiest 2 %
// of the blocks, and of all. `lamp` and `spot`: a grey floor under one light (tests/transport/lit_floor.h).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "tests/transport/blocks.h"
#include "tests/transport/lit_floor.h"

namespace {

using namespace latent::render;
using namespace latent::render::testing;

constexpr std::array<std::size_t, 5> kSides = {32, 45, 64, 96, 128};

// Of all blocks but the noisiest, of which `left_out` of 1 do not count.
double noise_of(const std::vector<Blocks>& pictures, double left_out) {
    const Estimate e = mean_of(pictures);
    std::vector<double> variances;
    double sum = 0;
    for (std::size_t b = 0; b < e.mean.xyz.size(); ++b) {
        variances.push_back(e.error.xyz[b][1] * e.error.xyz[b][1] * static_cast<double>(pictures.size()));
        sum += e.mean.xyz[b][1];
    }
    std::ranges::sort(variances);
    variances.resize(variances.size() - static_cast<std::size_t>(left_out * static_cast<double>(variances.size())));
    const double variance = std::accumulate(variances.begin(), variances.end(), 0.0);
    return std::sqrt(variance * static_cast<double>(e.mean.xyz.size())) / sum;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: block_noise SCENE.pbrt|lamp|spot [SAMPLES [SEEDS [pixels|halton]]]\n");
        return 2;
    }
    const std::string name = argv[1];
    const std::uint64_t samples = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 65'536;
    const int seeds = argc > 3 ? std::max(2, std::atoi(argv[3])) : 16;
    const bool halton = argc > 4 && std::string(argv[4]) == "halton";
    latent::sampledb::PositionSamplerSpec positions;  // none: by pixels
    if (halton) positions.sampler = latent::sampledb::PositionSampler::kHalton23;
    const Scene scene = name == "lamp"   ? scene_from(floor_under_lamp())
                        : name == "spot" ? scene_from(floor_under_spot())
                                         : scene_of(load_scene(name));
    fmt::print("{}: {} samples of each of {} seeds by {}, % of Y\n", name, samples, seeds, halton ? "halton" : "pixels");
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
        std::array<std::vector<Blocks>, kSides.size()> pictures;
        for (int seed = 1; seed <= seeds; ++seed) {
            const std::unique_ptr<Integrator> integrator = scene.integrator({.kind = kind,
                                                                             .max_depth = 0,
                                                                             .record = latent::sampledb::RecordKind::kXyz,
                                                                             .positions = positions,
                                                                             .seed = static_cast<std::uint64_t>(seed)});
            std::vector<BlockSums> sums(kSides.begin(), kSides.end());
            latent::sampledb::Records records;
            RadianceFaults faults;
            for (std::uint64_t n = 0; n < samples; ++n) {
                records.clear();
                integrator->trace(n, records, faults);
                for (BlockSums& sum : sums) sum.add(records);
            }
            for (std::size_t i = 0; i < kSides.size(); ++i) pictures[i].push_back(sums[i].picture(samples));
        }
        fmt::print("  {:5}", kind == IntegratorKind::kPath ? "path" : "bdpt");
        for (std::size_t i = 0; i < kSides.size(); ++i)
            fmt::print(" {}: {:.3g} ({:.3g})", kSides[i], 100 * noise_of(pictures[i], 0.02), 100 * noise_of(pictures[i], 0));
        fmt::print("\n");
        std::fflush(stdout);
    }
    return 0;
}
