#include "sampledb/codec/row_sorter.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

#include "sampledb/data/z_order.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kBlock = 256;  // rows that are loaded together
constexpr std::size_t kAhead = 16;   // rows on their way from memory while one is copied

// The leading 8 bits of the Z prefix.
std::size_t leading_z(std::uint32_t u, std::uint32_t v) {
    static constexpr auto kSpread = [] {
        std::array<std::uint8_t, 16> spread{};
        for (std::uint32_t i = 0; i < 16; ++i) spread[i] = static_cast<std::uint8_t>(z_prefix(i << 28, 0) >> 24);
        return spread;
    }();
    return static_cast<std::size_t>(kSpread[v >> 28] << 1 | kSpread[u >> 28]);
}

}  // namespace

std::vector<std::uint32_t> order_by_sample(const Records& records) {
    if (std::ranges::is_sorted(records.sample)) return {};
    std::vector<std::uint32_t> rows(records.size());
    std::iota(rows.begin(), rows.end(), 0u);
    std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return records.sample[row]; });
    return rows;
}

void RowSorter::begin(const Job& job, std::size_t rows) {
    job_ = &job;
    buckets_ = {};
    count_ = {};
    chunks_ = 0;
    sorted_buckets_ = first_rank_ = 0;
    z_.clear(), order_.clear();
    const std::size_t chunks = rows / kChunk + buckets_.size();
    next_chunk_.reserve(chunks);
    rows_.reserve(chunks * kChunk);
    if (!job.extra.empty()) sources_.reserve(chunks * kChunk);
    power_.clear(), lambda_nm_.clear();
    extra_.resize(job.extra.size());
    for (std::vector<std::byte>& column : extra_) column.clear();
}

// A block of rows, one column after another: columns tend to begin at the same place of a memory page, and eight of them read in
// step would push each other out of the cache.
void RowSorter::load_rows(const Records& piece, std::span<const std::uint32_t> by_sample, std::size_t first,
                          std::span<Row> rows) const {
    const auto load = [&](const auto& column, auto at) {
        if (by_sample.empty()) {
            for (std::size_t i = 0; i < rows.size(); ++i) std::invoke(at, rows[i]) = column[first + i];
        } else {
            for (std::size_t i = 0; i < rows.size(); ++i) std::invoke(at, rows[i]) = column[by_sample[first + i]];
        }
    };
    load(piece.sample, &Row::sample);
    load(piece.u, &Row::u);
    load(piece.v, &Row::v);
    load(piece.share, &Row::share);
    if (job_->kind == RecordKind::kXyz) {
        load(piece.x, [](Row& row) -> float& { return row.xyz.x; });
        load(piece.y, [](Row& row) -> float& { return row.xyz.y; });
        load(piece.z, [](Row& row) -> float& { return row.xyz.z; });
        return;
    }
    load(piece.pairs, [](Row& row) -> std::uint16_t& { return row.spectral.pairs; });
    load(first_pair_, [](Row& row) -> std::uint32_t& { return row.spectral.first_pair; });
    if (job_->density.empty()) return;
    load(piece.xi, [](Row& row) -> std::uint32_t& { return row.spectral.xi; });
    load(piece.index, [](Row& row) -> std::uint16_t& { return row.spectral.index; });
}

void RowSorter::add(const Records& piece) {
    const std::vector<std::uint32_t> by_sample = order_by_sample(piece);
    const std::uint32_t rows_before = static_cast<std::uint32_t>(count_[0] + count_[1]);
    first_pair_.resize(piece.pairs.size());
    std::exclusive_scan(piece.pairs.begin(), piece.pairs.end(), first_pair_.begin(), static_cast<std::uint32_t>(power_.size()));
    power_.insert(power_.end(), piece.power.begin(), piece.power.end());
    lambda_nm_.insert(lambda_nm_.end(), piece.lambda_nm.begin(), piece.lambda_nm.end());
    for (std::size_t c = 0; c < extra_.size(); ++c) {
        extra_[c].insert(extra_[c].end(), piece.extra[c].values.begin(), piece.extra[c].values.end());
    }

    std::array<Row, kBlock> block;
    for (std::size_t first = 0; first < piece.size(); first += kBlock) {
        const std::size_t n = std::min(kBlock, piece.size() - first);
        load_rows(piece, by_sample, first, std::span(block).first(n));
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t row = by_sample.empty() ? first + i : by_sample[first + i];
            const std::size_t record_class = static_cast<std::size_t>(piece.record_class[row]);
            const std::uint32_t place = place_for(record_class * kBuckets + leading_z(block[i].u, block[i].v));
            __builtin_prefetch(&rows_[place] + 2, 1);  // the next line of this bucket
            rows_[place] = block[i];
            if (!extra_.empty()) sources_[place] = rows_before + static_cast<std::uint32_t>(row);
            ++count_[record_class];
        }
    }
}

std::uint32_t RowSorter::place_for(std::size_t bucket_number) {
    Bucket& bucket = buckets_[bucket_number];
    if (bucket.next == bucket.end) {
        (bucket.count == 0 ? bucket.first_chunk : next_chunk_[bucket.last_chunk]) = chunks_;
        bucket.last_chunk = chunks_;
        bucket.next = chunks_ * kChunk;
        bucket.end = bucket.next + kChunk;
        ++chunks_;
    }
    ++bucket.count;
    return bucket.next++;
}

// Stable, by the bits of z that the bucket leaves open: three passes of 8 bits, the least significant first.
void RowSorter::sort_bucket(const Bucket& bucket) {
    constexpr int kPasses = (32 - kBucketBits) / 8;
    const std::size_t n = bucket.count;
    if (keys_.size() < n) keys_.resize(n), sorted_.resize(n);
    std::span<std::uint64_t> from(keys_.data(), n), to(sorted_.data(), n);  // Z prefix above, place in rows_ below
    std::array<std::array<std::uint32_t, 256>, kPasses> next{};
    std::uint32_t chunk = bucket.first_chunk;
    for (std::size_t first = 0; first < n; first += kChunk) {
        const std::size_t end = std::min<std::size_t>(n, first + kChunk);
        const std::uint32_t next_chunk = end < n ? next_chunk_[chunk] : chunk;
        std::uint32_t place = chunk * kChunk;
        for (std::size_t i = first; i < end; ++i, ++place) {
            __builtin_prefetch(&rows_[next_chunk * kChunk + (i - first)]);
            const std::uint32_t z = z_prefix(rows_[place].u, rows_[place].v);
            from[i] = std::uint64_t{z} << 32 | place;
            for (int pass = 0; pass < kPasses; ++pass) ++next[pass][z >> 8 * pass & 0xFF];
        }
        chunk = next_chunk;
    }
    for (int pass = 0; pass < kPasses && n > 1; ++pass) {
        std::exclusive_scan(next[pass].begin(), next[pass].end(), next[pass].begin(), 0u);
        for (const std::uint64_t key : from) to[next[pass][key >> (32 + 8 * pass) & 0xFF]++] = key;
        std::swap(from, to);
    }
    for (const std::uint64_t key : from) {
        z_.push_back(static_cast<std::uint32_t>(key >> 32));
        order_.push_back(static_cast<std::uint32_t>(key));
    }
}

std::span<const std::uint32_t> RowSorter::z(RecordClass record_class, std::size_t begin, std::size_t most) {
    const std::size_t class_begin = first_row(record_class), class_end = class_begin + count(record_class);
    begin += class_begin;
    if (const std::size_t done = begin - first_rank_; done > z_.size() / 2) {
        z_.erase(z_.begin(), z_.begin() + static_cast<std::ptrdiff_t>(done));
        order_.erase(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(done));
        first_rank_ = begin;
    }
    while (first_rank_ + z_.size() < std::min(begin + most, class_end)) sort_bucket(buckets_[sorted_buckets_++]);
    const std::size_t end = std::min(first_rank_ + z_.size(), class_end);
    return std::span(z_).subspan(begin - first_rank_, end - begin);
}

void RowSorter::gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const {
    const std::span<const std::uint32_t> rows(order_.data() + (first_row(record_class) + begin - first_rank_), end - begin);
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
        take(power_, page.power);
        take(lambda_nm_, page.lambda_nm);
    }
    page.extra.resize(job_->extra.size());
    for (std::size_t c = 0; c < page.extra.size(); ++c) {
        const std::size_t bytes = width(job_->extra[c].type);
        const std::vector<std::byte>& from = extra_[c];
        page.extra[c].values.resize(n * bytes);
        for (std::size_t i = 0; i < n; ++i) std::copy_n(&from[sources_[rows[i]] * bytes], bytes, &page.extra[c].values[i * bytes]);
    }
}

}  // namespace latent::sampledb
