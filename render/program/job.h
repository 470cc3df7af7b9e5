// render/program/job.h: from a scene and settings to the job that files name, and to the samples that this process is to render.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/load/load_scene.h"
#include "render/transport/integrator.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"

namespace latent::render {

// Raised by every change of the code that changes the value of a record: files of different epochs are different jobs.
inline constexpr std::uint32_t kRenderEpoch = 14;

struct Resolution {
    std::uint32_t width, height;
};
struct Shard {
    std::uint64_t index = 0, count = 1;
};

// The median of the relative standard error of a picture's pixels (tools/develop/noise/noise.h).
struct NoiseTarget {
    double relative = 0;
    std::uint32_t width = 0;  // the picture's; 0: what is rendered for
};

// What the command line says; what it leaves out, the scene decides.
struct RenderSettings {
    std::filesystem::path scene;
    bool strict = false;  // a scene with warnings is refused; notes are not warnings
    std::optional<IntegratorKind> integrator;
    Connections connections = Connections::kOne;
    std::optional<std::uint32_t> max_depth;
    sampledb::RecordKind record = sampledb::RecordKind::kSpectral;
    std::uint32_t wavelengths = 28;
    std::uint64_t seed = 0;
    sampledb::PositionSampler sampler = sampledb::PositionSampler::kPixels;
    std::uint32_t precision = 9;      // mantissa bits of stored values; docs/format.md, "Rounding", says why
    std::uint32_t run_samples = 0;    // 0: such that a run is near 64 MiB
    std::uint64_t texture_cache = 0;  // TextureSettings::cache_bytes
    color::RgbSpectra rgb_spectra = color::RgbSpectra::kSmooth;  // what the colours of the scene stand for
    ModelOptions model{};
    std::vector<std::filesystem::path> additions{};  // files of pbrt's that are added to the scene
    bool light_groups = false;                       // records say whose light they are
    AovSettings aovs{};                              // records say what is seen
    std::string simd = "best";                       // or a level of base/simd.h

    double spp = 16;  // samples per pixel of `resolution`, or of the scene's film
    std::optional<Resolution> resolution;
    std::optional<sampledb::SampleRange> samples;  // instead of spp
    std::vector<std::filesystem::path> more_than;  // whose samples are rendered already: the first to render follows their last
    std::filesystem::path output;                  // never counts among these
    Shard shard;
};

// Everything that tracing needs. Parts refer to each other: it stays where it is.
struct RenderJob {
    LoadedScene scene;
    std::unique_ptr<Integrator> integrator;
    sampledb::Job job;
    sampledb::SampleRange all;              // what all shards render
    sampledb::SampleRange range;            // what this process renders
    IntegratorSettings settings;            // as the command line and the scene give them together
    Resolution resolution{};                // that counts samples
    std::uint64_t raw_sample_bytes = 0;     // at least, uncompressed
    std::vector<std::string> light_groups;  // their names, by number; empty: records do not tell lights apart
    std::vector<std::string> warnings;
};

// What tracing has met in files since `prepare`: those of the integrator's warnings that are not among `job.warnings`.
std::vector<std::string> later_warnings(const RenderJob& job);

// Errors: those of the scene and of `more_than`; kUsage for a range that is empty or too large, or a SIMD level that this processor
// does not have.
Result<std::unique_ptr<RenderJob>> prepare(const RenderSettings& settings);

// The samples of shard `shard` of `all`: whole runs (but for the ends of `all`), contiguous, in order, as even as can be. A shard
// may be empty where there are more shards than runs.
sampledb::SampleRange shard_of(const sampledb::SampleRange& all, const Shard& shard, std::uint32_t run_samples);

}  // namespace latent::render
