#include "sampledb/codec/run_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "sampledb/codec/page_codec.h"
#include "sampledb/codec/rounding.h"
#include "sampledb/codec/row_sorter.h"

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kMostRecords = std::uint64_t{1} << 31;

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

    const auto refused = [&](std::size_t i) -> const char* {
        if (r.record_class[i] > RecordClass::kLight) return "a record of unknown class";
        if (!coverage.contains(r.sample[i])) return "outside the run's coverage";
        if (r.record_class[i] == RecordClass::kCamera) return nullptr;
        if (r.share[i] != 0) return "a light record with a share of the denominator";
        return job.light_paths_per_sample == 0 ? "a light record in a job that has no light paths" : nullptr;
    };
    if (!all_fit_at_once(job, coverage, r)) {
        for (std::size_t i = 0; i < n; ++i) {
            if (const char* const why = refused(i)) return refuse(i, why);
        }
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

}  // namespace

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

void RunEncoder::add_page(const Page& page, Bytes& out) { add_page(encode_page(job_, page, out)); }

RunEncoder::Tail RunEncoder::finish() {
    Bytes index = encode_run_index(index_, header_);
    return {header_, std::move(index)};
}

Result<Bytes> encode_run(const Job& job, const Coverage& coverage, const Records& records, Bytes memory) {
    return encode_run(job, coverage, {std::shared_ptr<const Records>(std::shared_ptr<const Records>(), &records)},
                      std::move(memory));
}

Result<Bytes> encode_run(const Job& job, const Coverage& coverage, Pieces pieces, Bytes memory) {
    if (coverage.empty()) return Error{ErrorCode::kOutOfRange, "a run that covers no sample"};
    if (coverage.ranges().size() > kMaxIntervalsPerRun) return Error{ErrorCode::kOutOfRange, "a run of too many intervals"};
    std::uint64_t records = 0, pairs = 0, raw_bytes = 0;
    for (const auto& piece : pieces) records += piece->size(), pairs += piece->power.size(), raw_bytes += piece->raw_bytes();
    if (std::max(records, pairs) > kMostRecords) return Error{ErrorCode::kOutOfRange, "more than 2^31 records or pairs in a run"};

    thread_local RowSorter rows;
    rows.begin(job, records);
    for (std::shared_ptr<const Records>& piece : pieces) {
        if (Status s = check_records(job, coverage, *piece); !s) return s.error();
        rows.add(*piece);
        piece.reset();
    }
    const std::size_t most = max_page_records(job);
    RunEncoder encoder(job, coverage);
    Bytes run = std::move(memory);
    run.clear();
    if (run.capacity() < raw_bytes + kBlock) run.reserve(raw_bytes + raw_bytes / 4 + kBlock);  // untouched, it costs nothing
    run.resize(kRunHeaderSize);
    Page page;
    for (const RecordClass record_class : {RecordClass::kCamera, RecordClass::kLight}) {
        for (std::size_t begin = 0, end = 0; begin < rows.count(record_class); begin = end) {
            const std::size_t before = begin > 0 ? 1 : 0;
            end = begin - before + page_end(rows.z(record_class, begin - before, before + most + 1), before, most);
            rows.gather(record_class, begin, end, page);
            round_values(job, page);
            encoder.add_page(page, run);
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
    const std::vector<std::uint32_t> by_sample = order_by_sample(canonical);
    if (by_sample.empty()) {
        run.records = std::move(canonical);
        return run;
    }
    std::vector<std::uint64_t> first_pair(canonical.pairs.size());
    std::exclusive_scan(canonical.pairs.begin(), canonical.pairs.end(), first_pair.begin(), std::uint64_t{0});
    run.records = canonical.without_rows();
    for (const std::uint32_t row : by_sample) run.records.append(canonical, row, first_pair.empty() ? 0 : first_pair[row]);
    return run;
}

}  // namespace latent::sampledb
