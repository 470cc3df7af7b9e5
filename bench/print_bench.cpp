// bench/print_bench.cpp: what a pixel of the print costs: XYZ -> linear RGB -> 8 bits, per instruction set, against the double
// reference. Input: one row of 4096 pixels (48 KB, as convert's strips are: in cache), chromaticities in and out of sRGB,
// luminances 2^-8..2^4. Every timed row is checked against the reference before it is timed. Unit: ns per pixel (the counter
// `pixel`), CPU time.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "base/simd_dispatch.h"
#include "color/print.h"
#include "color/quantise.h"

namespace latent::color {
namespace {

constexpr std::size_t kPixels = 4096;

struct Planes {
    std::vector<float> a = std::vector<float>(kPixels), b = a, c = a;
};

const Planes& picture() {
    static const Planes planes = [] {
        Planes p;
        std::mt19937 random(1);
        std::uniform_real_distribution<double> xy(0.1, 0.6), octave(-8, 4);
        for (std::size_t i = 0; i < kPixels;) {
            const double x = xy(random), y = xy(random), luminance = std::exp2(octave(random));
            if (x + y >= 1) continue;
            p.a[i] = static_cast<float>(x / y * luminance);
            p.b[i] = static_cast<float>(luminance);
            p.c[i++] = static_cast<float>((1 - x - y) / y * luminance);
        }
        return p;
    }();
    return planes;
}

Print make_print(Gamut gamut) { return *Print::create(RgbSpace::srgb(), {.sigma = 1, .tone = Tone::kFilm, .gamut = gamut}); }

void check(const Print& print, const Planes& out) {
    PrintReport report;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const Rgb rgb = print.pixel({picture().a[i], picture().b[i], picture().c[i]}, report);
        if (!(std::abs(rgb.r - out.a[i]) + std::abs(rgb.g - out.b[i]) + std::abs(rgb.b - out.c[i]) < 1e-3)) {
            fmt::print(stderr, "print_bench: pixel {} differs from the reference\n", i);
            std::exit(1);
        }
    }
}

void count_pixels(benchmark::State& state) {
    state.counters["pixel"] = benchmark::Counter(static_cast<double>(state.iterations()) * kPixels,
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void reference(benchmark::State& state, Gamut gamut) {
    const Print print = make_print(gamut);
    PrintReport report;
    Planes out;
    for (auto step : state) {
        for (std::size_t i = 0; i < kPixels; ++i) {
            const Rgb rgb = print.pixel({picture().a[i], picture().b[i], picture().c[i]}, report);
            out.a[i] = static_cast<float>(rgb.r);
            out.b[i] = static_cast<float>(rgb.g);
            out.c[i] = static_cast<float>(rgb.b);
        }
        benchmark::ClobberMemory();
    }
    count_pixels(state);
}

void rows(benchmark::State& state, Gamut gamut, std::int64_t target) {
    use_simd_targets(target);
    const Print print = make_print(gamut);
    PrintReport report;
    Planes out;
    for (auto step : state) {
        print.row(picture().a, picture().b, picture().c, out.a, out.b, out.c, report);
        benchmark::ClobberMemory();
    }
    check(print, out);
    count_pixels(state);
}

void codes(benchmark::State& state, bool dither, std::int64_t target) {
    use_simd_targets(target);
    Planes linear;
    PrintReport report;
    make_print(Gamut::kLuminance).row(picture().a, picture().b, picture().c, linear.a, linear.b, linear.c, report);
    std::vector<std::uint8_t> out(3 * kPixels);
    const Quantiser quantiser{.transfer = Transfer::srgb(), .dither = dither ? Dither::kRandom : Dither::kNone};
    std::uint32_t row = 0;
    for (auto step : state) {
        quantiser.to_8_bits(linear.a, linear.b, linear.c, 0, row++, out);
        benchmark::ClobberMemory();
    }
    for (std::size_t i = 0; i < kPixels; ++i) {
        if (!(std::abs(out[3 * i] - 255 * quantiser.transfer.encode(linear.a[i])) <= 1.001)) std::exit(1);
    }
    count_pixels(state);
}

void add(const std::string& name, const auto& function) {
    benchmark::RegisterBenchmark(name.c_str(), function)->Repetitions(3)->ReportAggregatesOnly();
}

}  // namespace
}  // namespace latent::color

int main(int argc, char** argv) {
    using namespace latent::color;
    add("reference/luminance", [](benchmark::State& state) { reference(state, Gamut::kLuminance); });
    add("reference/grey", [](benchmark::State& state) { reference(state, Gamut::kGrey); });
    for (std::int64_t rest = latent::simd_targets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
        const std::int64_t target = rest & -rest;
        const std::string name = hwy::TargetName(target);
        add("luminance/" + name, [target](benchmark::State& state) { rows(state, Gamut::kLuminance, target); });
        add("grey/" + name, [target](benchmark::State& state) { rows(state, Gamut::kGrey, target); });
        add("8 bits/" + name, [target](benchmark::State& state) { codes(state, false, target); });
        add("8 bits, dithered/" + name, [target](benchmark::State& state) { codes(state, true, target); });
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
