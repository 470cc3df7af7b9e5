#include "c_api/job.h"

#include <algorithm>
#include <numeric>

#include "c_api/abi.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/page.h"

namespace latent::c {

namespace {

using namespace sampledb;

// The size of a sample that has one record, as large as it can be.
std::uint64_t bytes_per_sample(const Job& job) {
    return sizeof(RecordClass) + decoded_page_size(job, RecordClass::kCamera, 1, job.batch);
}

Error out_of_range(const char* what) { return {ErrorCode::kOutOfRange, std::string("job: ") + what}; }

}  // namespace

Result<Job> job_from(const latent_job* from) {
    const Result<latent_job> taken_job = taken(from, kJobSize, "job");
    if (!taken_job) return taken_job.error();
    const latent_job& given = *taken_job;
    Job job;
    job.id = {given.id_low, given.id_high};
    const std::uint32_t common = std::max(1u, std::gcd(given.aspect_width, given.aspect_height));
    job.aspect_width = given.aspect_width / common;
    job.aspect_height = given.aspect_height / common;
    if (given.kind != LATENT_SPECTRAL && given.kind != LATENT_XYZ)
        return out_of_range("kind is neither LATENT_SPECTRAL nor LATENT_XYZ");
    job.kind = static_cast<RecordKind>(given.kind);
    if (given.batch > kMaxPairs) return out_of_range("batch is above 1024");
    job.batch = static_cast<std::uint16_t>(given.batch);
    if (given.light_unit != 0) job.light_unit_cd_m2 = given.light_unit;
    job.light_paths_per_sample = given.light_paths_per_sample;
    if (given.precision > kFullPrecision) return out_of_range("precision is above 23");
    if (given.precision != 0) job.precision = static_cast<std::uint8_t>(given.precision);
    if (given.sampler > LATENT_PIXELS) return Error{ErrorCode::kUnsupported, "job: unknown position sampler"};
    job.positions = {static_cast<PositionSampler>(given.sampler), given.shift_u, given.shift_v, given.width, given.height};
    if (given.knot_count > 0) {
        if (given.knots == nullptr) return usage_error("job.knots is null");
        if (given.knot_count > 4096) return out_of_range("more than 4096 knots");
        std::vector<WavelengthDensity::Knot> knots;
        for (std::size_t i = 0; i < given.knot_count; ++i) knots.push_back({given.knots[i].wavelength, given.knots[i].cumulative});
        Result<WavelengthDensity> density = WavelengthDensity::from_knots(std::move(knots));
        if (!density) return density.error().at("job");
        job.density = std::move(*density);
    }
    if (given.extra_count > kMaxExtraColumns) return out_of_range("more than 128 extra columns");
    if (given.extra_count > 0 && given.extra == nullptr) return usage_error("job.extra is null");
    for (std::size_t i = 0; i < given.extra_count; ++i) {
        const latent_column& column = given.extra[i];
        if (column.name == nullptr) return usage_error("the name of an extra column is null");
        if (column.type < LATENT_U8 || column.type > LATENT_F64) return out_of_range("an extra column has an unknown type");
        job.extra.push_back({column.name, static_cast<ColumnType>(column.type)});
    }
    job.run_samples = given.run_samples != 0 ? given.run_samples : default_run_samples(bytes_per_sample(job));
    if (given.run_bytes != 0) job.run_bytes = given.run_bytes;
    if (Status s = job.validate(); !s) return s.error();
    return job;
}

}  // namespace latent::c

using latent::Result, latent::Status, latent::sampledb::Job;

latent_status latent_positions(const latent_job* job, const uint64_t* sample, size_t count, uint32_t* u, uint32_t* v,
                               latent_error* error) {
    return latent::c::guarded(error, [&]() -> Status {
        if (count > 0 && (sample == nullptr || u == nullptr || v == nullptr)) return latent::usage_error("sample, u or v is null");
        const Result<Job> made = latent::c::job_from(job);
        if (!made) return made.error();
        if (made->positions.sampler == latent::sampledb::PositionSampler::kNone) {
            return latent::usage_error("the job has no position sampler");
        }
        latent::sampledb::positions_of(std::span(sample, count), made->positions, std::span(u, count), std::span(v, count));
        return {};
    });
}

latent_status latent_wavelengths(const latent_job* job, const uint32_t* xi, size_t count, float* lambda_nm, latent_error* error) {
    return latent::c::guarded(error, [&]() -> Status {
        if (count > 0 && (xi == nullptr || lambda_nm == nullptr)) return latent::usage_error("xi or lambda_nm is null");
        const Result<Job> made = latent::c::job_from(job);
        if (!made) return made.error();
        if (made->density.empty()) return latent::usage_error("the job has no wavelength density");
        for (size_t i = 0; i < count; ++i) made->density.batch(xi[i], std::span(lambda_nm + i * made->batch, made->batch));
        return {};
    });
}
