#include "sampledb/row_sorter.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

#include "sampledb/z_order.h"

namespace latent::sampledb {

namespace {

// Rows left free between buckets. A low-discrepancy sequence makes buckets of equal size, whose ends would otherwise fall on the
// same sets of the cache.
constexpr std::size_t kSkew = 10;
constexpr std::size_t kBlock = 256;  // rows that are loaded together
constexpr std::size_t kAhead = 16;   // rows on their way from memory while one is copied

}  // namespace

std::vector<std::uint32_t> order_by_sample(const Records& records) {
    if (std::ranges::is_sorted(records.sample)) return {};
    std::vector<std::uint32_t> rows(records.size());
    std::iota(rows.begin(), rows.end(), 0u);
    std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return records.sample[row]; });
    return rows;
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
// hundred streams; each bucket is sorted where it lies, just before its pages are made.
void RowSorter::sort(const Job& job, const Records& records) {
    job_ = &job;
    records_ = &records;
    sorted_buckets_ = 0;
    const std::size_t n = records.size();
    const std::vector<std::uint32_t> by_sample = order_by_sample(records);
    std::vector<std::uint32_t> first_pair(records.pairs.size());
    std::exclusive_scan(records.pairs.begin(), records.pairs.end(), first_pair.begin(), 0u);
    const auto bucket_of = [&](std::size_t row) {
        const std::uint32_t z = z_prefix(records.u[row], records.v[row]);
        return static_cast<std::size_t>(records.record_class[row]) * kBuckets + (z >> (32 - kBucketBits));
    };

    begin_ = {};
    for (std::size_t row = 0; row < n; ++row) ++begin_[bucket_of(row) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    Bounds next;
    for (std::size_t bucket = 0; bucket < next.size(); ++bucket) next[bucket] = static_cast<std::uint32_t>(slot(bucket));
    const std::size_t slots = next.back();
    if (rows_.size() < slots) rows_.resize(slots), z_.resize(slots), order_.resize(slots);
    sources_.resize(job.extra.empty() ? 0 : slots);

    std::array<Row, kBlock> block;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t count = std::min(kBlock, n - first);
        const auto row_at = [&](std::size_t i) { return by_sample.empty() ? first + i : by_sample[first + i]; };
        load_rows(row_at, first_pair, std::span(block).first(count));
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t to = next[bucket_of(row_at(i))]++;
            rows_[to] = block[i];
            if (!sources_.empty()) sources_[to] = static_cast<std::uint32_t>(row_at(i));
        }
    }
}

std::size_t RowSorter::slot(std::size_t bucket) const { return begin_[bucket] + bucket * kSkew; }

// Stable, by the bits of z that the bucket leaves open: three passes of 8 bits, the least significant first.
void RowSorter::sort_bucket(std::size_t bucket) {
    constexpr int kPasses = (32 - kBucketBits) / 8;
    const std::size_t n = begin_[bucket + 1] - begin_[bucket];
    if (keys_.size() < n) keys_.resize(n), sorted_.resize(n);
    std::span<std::uint64_t> from(keys_.data(), n), to(sorted_.data(), n);  // Z prefix above, place in rows_ below
    std::array<std::array<std::uint32_t, 256>, kPasses> next{};
    for (std::size_t i = 0; i < n; ++i) {
        const Row& row = rows_[slot(bucket) + i];
        const std::uint32_t z = z_prefix(row.u, row.v);
        from[i] = std::uint64_t{z} << 32 | (slot(bucket) + i);
        for (int pass = 0; pass < kPasses; ++pass) ++next[pass][z >> 8 * pass & 0xFF];
    }
    for (int pass = 0; pass < kPasses && n > 1; ++pass) {
        std::exclusive_scan(next[pass].begin(), next[pass].end(), next[pass].begin(), 0u);
        for (const std::uint64_t key : from) to[next[pass][key >> (32 + 8 * pass) & 0xFF]++] = key;
        std::swap(from, to);
    }
    for (std::size_t i = 0; i < n; ++i) {
        z_[begin_[bucket] + i] = static_cast<std::uint32_t>(from[i] >> 32);
        order_[begin_[bucket] + i] = static_cast<std::uint32_t>(from[i]);
    }
}

std::size_t RowSorter::first_row(RecordClass record_class) const {
    return record_class == RecordClass::kCamera ? 0 : begin_[kBuckets];
}

std::size_t RowSorter::count(RecordClass record_class) const {
    return (record_class == RecordClass::kCamera ? begin_[kBuckets] : begin_.back()) - first_row(record_class);
}

std::span<const std::uint32_t> RowSorter::z(RecordClass record_class, std::size_t most) {
    const std::size_t first = first_row(record_class);
    const std::size_t wanted = first + std::min(most, count(record_class));
    while (begin_[sorted_buckets_] < wanted) sort_bucket(sorted_buckets_++);
    const std::size_t sorted = std::min<std::size_t>(begin_[sorted_buckets_], first + count(record_class));
    return {z_.data() + first, sorted - first};
}

void RowSorter::gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const {
    const std::span<const std::uint32_t> rows(order_.data() + first_row(record_class) + begin, end - begin);
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
