// tools/inspect/synthetic.h: samples without a scene, for tests, benches and trying things out.
#pragma once

#include <cstdint>

#include "sampledb/data/job.h"
#include "sampledb/write/part_writer.h"

namespace latent::inspect {

// What there is to see.
enum class Subject : std::uint8_t {
    kTextured,  // smooth patches in many sizes, times noise as a path tracer makes it
    kUniform,   // every record is equal-energy white of luminance 1: develops flat
    kBlack,     // every record is 0: the smallest files
};

struct Aspect {
    std::uint32_t width = 1, height = 1;
};

struct SyntheticScene {
    sampledb::RecordKind kind = sampledb::RecordKind::kXyz;
    Aspect aspect;                  // the film's
    std::uint16_t batch = 28;       // spectral: wavelengths of a sample
    double light_records = 0;       // per camera record, on average; a sample has one light path if this is not 0
    double single_wavelengths = 0;  // spectral: fraction of camera records that keep one wavelength
    Subject subject = Subject::kTextured;
    bool random_positions = false;      // stored positions, instead of Halton points that need not be stored
    bool explicit_wavelengths = false;  // spectral: stored wavelengths, as foreign writers have them
    std::uint64_t every = 1;            // only sample numbers divisible by this have records
    std::uint64_t seed = 0;
    std::uint8_t precision = sampledb::kFullPrecision;
    std::uint32_t run_samples = 0;  // 0: the default for this kind
    std::uint64_t run_bytes = std::uint64_t{256} << 20;
};

// The job that these options name: equal options, equal job, equal records.
sampledb::Job synthetic_job(const SyntheticScene& scene);

// The records of `range`: a function of (scene, sample number) alone, the same bits on every machine.
sampledb::Grain synthetic_grain(const SyntheticScene& scene, const sampledb::Job& job, sampledb::SampleRange range);

}  // namespace latent::inspect
