// bench/rounding_error.cpp: what rounding adds to a picture, beside the noise that it has anyway.
//   rounding_error A.latent B.latent       two renders of one scene, seeds apart, of precision 23 and with a square film
// For each precision and number of samples per pixel: the error of Y that rounding adds to a pixel, the Monte Carlo noise there
// (from the difference of A and B), and their ratio by parts of the film, where the noise is more than a step of an 8-bit print.
//   rounding_error flat                    a region where every sample has the same value: a light, a sky
// The error of a pixel in steps of an 8-bit and a 16-bit sRGB print; the mean over 2^30 equal samples, in standard errors.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "color/observer.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/rounding.h"
#include "sampledb/read/run_set.h"

using namespace latent;
using namespace latent::sampledb;

namespace {

constexpr double kPrintStep = 0.009;  // of white, from one code of an 8-bit sRGB print to the next
constexpr std::array<std::uint8_t, 5> kPrecisions = {15, 11, 9, 8, 7};

int give_up(const std::string& why) {
    fmt::print(stderr, "rounding_error: {}\n", why);
    return 1;
}

// Y of every camera record, as made and as rounded.
struct Samples {
    JobId job;
    std::vector<std::uint32_t> u, v;
    std::vector<float> share;
    std::vector<double> y;
    std::array<std::vector<float>, kPrecisions.size()> added;  // by rounding
};

std::vector<double> luminances(const Job& job, const Page& page) {
    std::vector<double> y(page.count);
    std::vector<float> lambda(job.batch);
    for (std::size_t row = 0, first = 0; row < page.count; ++row) {
        if (job.kind == RecordKind::kXyz) {
            y[row] = static_cast<double>(page.y[row]);
            continue;
        }
        wavelengths_of(job.density, job.batch, page, row, std::span(lambda).first(page.pairs[row]));
        for (std::uint32_t i = 0; i < page.pairs[row]; ++i, ++first)
            y[row] += static_cast<double>(page.power[first]) * color::Observer::cie1931().at(static_cast<double>(lambda[i]))[1];
    }
    return y;
}

Result<Samples> read(const char* name) {
    RunSetOptions options;
    options.inputs = {name};
    const auto opened = RunSet::open(options);
    if (!opened) return opened.error();
    const RunSet& run_set = **opened;
    Job job = run_set.job();
    if (job.precision != kFullPrecision)
        return usage_error(fmt::format("{}: values of {} bits; render with --precision 23", name, job.precision));
    Samples samples;
    samples.job = job.id;
    PageDecoder decoder;
    Page page;
    for (std::size_t run = 0; run < run_set.runs().size(); ++run) {
        const auto pages = run_set.pages(run);
        if (!pages) return pages.error();
        for (const PageInfo& info : **pages) {
            if (info.record_class != RecordClass::kCamera) continue;
            if (Status s = run_set.read_page(run, info, ColumnSet{}, decoder, page); !s) return s.error();
            samples.u.insert(samples.u.end(), page.u.begin(), page.u.begin() + static_cast<std::ptrdiff_t>(page.count));
            samples.v.insert(samples.v.end(), page.v.begin(), page.v.begin() + static_cast<std::ptrdiff_t>(page.count));
            for (std::size_t i = 0; i < page.count; ++i) samples.share.push_back(page.unit_share ? 1 : page.share[i]);
            const std::vector<double> exact = luminances(job, page);
            samples.y.insert(samples.y.end(), exact.begin(), exact.end());
            for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
                Page rounded = page;
                job.precision = kPrecisions[p];
                round_values(job, rounded);
                const std::vector<double> y = luminances(job, rounded);
                for (std::size_t i = 0; i < page.count; ++i) samples.added[p].push_back(static_cast<float>(y[i] - exact[i]));
            }
        }
    }
    return samples;
}

// Means over the pixels of a square grid.
struct Picture {
    std::vector<double> y;
    std::array<std::vector<double>, kPrecisions.size()> added;
};
Picture develop(const Samples& samples, std::size_t side) {
    Picture picture;
    std::vector<double> shares(side * side);
    const auto pixel = [&](std::size_t i) {
        return (std::uint64_t{samples.v[i]} * side >> 32) * side + (std::uint64_t{samples.u[i]} * side >> 32);
    };
    const auto add = [&](std::vector<double>& to, const auto& from) {
        to.resize(side * side);
        for (std::size_t i = 0; i < from.size(); ++i) to[pixel(i)] += static_cast<double>(from[i]);
    };
    add(shares, samples.share);
    add(picture.y, samples.y);
    for (std::size_t p = 0; p < kPrecisions.size(); ++p) add(picture.added[p], samples.added[p]);
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const double scale = shares[i] > 0 ? 1 / shares[i] : 0;
        picture.y[i] *= scale;
        for (std::vector<double>& added : picture.added) added[i] *= scale;
    }
    return picture;
}

int compare_with_noise(const char* a_name, const char* b_name) {
    const Result<Samples> a = read(a_name), b = read(b_name);
    if (!a || !b) return give_up((a ? b : a).error().message);
    if (a->job == b->job) return give_up("both files are of one job; render the other with another --seed");
    fmt::print("{}, {}: {} and {} records\n", a_name, b_name, a->y.size(), b->y.size());
    fmt::print("error of Y over mean Y, root mean square over the film, and rounding / noise in parts of it with noise of 0.9 %\n");
    fmt::print("{:>7} {:>4} {:>10} {:>10} {:>8} {:>8}\n", "samples", "bits", "noise", "rounding", "median", "largest");
    for (const std::size_t per_pixel : {1, 16, 1024}) {
        const auto side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a->y.size() / per_pixel))));
        const Picture one = develop(*a, side), other = develop(*b, side);
        const std::size_t block = std::max<std::size_t>(side / 32, 4);  // pixels a side, whose noise is taken together
        double sum = 0;
        for (const double y : one.y) sum += y;
        const double mean = sum / static_cast<double>(one.y.size());
        for (std::size_t p = 0; p < kPrecisions.size(); ++p) {
            double noise = 0, rounding = 0;
            std::vector<double> ratios;
            for (std::size_t y0 = 0; y0 + block <= side; y0 += block) {
                for (std::size_t x0 = 0; x0 + block <= side; x0 += block) {
                    double n = 0, r = 0, light = 0;
                    for (std::size_t i = 0; i < block * block; ++i) {
                        const std::size_t at = (y0 + i / block) * side + x0 + i % block;
                        n += (one.y[at] - other.y[at]) * (one.y[at] - other.y[at]) / 2;
                        r += one.added[p][at] * one.added[p][at];
                        light += one.y[at] * one.y[at];
                    }
                    noise += n, rounding += r;
                    if (n > kPrintStep * kPrintStep * light) ratios.push_back(std::sqrt(r / n));
                }
            }
            const double pixels = static_cast<double>(side / block * block) * static_cast<double>(side / block * block);
            std::ranges::sort(ratios);
            fmt::print("{:>7} {:>4} {:>10.2e} {:>10.2e} {:>8.5f} {:>8.5f}\n", per_pixel, kPrecisions[p],
                       std::sqrt(noise / pixels) / mean, std::sqrt(rounding / pixels) / mean,
                       ratios.empty() ? 0 : ratios[ratios.size() / 2], ratios.empty() ? 0 : ratios.back());
        }
    }
    return 0;
}

double srgb(double y) { return y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055; }

// A page of equal records of the samples from `first` on.
void fill(const Job& job, std::uint64_t first, std::size_t count, float value, Page& page) {
    page.count = count;
    page.sample.resize(count), page.u.resize(count), page.v.resize(count);
    for (std::size_t i = 0; i < count; ++i) page.sample[i] = first + i;
    halton23(page.sample, job.positions, page.u, page.v);
    page.x.assign(count, value), page.y.assign(count, value), page.z.assign(count, value);
}

int measure_flat() {
    constexpr int kValues = 256, kSamples = 1 << 16;
    Job job;
    job.id = {1, 2};
    job.positions.sampler = PositionSampler::kHalton23;
    Page page;
    fmt::print(
        "{} values from 1/4 to 1: root mean square of the error of a pixel for the worst value, in steps of an sRGB print,\n"
        "and the mean error over {} samples: no band is wider\n",
        kValues, kSamples);
    fmt::print("{:>4} {:>8} {:>10} {:>10} {:>14}\n", "bits", "samples", "of 8 bits", "of 16 bits", "mean, 16 bits");
    for (const std::uint8_t precision : kPrecisions) {
        job.precision = precision;
        for (const std::size_t per_pixel : {1, 16, 1024}) {
            double worst = 0, worst_mean = 0;
            for (int k = 0; k < kValues; ++k) {
                const float value = static_cast<float>(std::exp2(-2.0 * (k + 0.5) / kValues));
                fill(job, static_cast<std::uint64_t>(k) << 20, kSamples, value, page);
                round_values(job, page);
                double squares = 0, sum = 0;
                for (std::size_t first = 0; first < page.count; first += per_pixel) {
                    double pixel = 0;
                    for (std::size_t i = 0; i < per_pixel; ++i)
                        pixel += static_cast<double>(page.y[first + i]) - static_cast<double>(value);
                    const double error = srgb(static_cast<double>(value) + pixel / static_cast<double>(per_pixel)) -
                                         srgb(static_cast<double>(value));
                    squares += error * error;
                    sum += error;
                }
                const double pixels = static_cast<double>(page.count / per_pixel);
                worst = std::max(worst, std::sqrt(squares / pixels));
                worst_mean = std::max(worst_mean, std::abs(sum / pixels));
            }
            fmt::print("{:>4} {:>8} {:>10.4f} {:>10.2f} {:>14.3f}\n", precision, per_pixel, worst * 255, worst * 65535,
                       worst_mean * 65535);
        }
    }
    constexpr std::size_t kAtOnce = 6144;
    for (const std::uint8_t precision : kPrecisions) {
        job.precision = precision;
        const float value = 0.7071f;
        const std::uint64_t samples = std::uint64_t{1} << 30;
        double error = 0, variance = 0;
        const double step = std::exp2(-1.0 - precision), cut = std::fmod(static_cast<double>(value), step);
        for (std::uint64_t first = 0; first < samples; first += kAtOnce) {
            const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(kAtOnce, samples - first));
            fill(job, first, count, value, page);
            round_values(job, page);
            for (std::size_t i = 0; i < count; ++i) error += static_cast<double>(page.y[i]) - static_cast<double>(value);
            variance += static_cast<double>(count) * cut * (step - cut);
        }
        fmt::print("{:>4} bits: the mean of 2^30 samples of {} is off by {:.2e}, {:+.2f} standard errors\n", precision, value,
                   error / static_cast<double>(samples), error / std::sqrt(variance));
        if (std::abs(error) > 4 * std::sqrt(variance)) return give_up("not right in the mean");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 2 && std::strcmp(argv[1], "flat") == 0) return measure_flat();
    if (argc == 3) return compare_with_noise(argv[1], argv[2]);
    return give_up("usage: rounding_error A.latent B.latent, or rounding_error flat");
}
