#include "tools/inspect/synthetic.h"

#include <fmt/format.h>

#include <numeric>
#include <span>
#include <vector>

#include "base/hash.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// A well mixed 64-bit function of (seed, n, dimension) [SplitMix64].
std::uint64_t mix(std::uint64_t seed, std::uint64_t n, std::uint64_t dimension) {
    std::uint64_t x = seed * 0x9E3779B97F4A7C15u + n * 0xD1342543DE82EF95u + dimension * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
}

float unit(std::uint64_t bits) { return static_cast<float>(bits >> 40) * 0x1p-24f; }  // [0, 1)

// Value noise in two octaves, 8 and 64 patches a side; 0.05 .. 0.8.
float patches(std::uint64_t seed, std::uint32_t u, std::uint32_t v) {
    float sum = 0.05f, weight = 0.5f;
    for (int level = 3; level <= 6; level += 3, weight *= 0.5f) {
        const std::uint32_t x = u >> (32 - level), y = v >> (32 - level);
        const float fx = static_cast<float>(u << level) * 0x1p-32f, fy = static_cast<float>(v << level) * 0x1p-32f;
        const auto corner = [&](std::uint32_t i, std::uint32_t j) {
            return unit(mix(seed, std::uint64_t{x + i} << 32 | (y + j), static_cast<std::uint64_t>(level)));
        };
        const float top = corner(0, 0) + fx * (corner(1, 0) - corner(0, 0));
        const float bottom = corner(0, 1) + fx * (corner(1, 1) - corner(0, 1));
        sum += weight * (top + fy * (bottom - top));
    }
    return sum;
}

// A bell over 360 .. 830 nm that needs no library function, so it is the same on every machine.
WavelengthDensity make_bell_density() {
    std::vector<double> cumulative = {0};
    for (int nm = 360; nm < 830; nm += 5) {
        const double x = (nm + 2.5 - 555) / 90;
        cumulative.push_back(cumulative.back() + 0.1 + 1 / (1 + x * x * (1 + x * x)));
    }
    std::vector<WavelengthDensity::Knot> knots;
    for (std::size_t i = 0; i < cumulative.size(); ++i) {
        knots.push_back({(360u + 5u * static_cast<std::uint32_t>(i)) << 20,
                         static_cast<std::uint64_t>(cumulative[i] / cumulative.back() * 0x1p48)});
    }
    return *WavelengthDensity::from_knots(std::move(knots));
}

const WavelengthDensity& bell_density() {
    static const WavelengthDensity density = make_bell_density();
    return density;
}

// Appends the records of samples, one after another.
class Painter {
 public:
    Painter(const SyntheticScene& scene, const Job& job, Records& records) : scene_(scene), job_(job), records_(records) {}

    void camera(std::uint64_t n) {
        const FilmPosition at = scene_.random_positions ? random_position(n, 1) : position_of(n, job_.positions);
        const bool single = scene_.single_wavelengths > 0 && unit(mix(scene_.seed, n, 2)) < scene_.single_wavelengths;
        add(n, RecordClass::kCamera, at, 1.0f, 3, single);
    }
    void lights(std::uint64_t n) {
        const auto whole = static_cast<std::uint64_t>(scene_.light_records);
        const bool one_more = unit(mix(scene_.seed, n, 4)) < scene_.light_records - static_cast<double>(whole);
        for (std::uint64_t i = 0; i < whole + (one_more ? 1 : 0); ++i) {
            add(n, RecordClass::kLight, random_position(n, 16 + 2 * i), 0.0f, 17 + 2 * i, false);
        }
    }

 private:
    FilmPosition random_position(std::uint64_t n, std::uint64_t dimension) const {
        const std::uint64_t bits = mix(scene_.seed, n, dimension);
        return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
    }

    void add(std::uint64_t n, RecordClass record_class, FilmPosition at, float share, std::uint64_t dimension, bool single) {
        records_.sample.push_back(n);
        records_.record_class.push_back(record_class);
        records_.u.push_back(at.u);
        records_.v.push_back(at.v);
        records_.share.push_back(share);
        const std::uint64_t bits = mix(scene_.seed, n, dimension);
        float luminance = 0, warmth = 0;
        if (scene_.subject == Subject::kUniform) luminance = 1;
        if (scene_.subject == Subject::kTextured && bits % 8 != 0) {  // an eighth of the paths meet no light
            const float noise = unit(bits);
            luminance = patches(scene_.seed, at.u, at.v) * 4 * noise * noise * noise;  // mean 1, with a long tail
            warmth = unit(mix(scene_.seed, at.u >> 27, at.v >> 27)) - 0.5f + 0.05f * unit(bits << 24);
        }
        if (job_.kind == RecordKind::kXyz) {
            records_.x.push_back(luminance * (1 + 0.3f * warmth));
            records_.y.push_back(luminance);
            records_.z.push_back(luminance * (1 - 0.8f * warmth));
        } else {
            add_pairs(bits, luminance, warmth, single);
        }
    }

    void add_pairs(std::uint64_t bits, float luminance, float warmth, bool single) {
        const std::uint16_t k = scene_.batch;
        const auto xi = static_cast<std::uint32_t>(bits >> 8);
        const auto kept = static_cast<std::uint16_t>(bits % k);
        density_.batch(xi, std::span(lambda_).first(k));
        const bool black = luminance == 0;
        records_.pairs.push_back(black ? 0 : single ? 1 : k);
        if (!job_.density.empty()) {
            records_.xi.push_back(xi);
            records_.index.push_back(!black && single && k > 1 ? kept : kNoIndex);
        }
        for (std::uint16_t i = 0; i < k && !black; ++i) {
            if (single && i != kept) continue;
            const float radiance =
                luminance * (1 + warmth * (lambda_[i] - 595) / 235) / 106.856895f;  // equal energy: Y = luminance
            const float scale = single ? 1.0f : 1.0f / static_cast<float>(k);
            records_.power.push_back(radiance * scale / density_.pdf_lambda(lambda_[i]));
            if (job_.density.empty()) records_.lambda_nm.push_back(lambda_[i]);
        }
    }

    const SyntheticScene& scene_;
    const Job& job_;
    Records& records_;
    const WavelengthDensity& density_ = bell_density();
    std::vector<float> lambda_ = std::vector<float>(kMaxPairs);
};

}  // namespace

Job synthetic_job(const SyntheticScene& scene) {
    Job job;
    const bool spectral = scene.kind == RecordKind::kSpectral;
    const std::uint32_t common = std::gcd(scene.aspect.width, scene.aspect.height);
    job.aspect_width = scene.aspect.width / common;
    job.aspect_height = scene.aspect.height / common;
    job.kind = scene.kind;
    job.batch = spectral ? scene.batch : 0;
    if (spectral && !scene.explicit_wavelengths) job.density = bell_density();
    job.light_paths_per_sample = scene.light_records > 0 ? 1 : 0;
    if (!scene.random_positions) job.positions.sampler = PositionSampler::kHalton23;
    const double record_bytes = spectral ? 27.0 + 4.0 * scene.batch * (scene.explicit_wavelengths ? 2 : 1) : 33.0;
    job.precision = scene.precision;
    job.run_bytes = scene.run_bytes;
    job.run_samples = scene.run_samples != 0
                          ? scene.run_samples
                          : default_run_samples(static_cast<std::uint64_t>(record_bytes * (1 + scene.light_records)));
    std::string description =
        fmt::format("synthetic 1: {} {}:{} k={} light={} single={} texture={} random={} explicit={} every={} seed={} S={} R={}",
                    spectral ? "spectral" : "xyz", job.aspect_width, job.aspect_height, job.batch, scene.light_records,
                    scene.single_wavelengths, static_cast<int>(scene.subject), scene.random_positions, scene.explicit_wavelengths,
                    scene.every, scene.seed, job.run_samples, job.run_bytes);
    if (job.precision != kFullPrecision) description += fmt::format(" precision={}", job.precision);
    job.id = hash128(std::as_bytes(std::span(description)));
    return job;
}

Grain synthetic_grain(const SyntheticScene& scene, const Job& job, SampleRange range) {
    Grain grain{range, {}};
    Painter painter(scene, job, grain.records);
    const std::uint64_t begin = range.first + (scene.every - range.first % scene.every) % scene.every;
    for (std::uint64_t n = begin; n < range.end; n += scene.every) {
        painter.camera(n);
        painter.lights(n);
    }
    return grain;
}

}  // namespace latent::inspect
