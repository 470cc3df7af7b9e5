#include "sampledb/run_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <numeric>

#include "sampledb/page_codec.h"
#include "sampledb/z_order.h"

namespace latent::sampledb {

namespace {

// A row and its place on the curve, sorted as one number: Z prefix above, row below.
using Key = std::uint64_t;
std::uint32_t z_of(Key key) { return static_cast<std::uint32_t>(key >> 32); }
std::uint32_t row_of(Key key) { return static_cast<std::uint32_t>(key); }

// Stable sort by Z prefix: three passes of 11 bits, least significant first.
void radix_sort(std::vector<Key>& keys) {
    constexpr int kBits = 11, kPasses = 3;
    constexpr std::uint64_t kMask = (1u << kBits) - 1;
    std::array<std::array<std::uint32_t, kMask + 1>, kPasses> count{};
    for (const Key key : keys) {
        for (int pass = 0; pass < kPasses; ++pass) ++count[pass][key >> (32 + pass * kBits) & kMask];
    }
    std::vector<Key> sorted(keys.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        std::exclusive_scan(count[pass].begin(), count[pass].end(), count[pass].begin(), 0u);
        for (const Key key : keys) sorted[count[pass][key >> (32 + pass * kBits) & kMask]++] = key;
        keys.swap(sorted);
    }
}

// The first row, if any, that does not fit the job or the coverage.
Status check_records(const Job& job, const Coverage& coverage, const Records& r) {
    const std::size_t n = r.size();
    const auto refuse = [&](std::size_t row, const char* why) {
        return Error{ErrorCode::kOutOfRange, fmt::format("sample {}: {}", r.sample[row], why)};
    };
    const bool xyz = job.kind == RecordKind::kXyz;
    const bool density = !job.density.empty();
    const std::uint64_t pair_sum = std::accumulate(r.pairs.begin(), r.pairs.end(), std::uint64_t{0});
    bool columns_fit = r.record_class.size() == n && r.u.size() == n && r.v.size() == n && r.share.size() == n &&
                       r.x.size() == (xyz ? n : 0) && r.y.size() == r.x.size() && r.z.size() == r.x.size() &&
                       r.pairs.size() == (xyz ? 0 : n) && r.xi.size() == (density ? n : 0) && r.index.size() == r.xi.size() &&
                       r.power.size() == pair_sum && r.lambda_nm.size() == (xyz || density ? 0 : pair_sum) &&
                       r.extra.size() == job.extra.size();
    for (std::size_t i = 0; columns_fit && i < r.extra.size(); ++i)
        columns_fit = r.extra[i].values.size() == n * width(job.extra[i].type);
    if (!columns_fit) return Error{ErrorCode::kOutOfRange, "records without the columns that the job asks for"};
    if (n > std::uint32_t(-1)) return Error{ErrorCode::kOutOfRange, "more than 2^32 records in a run"};

    const bool one_interval = coverage.ranges().size() == 1;
    for (std::size_t i = 0; i < n; ++i) {
        const SampleRange hull = coverage.ranges().front();
        const bool covered =
            one_interval ? r.sample[i] - hull.first < hull.size() : coverage.contains(SampleRange{r.sample[i], r.sample[i] + 1});
        if (!covered) return refuse(i, "outside the run's coverage");
        if (r.record_class[i] == RecordClass::kLight && r.share[i] != 0)
            return refuse(i, "a light record with a share of the denominator");
        if (r.record_class[i] > RecordClass::kLight) return refuse(i, "a record of unknown class");
    }
    for (std::size_t i = 0; i < r.pairs.size(); ++i) {
        if (r.pairs[i] > job.batch) return refuse(i, "more pairs than the job's batch");
        if (!density) continue;
        if (r.pairs[i] > 1 && r.pairs[i] != job.batch) return refuse(i, "neither one wavelength nor the whole batch");
        const bool kept_alone = r.pairs[i] == 1 && job.batch > 1;
        if (kept_alone ? r.index[i] >= job.batch : r.index[i] != kNoIndex) return refuse(i, "an index that does not fit its pairs");
    }
    return {};
}

// Row numbers in ascending order of sample, rows of one sample as they came; empty if they are in that order already.
std::vector<std::uint32_t> order_by_sample(const Records& records) {
    if (std::ranges::is_sorted(records.sample)) return {};
    std::vector<std::uint32_t> rows(records.size());
    std::iota(rows.begin(), rows.end(), 0u);
    std::ranges::stable_sort(rows, {}, [&](std::uint32_t row) { return records.sample[row]; });
    return rows;
}

// Where each row's pairs begin in the power column.
std::vector<std::uint64_t> first_pairs(const Records& records) {
    std::vector<std::uint64_t> first(records.pairs.size());
    std::exclusive_scan(records.pairs.begin(), records.pairs.end(), first.begin(), std::uint64_t{0});
    return first;
}

// Copies rows of a run, found through sorted keys, into the columns of a page.
class RowGatherer {
 public:
    RowGatherer(const Job& job, const Records& records) : job_(job), from_(records), first_pair_(first_pairs(records)) {}

    void gather(std::span<const Key> keys, RecordClass record_class, Page& page) const {
        page.record_class = record_class;
        page.count = keys.size();
        take(from_.sample, keys, page.sample);
        take(from_.u, keys, page.u);
        take(from_.v, keys, page.v);
        take(from_.share, keys, page.share);
        page.unit_share = std::ranges::all_of(page.share, [](float c) { return c == 1; });
        take(from_.x, keys, page.x);
        take(from_.y, keys, page.y);
        take(from_.z, keys, page.z);
        take(from_.pairs, keys, page.pairs);
        take(from_.xi, keys, page.xi);
        take(from_.index, keys, page.index);
        take_pairs(from_.power, keys, page.power);
        take_pairs(from_.lambda_nm, keys, page.lambda_nm);
        page.extra.resize(job_.extra.size());
        for (std::size_t i = 0; i < job_.extra.size(); ++i)
            take_bytes(from_.extra[i].values, width(job_.extra[i].type), keys, page.extra[i].values);
    }

 private:
    template <class T>
    static void take(const std::vector<T>& from, std::span<const Key> keys, std::vector<T>& to) {
        to.resize(from.empty() ? 0 : keys.size());
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[row_of(keys[i])];
    }
    void take_pairs(const std::vector<float>& from, std::span<const Key> keys, std::vector<float>& to) const {
        to.clear();
        if (from.empty()) return;
        for (const Key key : keys) {
            const std::uint32_t row = row_of(key);
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(first_pair_[row]);
            to.insert(to.end(), first, first + from_.pairs[row]);
        }
    }
    static void take_bytes(const std::vector<std::byte>& from, std::size_t value_width, std::span<const Key> keys,
                           std::vector<std::byte>& to) {
        to.clear();
        for (const Key key : keys) {
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(row_of(key) * value_width);
            to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(value_width));
        }
    }

    const Job& job_;
    const Records& from_;
    std::vector<std::uint64_t> first_pair_;
};

// The rows of one class in canonical order.
std::vector<Key> sorted_keys(const Records& records, RecordClass record_class, const std::vector<std::uint32_t>& by_sample) {
    std::vector<Key> keys;
    keys.reserve(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        const std::uint32_t row = by_sample.empty() ? static_cast<std::uint32_t>(i) : by_sample[i];
        if (records.record_class[row] == record_class) keys.push_back(Key{z_prefix(records.u[row], records.v[row])} << 32 | row);
    }
    radix_sort(keys);
    return keys;
}

}  // namespace

std::size_t max_page_records(const Job& job) {
    constexpr std::size_t kMost = 6144, kMostPairs = 3072 * 28, kLeast = 64;
    return job.kind == RecordKind::kXyz ? kMost : std::clamp(kMostPairs / job.batch, kLeast, kMost);
}

std::size_t page_end(std::span<const std::uint32_t> z, std::size_t begin, std::size_t most) {
    // The node needs more bits than the prefix that z[begin] shares with the page before, and with the record that is one too many.
    int level = 0;
    if (begin > 0) level = std::max(level, std::countl_zero(z[begin - 1] ^ z[begin]) + 1);
    if (z.size() - begin > most) level = std::max(level, std::countl_zero(z[begin] ^ z[begin + most]) + 1);
    const std::uint32_t inside = level >= 32 ? 0 : ~std::uint32_t{0} >> level;
    const auto limit = z.begin() + static_cast<std::ptrdiff_t>(std::min(z.size(), begin + most));
    return static_cast<std::size_t>(std::upper_bound(z.begin() + static_cast<std::ptrdiff_t>(begin), limit, z[begin] | inside) -
                                    z.begin());
}

RunEncoder::RunEncoder(const Job& job, const Coverage& coverage) : job_(job) {
    assert(!coverage.empty());
    header_.job = job.id;
    index_.coverage = coverage;
}

void RunEncoder::add_page(const Page& page, Bytes& out) { index_.pages.push_back(encode_page(job_, page, out)); }

RunEncoder::Tail RunEncoder::finish() {
    Bytes index = encode_run_index(index_, header_);
    return {header_, std::move(index)};
}

Result<Bytes> encode_run(const Job& job, const Coverage& coverage, const Records& records) {
    if (coverage.empty()) return Error{ErrorCode::kOutOfRange, "a run that covers no sample"};
    if (coverage.ranges().size() > kMaxIntervalsPerRun) return Error{ErrorCode::kOutOfRange, "a run of too many intervals"};
    if (Status s = check_records(job, coverage, records); !s) return s.error();

    const std::vector<std::uint32_t> by_sample = order_by_sample(records);
    const RowGatherer rows(job, records);
    const std::size_t most = max_page_records(job);
    RunEncoder encoder(job, coverage);
    Bytes run(kRunHeaderSize);
    Page page;
    for (const RecordClass record_class : {RecordClass::kCamera, RecordClass::kLight}) {
        const std::vector<Key> keys = sorted_keys(records, record_class, by_sample);
        std::vector<std::uint32_t> z(keys.size());
        std::ranges::transform(keys, z.begin(), z_of);
        for (std::size_t begin = 0; begin < keys.size();) {
            const std::size_t end = page_end(z, begin, most);
            rows.gather(std::span(keys).subspan(begin, end - begin), record_class, page);
            encoder.add_page(page, run);
            begin = end;
        }
    }
    const RunEncoder::Tail tail = encoder.finish();
    if (tail.header.page_count > kMaxPagesPerRun) return Error{ErrorCode::kOutOfRange, "a run of too many pages"};
    run.insert(run.end(), tail.index.begin(), tail.index.end());
    std::ranges::copy(encode_run_header(tail.header), run.begin());
    return run;
}

namespace {

void append_page(const Job& job, const Page& page, Records& records) {
    const auto add = [](auto& to, const auto& from, std::size_t count) {
        to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
    };
    const std::size_t n = page.count;
    add(records.sample, page.sample, n);
    records.record_class.insert(records.record_class.end(), n, page.record_class);
    add(records.u, page.u, n);
    add(records.v, page.v, n);
    if (page.record_class == RecordClass::kLight || page.unit_share) {
        records.share.insert(records.share.end(), n, page.unit_share ? 1.0f : 0.0f);
    } else {
        add(records.share, page.share, n);
    }
    if (job.kind == RecordKind::kXyz) {
        add(records.x, page.x, n);
        add(records.y, page.y, n);
        add(records.z, page.z, n);
    } else {
        const std::size_t pairs = page.first_pair[n];
        add(records.pairs, page.pairs, n);
        add(records.power, page.power, pairs);
        if (job.density.empty()) {
            add(records.lambda_nm, page.lambda_nm, pairs);
        } else {
            add(records.xi, page.xi, n);
            add(records.index, page.index, n);
        }
    }
    for (std::size_t i = 0; i < job.extra.size(); ++i)
        add(records.extra[i].values, page.extra[i].values, n * width(job.extra[i].type));
}

}  // namespace

Result<DecodedRun> decode_run(const Job& job, ByteSpan bytes) {
    const Result<RunHeader> header = decode_run_header(bytes);
    if (!header) return header.error();
    if (header->job != job.id) return Error{ErrorCode::kMismatch, "a run of another job"};
    if (bytes.size() < header->size()) return Error{ErrorCode::kTruncated, "the run ends early"};
    const Result<RunIndex> index = decode_run_index(bytes.first(header->size()).subspan(header->index_offset()), *header, job);
    if (!index) return index.error();

    Records canonical;
    for (const ExtraColumnSpec& column : job.extra) canonical.extra.push_back({column.name, column.type, {}});
    Page page;
    for (std::size_t i = 0; i < index->pages.size(); ++i) {
        const PageInfo& info = index->pages[i];
        const ByteSpan stored = bytes.subspan(info.offset, info.stored_size);
        if (Status s = decode_page(job, info, stored, ColumnSet{}, page, true); !s) return s.error().at(fmt::format("page {}", i));
        append_page(job, page, canonical);
    }
    DecodedRun run{*header, index->coverage, {}};
    run.records.extra = canonical.extra;
    for (ExtraColumn& column : run.records.extra) column.values.clear();
    const std::vector<std::uint32_t> by_sample = order_by_sample(canonical);
    const std::vector<std::uint64_t> first_pair = first_pairs(canonical);
    if (by_sample.empty()) {
        run.records = std::move(canonical);
    } else {
        for (const std::uint32_t row : by_sample) run.records.append(canonical, row, first_pair.empty() ? 0 : first_pair[row]);
    }
    return run;
}

}  // namespace latent::sampledb
