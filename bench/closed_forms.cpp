// bench/closed_forms.cpp: light whose amount is known exactly, at the sizes that tests are too short for: rows of
// docs/validation.md.
//   closed_forms [SAMPLES [SEEDS]]     samples of one seed, in millions (1); seeds (8)
// Ends with status 1 if a row differs from what is known by more than 0.1 % and 4 standard errors of its seeds.
#include "tests/transport/closed_forms.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "tests/transport/picture_mean.h"

namespace {

using namespace latent::render;
using namespace latent::render::testing;

// Mean of the relative difference from what is known, and its standard error.
struct Difference {
    double mean = 0, error = 0;
};

Difference difference_of(ClosedForm& form, IntegratorKind kind, std::uint64_t samples, std::uint32_t seeds) {
    form.settings.kind = kind;
    double sum = 0, squares = 0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        form.settings.seed = seed;
        const double difference =
            (mean_of_picture(form.scene, form.settings, samples).xyz[1] - form.y) / form.whole.value_or(form.y);
        sum += difference;
        squares += difference * difference;
    }
    const double mean = sum / seeds;
    return {mean, std::sqrt(std::max(0.0, squares / seeds - mean * mean) / (seeds - 1))};
}

}  // namespace

int main(int argc, char** argv) {
    const auto samples = static_cast<std::uint64_t>((argc > 1 ? std::atof(argv[1]) : 1) * 1e6);
    const std::uint32_t seeds = argc > 2 ? static_cast<std::uint32_t>(std::max(2, std::atoi(argv[2]))) : 8;
    const std::vector<std::function<ClosedForm()>> forms = {
        [] { return lamp_among_large_triangles(1024); },
        [] { return lamp_among_large_triangles(16'384); },
        [] { return lamp_among_large_triangles(131'072); },
        [] { return lamp_among_large_triangles(1 << 20); },
        [] { return lamp_among_large_triangles(1 << 20, 1e6); },
        [] { return lamp_behind_lid(9e-4); },
        [] { return lamp_behind_lid(2e-5); },
        [] { return lamp_far_away(1e5, 0.01); },
        [] { return narrow_spot(0.5); },
        [] { return narrow_spot(0.1); },
        [] { return narrow_spot(0.01); },
        [] { return narrow_beam(0.1); },
        [] { return infinite_light_of_one_pixel(2048, 1024, 1024, ""); },
        [] { return infinite_light_of_one_pixel(2048, 1024, 1024, "Rotate 50 1 2 0"); },
        [] { return infinite_light_of_one_pixel(2048, 0, 0, "Rotate 180 1 2 0"); },
    };
    fmt::print("{} samples of each of {} seeds\n\n", samples, seeds);
    fmt::print("| light | path, % off | bdpt, % off |\n|---|---|---|\n");
    bool good = true;
    for (const auto& make : forms) {
        ClosedForm form = make();
        fmt::print("| {} |", form.name);
        for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kBdpt}) {
            const Difference d = difference_of(form, kind, samples, seeds);
            good = good && std::abs(d.mean) <= 1e-3 + 4 * d.error;
            fmt::print(" {:+.3f} ± {:.3f} |", 100 * d.mean, 100 * d.error);
            std::fflush(stdout);
        }
        fmt::print("\n");
    }
    return good ? 0 : 1;
}
