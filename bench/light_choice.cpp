// bench/light_choice.cpp: what choosing lights by place is worth, beside choosing them by power: the table of docs/rendering.md,
// "Choice of lights".
//   light_choice [SCENE [SEEDS]]     corridor, ring, points, fog, lamps or a .pbrt file; all; seeds (4)
// For path and for bdpt, at 1, 16 and 256 samples per pixel of a picture of 64 x 64: noise by power and by place, which is the
// standard deviation of Y between seeds, root mean square over the pixels but for the 2 % that vary the most, in % of the mean; CPU
// time per sample by place over that by power; and how much longer the choice by power takes to the same noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "tests/transport/blocks.h"
#include "tests/transport/many_lights.h"

namespace {

using namespace latent::render;
using namespace latent::render::testing;

constexpr std::uint32_t kSide = 64;

struct Noise {
    double percent, seconds, mean;  // CPU time of a sample; of Y
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Noise noise_of(const Scene& scene, IntegratorSettings settings, std::uint64_t samples_per_pixel, int seeds) {
    const std::uint64_t samples = samples_per_pixel * kSide * kSide;
    std::vector<Blocks> pictures;
    double seconds = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        settings.seed = static_cast<std::uint64_t>(seed);
        const std::unique_ptr<Integrator> integrator = scene.integrator(settings);
        BlockSums sums(kSide);
        latent::sampledb::Records records;
        RadianceFaults faults;
        const double begin = cpu_seconds();
        for (std::uint64_t n = 0; n < samples; ++n) {
            records.clear();
            integrator->trace(n, records, faults);
            sums.add(records);
        }
        seconds += cpu_seconds() - begin;
        pictures.push_back(sums.picture(samples));
    }
    std::vector<double> variance(pictures[0].xyz.size());
    double sum = 0;
    for (std::size_t p = 0; p < variance.size(); ++p) {
        double first = 0, second = 0, count = 0;  // at one sample per pixel some pixels have none
        for (const Blocks& picture : pictures) {
            const double y = picture.xyz[p][1];
            if (!std::isfinite(y)) continue;
            first += y;
            second += y * y;
            ++count;
        }
        if (count < 2) continue;
        sum += first / count;
        variance[p] = std::max(0.0, (second - first * first / count) / (count - 1));
    }
    std::sort(variance.begin(), variance.end());
    const std::size_t kept = variance.size() * 98 / 100;
    double mean = 0;
    for (std::size_t p = 0; p < kept; ++p) mean += variance[p] / static_cast<double>(kept);
    const double level = sum / static_cast<double>(variance.size());
    return {100 * std::sqrt(mean) / level, seconds / static_cast<double>(samples) / seeds, level};
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string wanted = argc > 1 ? argv[1] : "";
    const int seeds = argc > 2 ? std::max(2, std::atoi(argv[2])) : 4;
    const std::pair<std::string, Scene> scenes[] = {{"corridor", scene_from(corridor(400))},
                                                    {"ring", scene_from(shining_ring(64))},
                                                    {"points", scene_from(points_of_light(20, false))},
                                                    {"fog", scene_from(points_of_light(20, true))},
                                                    {"lamps", scene_from(three_lamps())},
                                                    {"cornell", scene_named("cornell.pbrt")}};
    fmt::print("{} x {} pixels, {} seeds\n", kSide, kSide, seeds);
    fmt::print(
        "| scene | integrator | samples per pixel | by power | by place | time | gain |\n|---|---|---:|---:|---:|---:|---:|\n");
    const auto run = [&](const std::string& name, const Scene& scene) {
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            for (const std::uint64_t spp : {1, 16, 256}) {
                IntegratorSettings settings{.kind = kind, .max_depth = 0, .record = latent::sampledb::RecordKind::kXyz};
                const Noise place = noise_of(scene, settings, spp, seeds);
                settings.light_choice = LightChoice::kByPower;
                const Noise power = noise_of(scene, settings, spp, seeds);
                const double time = place.seconds / power.seconds, noise = power.percent / place.percent;
                fmt::print("| {} | `{}` | {} | {:.3g} | {:.3g} | {:.2f} | {:.2g} |\n", name,
                           kind == IntegratorKind::kPath ? "path" : "bdpt", spp, power.percent, place.percent, time,
                           noise * noise / time);
                std::fflush(stdout);
                if (std::abs(place.mean / power.mean - 1) > 0.1) fmt::print(stderr, "{}: the two differ in their mean\n", name);
            }
        }
    };
    bool found = false;
    for (const auto& [name, scene] : scenes) {
        if (!wanted.empty() && wanted != name) continue;
        run(name, scene);
        found = true;
    }
    if (!found) run(wanted, scene_of(load_scene(wanted)));
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "light_choice: %s\n", e.what());
    return 1;
}
