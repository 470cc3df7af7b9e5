// The frames of a .latent file, each by itself: header, footer, run, page.
#include "sampledb/format/frames.h"

#include <cstring>

#include "base/hash.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/limits.h"
#include "sampledb/format/file_header.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/footer_reader.h"
#include "tests/fuzz/mend.h"
#include "tests/fuzz/target.h"
#include "tests/support/synthetic.h"

namespace latent::fuzz {

using namespace sampledb;

namespace {

// One of each kind.
const std::vector<Job>& jobs_of_frames() {
    static const std::vector<Job> all = [] {
        Job xyz = synthetic::make_short_job(), spectral = synthetic::make_short_job(RecordKind::kSpectral), few = spectral,
            explicit_wavelengths = spectral, extra = xyz, rounded = spectral;
        few.batch = 5;
        few.positions = {};
        explicit_wavelengths.density = {};
        extra.positions = {};
        extra.extra = {{"a", ColumnType::kU8},  {"b", ColumnType::kU16}, {"c", ColumnType::kU32},
                       {"d", ColumnType::kU64}, {"e", ColumnType::kF32}, {"f", ColumnType::kF64}};
        rounded.precision = 9;
        std::vector<Job> made = {xyz, spectral, few, explicit_wavelengths, extra, rounded};
        made.push_back(xyz);
        made.back().precision = 9;
        return made;
    }();
    return all;
}
const Job& job_of(std::byte choice) { return jobs_of_frames()[std::to_integer<std::size_t>(choice) % jobs_of_frames().size()]; }

synthetic::FileBytes small_file(const Job& job, bool footer = true) {
    return synthetic::make_file(job, std::vector{Coverage(SampleRange{0, 40}), Coverage(SampleRange{4096, 4160})}, footer,
                                {.light_per_sample = 0.4, .split_shares = true}, R"({"a":[1,{"b":2}]})");
}

bool run_header(ByteSpan bytes) {
    std::uint64_t size = 0;
    const Result<FileHeader> header = decode_file_header(bytes, &size);
    if (!header) return false;
    require(size <= bytes.size(), "a header that is read was there");
    const Result<Bytes> again = encode_file_header(*header);
    require(again.has_value(), "a header that can be read can be written");
    const Result<FileHeader> read = decode_file_header(*again);
    require(read && read->job.id == header->job.id && read->provenance_json == header->provenance_json,
            "a header that is written again reads the same");
    return true;
}

std::vector<Bytes> header_seeds() {
    std::vector<Bytes> seeds;
    for (const Job& job : jobs_of_frames()) {
        const synthetic::FileBytes file = small_file(job);
        seeds.emplace_back(file.bytes.begin(), file.bytes.begin() + static_cast<std::ptrdiff_t>(file.header_size));
    }
    return seeds;
}

bool run_footer(ByteSpan bytes) {
    const MemorySource source(bytes);
    const Result<FooterFrame> end = read_footer_end(source);
    if (!end) return false;
    const Result<FooterReader> footer = FooterReader::open(source, *end);
    if (!footer) return false;
    std::uint64_t runs = 0, header_size = kBlock;
    const Result<FileHeader> header = decode_file_header(bytes, &header_size);
    const Status listed =
        footer->for_each_run(2 * header_size, header ? header->job.id : jobs_of_frames()[0].id, [&](const RunInfo&) { ++runs; });
    require(!listed || runs == footer->run_count(), "a footer lists as many runs as it says");
    (void)footer->provenance();
    return listed.has_value();
}

std::vector<Bytes> footer_seeds() {
    std::vector<Bytes> seeds;
    for (const Job& job : jobs_of_frames()) seeds.push_back(small_file(job).bytes);
    return seeds;
}

// The first byte chooses the job; the others are a run.
bool run_run(ByteSpan bytes) {
    if (bytes.empty()) return false;
    const Job& job = job_of(bytes[0]);
    const Result<DecodedRun> run = decode_run(job, bytes.subspan(1));
    if (!run) return false;
    require(run->records.size() == run->header.camera_records + run->header.light_records, "a run holds what its header counts");
    return true;
}

void mend_run_behind_choice(Bytes& bytes) {
    if (bytes.empty()) return;
    Bytes run(bytes.begin() + 1, bytes.end());
    mend_run(run, 0);
    std::copy(run.begin(), run.end(), bytes.begin() + 1);
}

std::vector<Bytes> run_seeds() {
    std::vector<Bytes> seeds;
    for (std::size_t i = 0; i < jobs_of_frames().size(); ++i) {
        const synthetic::FileBytes file = small_file(jobs_of_frames()[i]);
        Bytes seed = {std::byte{static_cast<unsigned char>(i)}};
        seed.insert(seed.end(), file.bytes.begin() + static_cast<std::ptrdiff_t>(file.header_size),
                    file.bytes.begin() + static_cast<std::ptrdiff_t>(file.run_ends[0]));
        seeds.push_back(std::move(seed));
    }
    return seeds;
}

// The first bytes choose a job, and what the index says of the page; the others are the page as it is stored.
struct PageFront {
    std::uint8_t job, record_class, level, columns;
    std::uint16_t records, unused;
    std::uint32_t pairs;
};
static_assert(sizeof(PageFront) == 12);

bool run_page(ByteSpan bytes) {
    PageFront front;
    if (bytes.size() < sizeof front) return false;
    std::memcpy(&front, bytes.data(), sizeof front);
    const Job& job = job_of(std::byte{front.job});
    const ByteSpan stored = bytes.subspan(sizeof front);
    PageInfo info{};
    info.record_class = RecordClass{static_cast<std::uint8_t>(front.record_class & 1u)};
    info.node.level = front.level % 17;
    info.record_count = 1 + front.records % static_cast<std::uint32_t>(kMaxRecordsPerPage);
    info.pair_count = job.kind == RecordKind::kXyz ? 0 : front.pairs % (info.record_count * job.batch + 1u);
    info.decoded_size = static_cast<std::uint32_t>(decoded_page_size(job, info.record_class, info.record_count, info.pair_count));
    info.stored_size = static_cast<std::uint32_t>(stored.size());
    info.stored_hash = hash64(stored);
    ColumnSet columns;
    columns.samples = (front.columns & 1) != 0, columns.positions = (front.columns & 2) != 0,
    columns.values = (front.columns & 4) != 0;
    columns.share = (front.columns & 8) != 0;
    if ((front.columns & 16) == 0) columns.extra.reset();
    std::vector<ColumnEntry> table;
    (void)read_table(job, info, stored, table);
    info.content_hash = content_hash(table);  // what refuses other hashes was seen
    static PageDecoder decoder;
    static Page page;
    (void)decoder.decode(job, info, stored, columns, page);
    const bool whole = decoder.decode(job, info, stored, ColumnSet{}, page, true).has_value();
    if (whole) require(page.count == info.record_count, "a page has its records");
    (void)stored_columns(job, info, stored);
    return whole;
}

// Every page of a small file.
std::vector<Bytes> page_seeds() {
    std::vector<Bytes> seeds;
    for (std::size_t i = 0; i < jobs_of_frames().size(); ++i) {
        const synthetic::FileBytes file = small_file(jobs_of_frames()[i]);
        const MemorySource source(file.bytes);
        const std::vector<RunInfo> runs = synthetic::runs_of(file);
        for (const RunInfo& run : runs) {
            const Result<RunIndex> index = read_run_index(source, run, jobs_of_frames()[i]);
            require(index.has_value(), "a made-up file can be read");
            for (const PageInfo& info : index->pages) {
                const PageFront front = {static_cast<std::uint8_t>(i),
                                         static_cast<std::uint8_t>(info.record_class),
                                         static_cast<std::uint8_t>(info.node.level),
                                         31,
                                         static_cast<std::uint16_t>(info.record_count - 1),
                                         0,
                                         info.pair_count};
                Bytes seed(sizeof front);
                std::memcpy(seed.data(), &front, sizeof front);
                const auto begin = file.bytes.begin() + static_cast<std::ptrdiff_t>(info.offset);
                seed.insert(seed.end(), begin, begin + static_cast<std::ptrdiff_t>(info.stored_size));
                seeds.push_back(std::move(seed));
            }
        }
    }
    return seeds;
}

}  // namespace

Target header() { return {"header", run_header, mend_header, false, 10000, header_seeds}; }
Target footer() { return {"footer", run_footer, mend_footer, false, 10000, footer_seeds}; }
Target run() { return {"run", run_run, mend_run_behind_choice, false, 8000, run_seeds}; }
Target page() { return {"page", run_page, nullptr, false, 15000, page_seeds}; }

}  // namespace latent::fuzz
