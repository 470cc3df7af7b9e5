#include "sampledb/row_sorter.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "sampledb/z_order.h"

namespace latent::sampledb {

namespace {

constexpr int kBucketBits = 8;      // of z: a bucket of a large run fits the second-level cache
constexpr std::size_t kAhead = 16;  // rows on their way from memory while one is copied
constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;

}  // namespace

std::vector<std::uint32_t> order_by_sample(const Records& records) {
    if (std::ranges::is_sorted(records.sample)) return {};
    std::vector<std::uint32_t> rows(records.size());
    std::iota(rows.begin(), rows.end(), 0u);
    std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return records.sample[row]; });
    return rows;
}

void RowSorter::sort(const Job& job, const Records& records) {
    job_ = &job;
    records_ = &records;
    partition(order_by_sample(records));
}

void RowSorter::fill(Row& row, std::size_t from, std::uint32_t first_pair) const {
    const Records& r = *records_;
    row.sample = r.sample[from];
    row.u = r.u[from];
    row.v = r.v[from];
    row.share = r.share[from];
    if (job_->kind == RecordKind::kXyz) {
        row.xyz = {r.x[from], r.y[from], r.z[from]};
    } else {
        const bool density = !job_->density.empty();
        row.spectral = {density ? r.xi[from] : 0, r.pairs[from], density ? r.index[from] : kNoIndex, first_pair};
    }
}

// Two steps, so that neither jumps about in memory: rows go to buckets by class and the leading bits of z, which fills a few
// hundred streams; then each bucket is sorted where it lies.
void RowSorter::partition(const std::vector<std::uint32_t>& by_sample) {
    const Records& r = *records_;
    const std::size_t n = r.size();
    std::vector<std::uint32_t> first_pair(by_sample.empty() ? 0 : r.pairs.size());
    std::exclusive_scan(r.pairs.begin(), r.pairs.begin() + static_cast<std::ptrdiff_t>(first_pair.size()), first_pair.begin(), 0u);
    const auto bucket_of = [&](std::size_t row, std::uint32_t z) {
        return static_cast<std::size_t>(r.record_class[row]) * kBuckets + (z >> (32 - kBucketBits));
    };

    std::array<std::uint32_t, 2 * kBuckets + 1> begin{};
    for (std::size_t row = 0; row < n; ++row) ++begin[bucket_of(row, z_prefix(r.u[row], r.v[row])) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    camera_count_ = begin[kBuckets];

    if (rows_.size() < n) rows_.resize(n), keys_.resize(n), z_.resize(n), order_.resize(n);
    sources_.resize(job_->extra.empty() ? 0 : n);
    std::array<std::uint32_t, 2 * kBuckets + 1> next = begin;
    std::uint32_t pairs = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t row = by_sample.empty() ? i : by_sample[i];
        const std::uint32_t z = z_prefix(r.u[row], r.v[row]);
        const std::uint32_t to = next[bucket_of(row, z)]++;
        fill(rows_[to], row, first_pair.empty() ? pairs : first_pair[row]);
        keys_[to] = std::uint64_t{z} << 32 | to;
        if (!r.pairs.empty()) pairs += r.pairs[row];
        if (!sources_.empty()) sources_[to] = static_cast<std::uint32_t>(row);
    }
    for (std::size_t b = 0; b < 2 * kBuckets; ++b) sort_bucket(begin[b], begin[b + 1]);
}

// Stable, by the bits of z that the bucket leaves open: three passes of 8 bits, the least significant first.
void RowSorter::sort_bucket(std::size_t begin, std::size_t end) {
    constexpr int kPasses = (32 - kBucketBits) / 8;
    const std::size_t n = end - begin;
    if (sorted_.size() < n) sorted_.resize(n);
    std::array<std::array<std::uint32_t, 256>, kPasses> next{};
    std::span<std::uint64_t> from(keys_.data() + begin, n), to(sorted_.data(), n);
    for (const std::uint64_t key : from) {
        for (int pass = 0; pass < kPasses; ++pass) ++next[pass][key >> (32 + 8 * pass) & 0xFF];
    }
    for (int pass = 0; pass < kPasses && n > 1; ++pass) {
        std::exclusive_scan(next[pass].begin(), next[pass].end(), next[pass].begin(), 0u);
        for (const std::uint64_t key : from) to[next[pass][key >> (32 + 8 * pass) & 0xFF]++] = key;
        std::swap(from, to);
    }
    for (std::size_t i = 0; i < n; ++i) {
        z_[begin + i] = static_cast<std::uint32_t>(from[i] >> 32);
        order_[begin + i] = static_cast<std::uint32_t>(from[i]);
    }
}

std::span<const std::uint32_t> RowSorter::z(RecordClass record_class) const {
    const std::span<const std::uint32_t> all(z_.data(), records_->size());
    return record_class == RecordClass::kCamera ? all.first(camera_count_) : all.subspan(camera_count_);
}

std::span<const std::uint32_t> RowSorter::order(RecordClass record_class) const {
    const std::span<const std::uint32_t> all(order_.data(), records_->size());
    return record_class == RecordClass::kCamera ? all.first(camera_count_) : all.subspan(camera_count_);
}

void RowSorter::gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const {
    const std::span<const std::uint32_t> rows = order(record_class).subspan(begin, end - begin);
    const std::size_t n = rows.size();
    const bool xyz = job_->kind == RecordKind::kXyz;
    page.record_class = record_class;
    page.count = n;
    page.sample.resize(n), page.u.resize(n), page.v.resize(n), page.share.resize(n);
    page.x.resize(xyz ? n : 0), page.y.resize(xyz ? n : 0), page.z.resize(xyz ? n : 0);
    page.xi.resize(xyz ? 0 : n), page.pairs.resize(xyz ? 0 : n), page.index.resize(xyz ? 0 : n);
    page.power.clear(), page.lambda_nm.clear();
    page.unit_share = true;
    for (std::size_t i = 0; i < n; ++i) {
        if (i + kAhead < n) __builtin_prefetch(&rows_[rows[i + kAhead]]);
        const Row& row = rows_[rows[i]];
        page.sample[i] = row.sample;
        page.u[i] = row.u;
        page.v[i] = row.v;
        page.share[i] = row.share;
        page.unit_share &= row.share == 1;
        if (xyz) {
            page.x[i] = row.xyz.x;
            page.y[i] = row.xyz.y;
            page.z[i] = row.xyz.z;
            continue;
        }
        page.xi[i] = row.spectral.xi;
        page.pairs[i] = row.spectral.pairs;
        page.index[i] = row.spectral.index;
        const auto take = [&row](const std::vector<float>& from, std::vector<float>& to) {
            if (from.empty()) return;
            const auto first = from.begin() + row.spectral.first_pair;
            to.insert(to.end(), first, first + row.spectral.pairs);
        };
        take(records_->power, page.power);
        take(records_->lambda_nm, page.lambda_nm);
    }
    page.extra.resize(job_->extra.size());
    for (std::size_t c = 0; c < page.extra.size(); ++c) {
        const std::size_t bytes = width(job_->extra[c].type);
        const std::vector<std::byte>& from = records_->extra[c].values;
        page.extra[c].values.resize(n * bytes);
        for (std::size_t i = 0; i < n; ++i) std::copy_n(&from[sources_[rows[i]] * bytes], bytes, &page.extra[c].values[i * bytes]);
    }
}

}  // namespace latent::sampledb
