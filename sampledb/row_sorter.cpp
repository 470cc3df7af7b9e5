#include "sampledb/row_sorter.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

#include "sampledb/z_order.h"

namespace latent::sampledb {

namespace {

constexpr int kBucketBits = 8;      // of z: a bucket of a large run fits the second-level cache
constexpr std::size_t kAhead = 16;  // rows on their way from memory while one is copied
// Rows left free between buckets. A low-discrepancy sequence makes buckets of equal size, whose ends would otherwise fall on the
// same sets of the cache.
constexpr std::size_t kSkew = 10;
constexpr std::size_t kBlock = 256;  // rows that are loaded together
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

// A block of rows, one column after another: large columns begin at the same place of a memory page, and eight of them read in
// step would push each other out of the cache.
template <class RowAt>
void RowSorter::load_rows(const RowAt& row_at, std::span<const std::uint32_t> first_pair, std::span<Row> rows) const {
    const Records& r = *records_;
    const auto load = [&](const auto& column, auto at) {
        for (std::size_t i = 0; i < rows.size(); ++i) std::invoke(at, rows[i]) = column[row_at(i)];
    };
    load(r.sample, &Row::sample);
    load(r.u, &Row::u);
    load(r.v, &Row::v);
    load(r.share, &Row::share);
    if (job_->kind == RecordKind::kXyz) {
        load(r.x, [](Row& row) -> float& { return row.xyz.x; });
        load(r.y, [](Row& row) -> float& { return row.xyz.y; });
        load(r.z, [](Row& row) -> float& { return row.xyz.z; });
        return;
    }
    load(r.pairs, [](Row& row) -> std::uint16_t& { return row.spectral.pairs; });
    load(first_pair, [](Row& row) -> std::uint32_t& { return row.spectral.first_pair; });
    if (job_->density.empty()) return;
    load(r.xi, [](Row& row) -> std::uint32_t& { return row.spectral.xi; });
    load(r.index, [](Row& row) -> std::uint16_t& { return row.spectral.index; });
}

// Two steps, so that neither jumps about in memory: rows go to buckets by class and the leading bits of z, which fills a few
// hundred streams; then each bucket is sorted where it lies.
void RowSorter::partition(const std::vector<std::uint32_t>& by_sample) {
    const Records& r = *records_;
    const std::size_t n = r.size();
    std::vector<std::uint32_t> first_pair(r.pairs.size());
    std::exclusive_scan(r.pairs.begin(), r.pairs.end(), first_pair.begin(), 0u);
    const auto bucket_of = [record_class = r.record_class.data()](std::size_t row, std::uint32_t z) {
        return static_cast<std::size_t>(record_class[row]) * kBuckets + (z >> (32 - kBucketBits));
    };

    std::array<std::uint32_t, 2 * kBuckets + 1> begin{};
    for (std::size_t row = 0; row < n; ++row) ++begin[bucket_of(row, z_prefix(r.u[row], r.v[row])) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    camera_count_ = begin[kBuckets];

    const std::size_t slots = n + 2 * kBuckets * kSkew;
    if (rows_.size() < slots) rows_.resize(slots), keys_.resize(slots), z_.resize(n), order_.resize(n);
    sources_.resize(job_->extra.empty() ? 0 : slots);
    std::array<std::uint32_t, 2 * kBuckets + 1> next = begin;
    for (std::size_t b = 0; b < next.size(); ++b) next[b] += static_cast<std::uint32_t>(b * kSkew);
    std::array<Row, kBlock> block;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t count = std::min(kBlock, n - first);
        const auto row_at = [&](std::size_t i) { return by_sample.empty() ? first + i : by_sample[first + i]; };
        load_rows(row_at, first_pair, std::span(block).first(count));
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t z = z_prefix(block[i].u, block[i].v);
            const std::uint32_t to = next[bucket_of(row_at(i), z)]++;
            rows_[to] = block[i];
            keys_[to] = std::uint64_t{z} << 32 | to;
            if (!sources_.empty()) sources_[to] = static_cast<std::uint32_t>(row_at(i));
        }
    }
    for (std::size_t b = 0; b < 2 * kBuckets; ++b) sort_bucket(begin[b], begin[b + 1], begin[b] + b * kSkew);
}

// Stable, by the bits of z that the bucket leaves open: three passes of 8 bits, the least significant first.
void RowSorter::sort_bucket(std::size_t begin, std::size_t end, std::size_t slot) {
    constexpr int kPasses = (32 - kBucketBits) / 8;
    const std::size_t n = end - begin;
    if (sorted_.size() < n) sorted_.resize(n);
    std::array<std::array<std::uint32_t, 256>, kPasses> next{};
    std::span<std::uint64_t> from(keys_.data() + slot, n), to(sorted_.data(), n);
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
