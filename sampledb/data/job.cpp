#include "sampledb/data/job.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <set>

#include "sampledb/data/limits.h"

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kMinRunBytes = std::uint64_t{64} << 10, kMaxRunBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kRunTargetBytes = std::uint64_t{64} << 20;

Error refuse(std::string what) { return {ErrorCode::kOutOfRange, "job: " + std::move(what)}; }

}  // namespace

Status Job::validate() const {
    if (aspect_width == 0 || aspect_height == 0 || std::gcd(aspect_width, aspect_height) != 1) {
        return refuse(fmt::format("film aspect {}:{} is not in lowest terms", aspect_width, aspect_height));
    }
    if (kind == RecordKind::kSpectral) {
        if (batch < 1 || batch > kMaxPairs) return refuse(fmt::format("{} wavelengths per sample, not 1 to {}", batch, kMaxPairs));
    } else if (kind == RecordKind::kXyz) {
        if (batch != 0 || !density.empty()) return refuse("XYZ records have no wavelengths");
    } else {
        return refuse("unknown record kind");
    }
    if (!std::isfinite(light_unit_cd_m2) || light_unit_cd_m2 <= 0) return refuse("light unit is not a positive number");
    if (!std::has_single_bit(run_samples) || run_samples < kMinRunSamples || run_samples > kMaxRunSamples) {
        return refuse(
            fmt::format("{} samples per run: not a power of two from {} to {}", run_samples, kMinRunSamples, kMaxRunSamples));
    }
    if (run_bytes < kMinRunBytes || run_bytes > kMaxRunBytes)
        return refuse(fmt::format("run cap of {} bytes, not 64K to 1G", run_bytes));
    if (precision < 1 || precision > kFullPrecision)
        return refuse(fmt::format("a precision of {} bits, not 1 to {}", precision, kFullPrecision));
    if (positions.sampler > PositionSampler::kPixels) return Error{ErrorCode::kUnsupported, "job: unknown position sampler"};
    const auto is_side = [](std::uint32_t side) { return side >= 1 && side <= kMaxLatticeSide; };
    if (positions.sampler == PositionSampler::kPixels) {
        if (!is_side(positions.width) || !is_side(positions.height))
            return refuse(
                fmt::format("a lattice of {} x {} pixels, not 1 to {}", positions.width, positions.height, kMaxLatticeSide));
    } else if (positions.width != 0 || positions.height != 0) {
        return refuse("a lattice of pixels without its sampler");
    }
    if (positions.sampler == PositionSampler::kNone && (positions.shift_u != 0 || positions.shift_v != 0)) {
        return refuse("a shift of positions without a sampler");
    }
    if (extra.size() > kMaxExtraColumns) return refuse(fmt::format("{} extra columns, at most {}", extra.size(), kMaxExtraColumns));
    std::set<std::string> names;
    for (const ExtraColumnSpec& column : extra) {
        if (column.name.empty() || column.name.size() > kMaxNameSize) return refuse("an extra column's name is empty or too long");
        if (width(column.type) == 0) return refuse(fmt::format("column {} has an unknown type", column.name));
        if (!names.insert(column.name).second) return refuse(fmt::format("two columns are named {}", column.name));
    }
    return {};
}

std::string_view differing_field(const Job& a, const Job& b) {
    if (a.aspect_width != b.aspect_width || a.aspect_height != b.aspect_height) return "the film aspect";
    if (a.kind != b.kind) return "the record kind";
    if (a.batch != b.batch) return "the number of wavelengths";
    if (!(a.density == b.density)) return "the wavelength density";
    if (std::bit_cast<std::uint64_t>(a.light_unit_cd_m2) != std::bit_cast<std::uint64_t>(b.light_unit_cd_m2))
        return "the light unit";
    if (a.light_paths_per_sample != b.light_paths_per_sample) return "the number of light paths per sample";
    if (a.run_samples != b.run_samples) return "the number of samples per run";
    if (a.run_bytes != b.run_bytes) return "the cap of a run's bytes";
    if (a.precision != b.precision) return "the precision of values";
    if (a.positions.sampler != b.positions.sampler) return "the position sampler";
    if (a.positions.width != b.positions.width || a.positions.height != b.positions.height)
        return "the picture size that samples are spread over";
    if (!(a.positions == b.positions)) return "the seed of the positions";
    if (a.extra != b.extra) return "the list of extra columns";
    return "";
}

Status same_job(const Job& a, const Job& b) {
    const std::string_view field = differing_field(a, b);
    if (a.id == b.id && field.empty()) return {};
    std::string what = "another job: ";
    if (a.id != b.id) what += fmt::format("its id is {}, not {}{}", to_hex(a.id), to_hex(b.id), field.empty() ? "" : ", and ");
    if (!field.empty()) what += fmt::format("{} differs", field);
    return Error{ErrorCode::kMismatch, std::move(what)};
}

std::uint32_t default_run_samples(std::uint64_t bytes_per_sample) {
    const std::uint64_t samples = kRunTargetBytes / std::max<std::uint64_t>(bytes_per_sample, 1);
    if (samples <= kMinRunSamples) return kMinRunSamples;
    if (samples >= kMaxRunSamples) return kMaxRunSamples;
    const std::uint64_t below = std::bit_floor(samples);
    return static_cast<std::uint32_t>(samples * samples > 2 * below * below ? 2 * below : below);  // the nearer one by ratio
}

}  // namespace latent::sampledb
