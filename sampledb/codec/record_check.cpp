#include "sampledb/codec/record_check.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <numeric>

#include "sampledb/data/page.h"

namespace latent::sampledb {

namespace {

// Whether all rows have a class and a share of the job and lie in the only interval that the run covers, as most often; found
// without a branch for each.
bool all_fit_at_once(const Job& job, const Coverage& coverage, const Records& r) {
    if (coverage.ranges().size() != 1) return false;
    const SampleRange range = coverage.ranges().front();
    std::uint8_t outside = 0, classes = 0;
    std::uint32_t light_share = 0;
    for (const std::uint64_t sample : r.sample) outside |= static_cast<std::uint8_t>(sample - range.first >= range.size());
    for (std::size_t i = 0; i < r.size(); ++i) {
        const auto record_class = static_cast<std::uint8_t>(r.record_class[i]);
        classes |= record_class;
        light_share |= (0u - record_class) & (std::bit_cast<std::uint32_t>(r.share[i]) << 1);  // without its sign
    }
    return outside == 0 && classes <= (job.light_paths_per_sample > 0 ? 1 : 0) && light_share == 0;
}

}  // namespace

Status check_records(const Job& job, const Coverage& coverage, const Records& r) {
    const std::size_t n = r.size();
    const auto refuse = [&](std::size_t row, const char* why) {
        return Error{ErrorCode::kOutOfRange, fmt::format("sample {}: {}", r.sample[row], why)};
    };
    const bool density = !job.density.empty();
    const std::uint64_t pair_sum = std::accumulate(r.pairs.begin(), r.pairs.end(), std::uint64_t{0});
    bool columns_fit = r.record_class.size() == n && r.extra.size() == job.extra.size();
    for_each_column([&](auto column) {
        const bool present = has_column(job, RecordClass::kCamera, column.spec.presence);
        const std::size_t rows = column.spec.rows == Rows::kPairs ? pair_sum : n;
        columns_fit &= (r.*column.spec.values).size() == (present ? rows : 0);
    });
    for (std::size_t i = 0; columns_fit && i < r.extra.size(); ++i)
        columns_fit = r.extra[i].values.size() == n * width(job.extra[i].type);
    if (!columns_fit) return Error{ErrorCode::kOutOfRange, "records without all columns of the job"};

    const auto refused = [&](std::size_t i) -> const char* {
        if (r.record_class[i] > RecordClass::kLight) return "a record of unknown class";
        if (!coverage.contains(r.sample[i])) return "outside the run's coverage";
        if (r.record_class[i] == RecordClass::kCamera) return nullptr;
        if (r.share[i] != 0) return "a light record with a share";
        return job.light_paths_per_sample == 0 ? "a light record in a job that has no light paths" : nullptr;
    };
    if (!all_fit_at_once(job, coverage, r)) {
        for (std::size_t i = 0; i < n; ++i) {
            if (const char* const why = refused(i)) return refuse(i, why);
        }
    }
    for (std::size_t i = 0; i < r.pairs.size(); ++i) {
        if (r.pairs[i] > job.batch) return refuse(i, "more pairs than wavelengths per sample");
        if (!density) continue;
        if (r.pairs[i] > 1 && r.pairs[i] != job.batch) return refuse(i, "neither one wavelength nor the whole batch");
        const bool kept_alone = r.pairs[i] == 1 && job.batch > 1;
        if (kept_alone ? r.index[i] >= job.batch : r.index[i] != kNoIndex)
            return refuse(i, "an index that contradicts the number of pairs");
    }
    return {};
}

}  // namespace latent::sampledb
