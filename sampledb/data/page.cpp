#include "sampledb/data/page.h"

#include <algorithm>

#include "sampledb/data/limits.h"

namespace latent::sampledb {

std::size_t max_page_records(const Job& job) {
    constexpr std::size_t kMin = 64;
    static_assert(kMin * kMaxPairs <= kMaxPairsPerPage);
    static_assert(kMin * kMaxExtraColumns * sizeof(std::uint64_t) <= kMaxExtraPerPage);
    std::size_t extra = 0, most = kMaxRecordsPerPage;
    for (const ExtraColumnSpec& column : job.extra) extra += width(column.type);
    if (extra > 0) most = std::min<std::size_t>(most, kMaxExtraPerPage / extra);
    if (job.kind == RecordKind::kSpectral) most = std::min(most, std::max<std::size_t>(kMin, kMaxPairsPerPage / job.batch));
    return most;
}

std::vector<ExtraColumn> extra_columns(const Job& job) {
    std::vector<ExtraColumn> columns;
    for (const ExtraColumnSpec& column : job.extra) columns.push_back({column.name, column.type, {}});
    return columns;
}

void wavelengths_of(const WavelengthDensity& density, std::size_t k, const Page& page, std::size_t row,
                    std::span<float> lambda_nm) {
    if (density.empty()) {
        std::copy_n(page.lambda_nm.begin() + page.first_pair[row], lambda_nm.size(), lambda_nm.begin());
    } else if (lambda_nm.size() == k) {
        density.batch(page.xi[row], lambda_nm);
    } else if (lambda_nm.size() == 1) {
        lambda_nm[0] = density.wavelength(page.xi[row], page.index[row], static_cast<std::uint32_t>(k));
    }
}

std::uint64_t decoded_page_size(const Job& job, RecordClass record_class, std::uint64_t records, std::uint64_t pairs) {
    std::uint64_t row = 0, pair = 0;
    for_each_column([&](auto column) {
        if (!has_column(job, record_class, column.spec.presence)) return;
        (column.spec.rows == Rows::kPairs ? pair : row) += sizeof(typename decltype(column)::Value);
    });
    for (const ExtraColumnSpec& column : job.extra) row += width(column.type);
    return records * row + pairs * pair;
}

}  // namespace latent::sampledb
