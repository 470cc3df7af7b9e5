#include "sampledb/codec/run_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/record_check.h"
#include "sampledb/codec/rounding.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/frames.h"
#include "sampledb/format/run_header.h"

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kMaxRecords = std::uint64_t{1} << 31;

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

RunEncoder::RunEncoder(const Job& job, const Coverage& coverage) {
    assert(!coverage.empty());
    header_.job = job.id;
    index_.coverage = coverage;
}

RunEncoder::Tail RunEncoder::finish() {
    Bytes index = encode_run_index(index_, header_);
    return {header_, std::move(index)};
}

Result<Bytes> encode_run(const Job& job, const Coverage& coverage, const Records& records, Bytes memory) {
    return RunBuilder().build(job, coverage, {std::shared_ptr<const Records>(std::shared_ptr<const Records>(), &records)},
                              std::move(memory));
}

Result<Bytes> RunBuilder::build(const Job& job, const Coverage& coverage, Pieces pieces, Bytes memory) {
    if (coverage.empty()) return Error{ErrorCode::kOutOfRange, "a run that covers no sample"};
    if (coverage.ranges().size() > kMaxIntervalsPerRun) return Error{ErrorCode::kOutOfRange, "a run with too many intervals"};
    std::uint64_t records = 0, pairs = 0, raw_bytes = 0;
    for (const auto& piece : pieces) records += piece->size(), pairs += piece->power.size(), raw_bytes += piece->raw_bytes();
    if (std::max(records, pairs) > kMaxRecords) return Error{ErrorCode::kOutOfRange, "more than 2^31 records or pairs in a run"};

    rows_.begin(job, records);
    for (std::shared_ptr<const Records>& piece : pieces) {
        if (Status s = check_records(job, coverage, *piece); !s) return s.error();
        rows_.add(*piece);
        piece.reset();
    }
    const std::size_t most = max_page_records(job);
    RunEncoder encoder(job, coverage);
    Bytes run = std::move(memory);
    run.clear();
    if (run.capacity() < raw_bytes + kBlock) run.reserve(raw_bytes + raw_bytes / 4 + kBlock);  // untouched, it costs nothing
    run.resize(kRunHeaderSize);
    for (const RecordClass record_class : {RecordClass::kCamera, RecordClass::kLight}) {
        for (std::size_t begin = 0, end = 0; begin < rows_.count(record_class); begin = end) {
            const std::size_t before = begin > 0 ? 1 : 0;
            end = begin - before + page_end(rows_.z(record_class, begin - before, before + most + 1), before, most);
            rows_.gather(record_class, begin, end, page_);
            round_values(job, page_);
            encoder.add_page(encoder_.encode(job, page_, run));
        }
    }
    const RunEncoder::Tail tail = encoder.finish();
    if (tail.header.page_count > kMaxPagesPerRun) return Error{ErrorCode::kOutOfRange, "a run with too many pages"};
    run.insert(run.end(), tail.index.begin(), tail.index.end());
    std::ranges::copy(encode_run_header(tail.header), run.begin());
    return run;
}

namespace {

void append_page(const Page& page, Records& records) {
    const std::size_t n = page.count, pairs = page.first_pair.empty() ? 0 : page.first_pair[n];
    records.record_class.insert(records.record_class.end(), n, page.record_class);
    const auto append = [&](Shape shape, auto& to, const auto& values) {
        const std::size_t size = values.empty() ? 0 : shape.rows == Rows::kPairs ? pairs : n * shape.width;
        to.insert(to.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size));
    };
    for_each_values(append, records, page);
    records.share.resize(records.size(), page.unit_share ? 1.0f : 0.0f);  // where the page has none
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
    canonical.extra = extra_columns(job);
    PageDecoder decoder;
    Page page;
    for (std::size_t i = 0; i < index->pages.size(); ++i) {
        const PageInfo& info = index->pages[i];
        const ByteSpan stored = bytes.subspan(info.offset, info.stored_size);
        if (Status s = decoder.decode(job, info, stored, ColumnSet{}, page, true); !s)
            return s.error().at(fmt::format("page {}", i));
        append_page(page, canonical);
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
