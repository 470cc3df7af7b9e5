// sampledb/data/job.h: what all files of one job share, stored in every file's header. Format: docs/format.md, "Header".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/hash.h"
#include "base/result.h"
#include "sampledb/data/film_position.h"
#include "sampledb/data/record.h"
#include "sampledb/data/wavelengths.h"

namespace latent::sampledb {

inline constexpr std::uint8_t kFullPrecision = 23;  // mantissa bits of a float

using JobId = Hash128;  // names scene and settings; files of the same job can be merged

struct ExtraColumnSpec {
    std::string name;
    ColumnType type;
    bool operator==(const ExtraColumnSpec&) const = default;
};

inline constexpr std::uint32_t kMinRunSamples = 1u << 10, kMaxRunSamples = 1u << 22;

struct Job {
    JobId id;
    std::uint32_t aspect_width = 1, aspect_height = 1;  // film aspect, reduced to lowest terms
    RecordKind kind = RecordKind::kXyz;
    std::uint16_t batch = 0;                             // k, wavelengths of one sample (spectral jobs); 0 in XYZ jobs
    WavelengthDensity density;                           // empty: XYZ job, or explicit wavelengths
    double light_unit_cd_m2 = 1.0;                       // luminance of Y = 1
    std::uint32_t light_paths_per_sample = 0;            // 0: no light image
    std::uint32_t run_samples = 1u << 20;                // S, a power of two, 2^10..2^22
    std::uint64_t run_bytes = std::uint64_t{256} << 20;  // R, the cap of a run's raw bytes
    std::uint8_t precision = kFullPrecision;             // mantissa bits of stored values, 1..23
    PositionSamplerSpec positions;
    std::vector<ExtraColumnSpec> extra;

    // Errors: kOutOfRange, naming the field; kUnsupported for a position sampler that this version does not know.
    Status validate() const;
};

// The first field, other than the id, that differs, in words; empty: none.
std::string_view differing_field(const Job& a, const Job& b);

// Two headers describe the same job: equal in every field. Errors: kMismatch, naming the first field that differs.
Status same_job(const Job& a, const Job& b);

// The default S: the power of two that brings a run near 64 MiB raw at `bytes_per_sample`.
std::uint32_t default_run_samples(std::uint64_t bytes_per_sample);

}  // namespace latent::sampledb
