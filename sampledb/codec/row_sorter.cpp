#include "sampledb/codec/row_sorter.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "sampledb/codec/xyz_rows.h"
#include "sampledb/data/z_order.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kBatch = 256;     // rows that are loaded together
constexpr std::size_t kRowsAhead = 16;  // rows on their way from memory while one is copied

// The leading 8 bits of the Z prefix.
std::size_t leading_z(std::uint32_t u, std::uint32_t v) {
    static constexpr auto kSpread = [] {
        std::array<std::uint8_t, 16> spread{};
        for (std::uint32_t i = 0; i < 16; ++i) spread[i] = static_cast<std::uint8_t>(z_prefix(i << 28, 0) >> 24);
        return spread;
    }();
    return static_cast<std::size_t>(kSpread[v >> 28] << 1 | kSpread[u >> 28]);
}

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), from.begin(), from.end());
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
    came_.extra.resize(job.extra.size());
    for (std::size_t c = 0; c < job.extra.size(); ++c) came_.extra[c].type = job.extra[c].type;
    for_each_values([](Shape, auto& values) { values.clear(); }, came_);
}

template <class F>
void RowSorter::with_layout(F&& f) const {
    if (job_->kind == RecordKind::kXyz) {
        f.template operator()<RecordKind::kXyz, false>();
    } else if (job_->density.empty()) {
        f.template operator()<RecordKind::kSpectral, false>();
    } else {
        f.template operator()<RecordKind::kSpectral, true>();
    }
}

// A block of rows, one column after another: columns tend to begin at the same place of a memory page, and eight of them read in
// step would push each other out of the cache.
template <RecordKind kind, bool density>
void RowSorter::load_rows(const Records& piece, std::span<const std::uint32_t> by_sample, std::size_t first,
                          std::span<Row> rows) const {
    if constexpr (kind == RecordKind::kXyz) {
        if (by_sample.empty()) return load_xyz_rows(piece, first, rows);
    }
    const auto load = [&](const auto& column, std::size_t offset) {
        if (by_sample.empty()) {
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i].set(offset, column[first + i]);
        } else {
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i].set(offset, column[by_sample[first + i]]);
        }
    };
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if constexpr (spec.rows == Rows::kRecords && is_present(spec.presence, kind, density, RecordClass::kCamera))
            load(piece.*spec.values, row_offset(kind, spec.number));
    });
    if constexpr (kind == RecordKind::kSpectral) load(first_pair_, Row::kFirstPair);
}

void RowSorter::add(const Records& piece) {
    const std::vector<std::uint32_t> by_sample = order_by_sample(piece);
    const std::uint32_t rows_before = static_cast<std::uint32_t>(count_[0] + count_[1]);
    first_pair_.resize(piece.pairs.size());
    std::exclusive_scan(piece.pairs.begin(), piece.pairs.end(), first_pair_.begin(),
                        static_cast<std::uint32_t>(came_.power.size()));
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if constexpr (spec.rows == Rows::kPairs) append(piece.*spec.values, came_.*spec.values);
    });
    for (std::size_t c = 0; c < came_.extra.size(); ++c) append(piece.extra[c].values, came_.extra[c].values);

    std::array<Row, kBatch> block;
    for (std::size_t first = 0; first < piece.size(); first += kBatch) {
        const std::size_t n = std::min(kBatch, piece.size() - first);
        with_layout(
            [&]<RecordKind kind, bool density>() { load_rows<kind, density>(piece, by_sample, first, std::span(block).first(n)); });
        std::size_t lights = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t row = by_sample.empty() ? first + i : by_sample[first + i];
            const std::size_t record_class = static_cast<std::size_t>(piece.record_class[row]);
            Bucket& bucket = buckets_[record_class * kBuckets + leading_z(block[i].u(), block[i].v())];
            if (bucket.next == bucket.end) add_chunk(bucket);
            const std::uint32_t place = bucket.next++;
            __builtin_prefetch(&rows_[place] + 2, 1);  // the next line of this bucket
            rows_[place] = block[i];
            if (!came_.extra.empty()) sources_[place] = rows_before + static_cast<std::uint32_t>(row);
            lights += record_class;
        }
        count_[0] += n - lights;
        count_[1] += lights;
    }
}

void RowSorter::add_chunk(Bucket& bucket) {
    (bucket.chunks++ == 0 ? bucket.first_chunk : next_chunk_[bucket.last_chunk]) = chunks_;
    bucket.last_chunk = chunks_;
    bucket.next = chunks_ * kChunk;
    bucket.end = bucket.next + kChunk;
    ++chunks_;
}

// Stable, by the bits of z that the bucket leaves open: three passes of 8 bits, the least significant first.
void RowSorter::sort_bucket(const Bucket& bucket) {
    constexpr int kPasses = (32 - kBucketBits) / 8;
    const std::size_t n = bucket.count();
    if (n == 0) return;
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
            const std::uint32_t z = z_prefix(rows_[place].u(), rows_[place].v());
            from[i] = std::uint64_t{z} << 32 | place;
            for (int pass = 0; pass < kPasses; ++pass) ++next[pass][z >> 8 * pass & 0xFF];
        }
        chunk = next_chunk;
    }
    for (auto& digits : next) std::exclusive_scan(digits.begin(), digits.end(), digits.begin(), 0u);
    for (int pass = 0; pass + 1 < kPasses; ++pass) {
        for (const std::uint64_t key : from) to[next[pass][key >> (32 + 8 * pass) & 0xFF]++] = key;
        std::swap(from, to);
    }
    const std::size_t sorted = z_.size();
    z_.resize(sorted + n), order_.resize(sorted + n);
    for (const std::uint64_t key : from) {
        const std::size_t rank = sorted + next[kPasses - 1][key >> (32 + 8 * (kPasses - 1)) & 0xFF]++;
        z_[rank] = static_cast<std::uint32_t>(key >> 32);
        order_[rank] = static_cast<std::uint32_t>(key);
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

template <RecordKind kind, bool density>
void RowSorter::gather_rows(std::span<const std::uint32_t> places, Page& page) const {
    const std::size_t n = places.size();
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        constexpr bool present = is_present(spec.presence, kind, density, RecordClass::kCamera);
        (page.*spec.values).resize(present && spec.rows == Rows::kRecords ? n : 0);
    });
    if constexpr (kind == RecordKind::kXyz) {
        page.unit_share = gather_xyz_rows(rows_.data(), places, page);
        return;
    }
    bool unit_share = true;
    for (std::size_t i = 0; i < n; ++i) {
        if (i + kRowsAhead < n) __builtin_prefetch(&rows_[places[i + kRowsAhead]]);
        const Row& row = rows_[places[i]];
        for_each_column([&](auto column) {
            constexpr auto spec = column.spec;
            if constexpr (!is_present(spec.presence, kind, density, RecordClass::kCamera)) {
                return;
            } else if constexpr (spec.rows == Rows::kRecords) {
                constexpr std::size_t offset = row_offset(kind, spec.number);
                (page.*spec.values)[i] = row.template get<typename decltype(column)::Value>(offset);
            } else {
                const auto first = (came_.*spec.values).begin() + row.template get<std::uint32_t>(Row::kFirstPair);
                (page.*spec.values).insert((page.*spec.values).end(), first, first + page.pairs[i]);
            }
        });
        unit_share &= page.share[i] == 1;
    }
    page.unit_share = unit_share;
}

void RowSorter::gather(RecordClass record_class, std::size_t begin, std::size_t end, Page& page) const {
    const std::span<const std::uint32_t> places(order_.data() + (first_row(record_class) + begin - first_rank_), end - begin);
    page.record_class = record_class;
    page.count = places.size();
    with_layout([&]<RecordKind kind, bool density>() { gather_rows<kind, density>(places, page); });
    page.extra.resize(came_.extra.size());
    for (std::size_t c = 0; c < page.extra.size(); ++c) {
        const ExtraColumn& from = came_.extra[c];
        const std::size_t bytes = width(from.type);
        page.extra[c].values.resize(places.size() * bytes);
        for (std::size_t i = 0; i < places.size(); ++i)
            copy_row(from.values.data(), sources_[places[i]], bytes, &page.extra[c].values[i * bytes]);
    }
}

}  // namespace latent::sampledb
