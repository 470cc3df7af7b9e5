// Files made to mislead: every checksum is right, one field is not. Each ceiling of docs/format.md has a file that goes beyond it.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.h"
#include "sampledb/codec/column_decode.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/limits.h"
#include "sampledb/read/file_reader.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::make_job;

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
    ASSERT_LE(at + sizeof(T), bytes.size());
    store_le(bytes.data() + at, value);
}
template <class T>
T get(const Bytes& bytes, std::size_t at) {
    return load_le<T>(bytes.data() + at);
}

// A run whose fields can be overwritten, and whose hashes then say that all is well. Offsets: docs/format.md.
struct Forgery {
    Job job;
    Bytes run;

    explicit Forgery(const Job& of, std::uint64_t samples = 3000) : job(of) {
        const SampleRange range{0, samples};
        run = *encode_run(job, Coverage(range), synthetic::make_records(job, range, {.light_per_sample = 0.3}));
    }
    std::size_t index() const { return kRunHeaderSize + get<std::uint64_t>(run, 104); }
    std::size_t entry(std::size_t page) const { return index() + 16 * get<std::uint32_t>(run, 12) + kPageEntrySize * page; }
    std::size_t first_page() const { return kRunHeaderSize; }

    // Hashes from the inside out: first page, entries, index, header.
    void seal() {
        const std::uint32_t stored = get<std::uint32_t>(run, entry(0) + 32);
        if (first_page() + stored <= run.size()) {
            put(run, entry(0) + 40, hash64(ByteSpan(run).subspan(first_page(), stored)));
        }
        seal_index();
    }
    void seal_index() {
        Hasher128 content;
        for (std::size_t page = 0; page < get<std::uint64_t>(run, 64) && entry(page) + 32 <= run.size(); ++page) {
            content.update(ByteSpan(run).subspan(entry(page), 32));
        }
        put(run, 120, content.digest().low);
        put(run, 128, content.digest().high);
        put(run, 112, hash64(ByteSpan(run).subspan(index())));
        seal_header();
    }
    void seal_header() { put(run, 248, hash64(ByteSpan(run).first(248))); }
    ErrorCode decoded() const {
        const Result<DecodedRun> decoded = decode_run(job, run);
        return decoded ? ErrorCode::kStopped : decoded.error().code;  // kStopped: nothing was found wrong
    }
};

TEST(Hostile, AForgeryThatChangesNothingIsRead) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        Forgery f(make_job(kind), 500);
        const Bytes before = f.run;
        f.seal();
        EXPECT_TRUE(f.run == before);
        EXPECT_EQ(f.decoded(), ErrorCode::kStopped);
    }
}

TEST(Hostile, RunHeadersBeyondTheirCeilingsAreRefused) {
    struct Case {
        const char* what;
        std::size_t offset;
        std::uint64_t value;
    };
    const std::uint64_t huge = ~std::uint64_t{0};
    for (const Case& c :
         {Case{"no intervals", 12, 0}, Case{"too many intervals", 12, kMaxIntervalsPerRun + 1},
          Case{"intervals without gaps", 12, 2}, Case{"coverage ends before it begins", 48, 0},
          Case{"more samples than fit", 56, 5000}, Case{"no samples", 56, 0}, Case{"too many pages", 64, kMaxPagesPerRun + 1},
          Case{"huge page count", 64, huge}, Case{"fewer records than pages", 64, 6000}, Case{"camera records", 72, huge},
          Case{"light records", 80, huge}, Case{"records that overflow", 72, huge - 10}, Case{"pairs", 88, huge},
          Case{"decoded size", 96, huge}, Case{"stored size", 104, huge}, Case{"reserved", 200, 1}}) {
        SCOPED_TRACE(c.what);
        Forgery f(make_job(RecordKind::kXyz));
        if (c.offset == 12) {
            put(f.run, c.offset, static_cast<std::uint32_t>(c.value));
        } else {
            put(f.run, c.offset, c.value);
        }
        f.seal_header();
        const Result<RunHeader> header = decode_run_header(f.run);
        ASSERT_FALSE(header);
        EXPECT_EQ(header.error().code, ErrorCode::kCorrupt);
    }
    for (const auto& [offset, value] :
         {std::pair<std::size_t, std::uint16_t>{8, 2}, {16, 1}}) {  // another major version, a feature
        Forgery f(make_job(RecordKind::kXyz));
        put(f.run, offset, value);
        f.seal_header();
        EXPECT_EQ(decode_run_header(f.run).error().code, ErrorCode::kUnsupported);
    }
    Forgery other(make_job(RecordKind::kXyz));
    other.job.id.low ^= 1;
    EXPECT_EQ(other.decoded(), ErrorCode::kMismatch);
}

// Overwrites one field, seals, and decodes.
template <class T>
ErrorCode with(const Job& job, std::size_t (Forgery::*base)() const, std::size_t offset, T value) {
    Forgery f(job);
    put(f.run, (f.*base)() + offset, value);
    f.seal();
    return f.decoded();
}

TEST(Hostile, PageEntriesBeyondTheirCeilingsAreRefused) {
    const Job xyz = make_job(RecordKind::kXyz);
    const auto patched = [&](std::size_t offset, auto value) {
        Forgery f(xyz);
        put(f.run, f.entry(0) + offset, value);
        f.seal_index();
        return f.decoded();
    };
    EXPECT_EQ(patched(0, std::uint8_t{17}), ErrorCode::kCorrupt);                        // level
    EXPECT_EQ(patched(1, std::uint8_t{2}), ErrorCode::kCorrupt);                         // class
    EXPECT_EQ(patched(2, std::uint16_t{1}), ErrorCode::kCorrupt);                        // reserved
    EXPECT_EQ(patched(4, std::uint32_t{1u << 16}), ErrorCode::kCorrupt);                 // x outside the film
    EXPECT_EQ(patched(12, std::uint32_t{0}), ErrorCode::kCorrupt);                       // no records
    EXPECT_EQ(patched(12, std::uint32_t{kMaxRecordsPerPage + 1}), ErrorCode::kCorrupt);  // too many
    EXPECT_EQ(patched(16, std::uint32_t{1}), ErrorCode::kCorrupt);                       // pairs in an XYZ job
    EXPECT_EQ(patched(20, ~std::uint32_t{0}), ErrorCode::kCorrupt);                      // decoded size
    EXPECT_EQ(patched(32, ~std::uint32_t{0}), ErrorCode::kCorrupt);                      // stored size
    EXPECT_EQ(patched(36, std::uint32_t{1}), ErrorCode::kCorrupt);                       // reserved
    EXPECT_EQ(patched(24, std::uint64_t{1}), ErrorCode::kCorrupt);                       // content hash

    // More records than the cut rule leaves in a page, though the header's ceilings, those of all jobs, hold them.
    Job wide = make_job(RecordKind::kSpectral);
    for (const auto& [batch, most] : {std::pair<std::uint16_t, std::uint32_t>{1, 6144}, {28, 3072}, {1000, 86}, {kMaxPairs, 84}}) {
        wide.batch = batch;
        EXPECT_EQ(max_page_records(wide), most);
        Forgery f(wide, 40);
        const std::uint32_t records = most + 1;
        put(f.run, f.entry(0) + 12, records);
        put(f.run, f.entry(0) + 20,
            static_cast<std::uint32_t>(
                decoded_page_size(wide, RecordClass::kCamera, records, get<std::uint32_t>(f.run, f.entry(0) + 16))));
        f.seal_index();
        const Result<DecodedRun> decoded = decode_run(wide, f.run);
        ASSERT_FALSE(decoded);
        EXPECT_NE(decoded.error().message.find("too many records"), std::string::npos) << decoded.error().message;
    }

    Forgery swapped(xyz, 20000);  // a light page before a camera page
    const std::uint64_t pages = get<std::uint64_t>(swapped.run, 64);
    put(swapped.run, swapped.entry(0) + 1, std::uint8_t{1});
    put(swapped.run, swapped.entry(pages - 1) + 1, std::uint8_t{0});
    swapped.seal_index();
    EXPECT_EQ(swapped.decoded(), ErrorCode::kCorrupt);

    for (const SampleRange range : {SampleRange{5, 5}, SampleRange{0, 2999}, SampleRange{1, 3000}}) {
        Forgery interval(xyz);
        put(interval.run, interval.index(), range.first);
        put(interval.run, interval.index() + 8, range.end);
        interval.seal_index();
        EXPECT_EQ(interval.decoded(), ErrorCode::kCorrupt);
    }
}

TEST(Hostile, PagesThatMakeNoSenseAreRefused) {
    // Table at the front of a page: u32 count; then per column: id, transform, bits, planes, u32 lattice bits, u64 base, u64 hash,
    // planes.
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = make_job(kind);
        const auto patched = [&](std::size_t offset, auto value) { return with(job, &Forgery::first_page, offset, value); };
        EXPECT_EQ(patched(0, std::uint32_t{99}), ErrorCode::kCorrupt);         // columns
        EXPECT_EQ(patched(4, std::uint8_t{2}), ErrorCode::kCorrupt);           // another column
        EXPECT_EQ(patched(5, std::uint8_t{200}), ErrorCode::kUnsupported);     // an unknown transform
        EXPECT_EQ(patched(5, std::uint8_t{3}), ErrorCode::kUnsupported);       // one that does not fit the column
        EXPECT_EQ(patched(6, std::uint8_t{65}), ErrorCode::kCorrupt);          // bits
        EXPECT_EQ(patched(6, std::uint8_t{0}), ErrorCode::kCorrupt);           // a constant column with planes
        EXPECT_EQ(patched(6, std::uint8_t{64}), ErrorCode::kCorrupt);          // more bits than stored
        EXPECT_EQ(patched(7, std::uint8_t{9}), ErrorCode::kCorrupt);           // planes
        EXPECT_EQ(patched(7, std::uint8_t{0}), ErrorCode::kCorrupt);           // none
        EXPECT_EQ(patched(8, std::uint32_t{33}), ErrorCode::kCorrupt);         // lattice
        EXPECT_EQ(patched(12, std::uint64_t{1}), ErrorCode::kCorrupt);         // other sample numbers: content hash
        EXPECT_EQ(patched(20, std::uint64_t{1}), ErrorCode::kCorrupt);         // another hash: not the page's
        EXPECT_EQ(patched(28, std::uint32_t{3u << 30}), ErrorCode::kCorrupt);  // a plane of no bytes: planes do not fill the page
        Forgery codec(job);
        const std::uint32_t word = get<std::uint32_t>(codec.run, codec.first_page() + 28);
        put(codec.run, codec.first_page() + 28, word | 3u << 30);  // a raw plane called a dictionary
        codec.seal();
        EXPECT_EQ(codec.decoded(), ErrorCode::kCorrupt);
    }
    Forgery lattice(make_job(RecordKind::kXyz), 20000);
    ASSERT_EQ(get<std::uint8_t>(lattice.run, lattice.first_page() + 5), 2);
    put(lattice.run, lattice.first_page() + 8, std::uint32_t{0});
    lattice.seal();
    EXPECT_EQ(lattice.decoded(), ErrorCode::kCorrupt);
    Job without = make_job(RecordKind::kXyz);  // positions left out, but the job names no sampler
    Forgery f(without);
    f.job.positions = {};
    EXPECT_EQ(f.decoded(), ErrorCode::kCorrupt);
    Job by_pixels = make_job(RecordKind::kXyz);  // samples by pixels, but the job's sampler has none
    by_pixels.positions = synthetic::pixels_of(48, 32);
    Forgery pixels(by_pixels, 20000);
    ASSERT_EQ(get<std::uint8_t>(pixels.run, pixels.first_page() + 5), 12);
    pixels.job.positions = without.positions;
    EXPECT_EQ(pixels.decoded(), ErrorCode::kCorrupt);
}

TEST(Hostile, BytesBehindTheIndexAreZero) {
    Forgery f(make_job(RecordKind::kXyz), 500);
    ASSERT_NE(f.entry(get<std::uint64_t>(f.run, 64)), f.run.size());
    put(f.run, f.run.size() - 1, std::uint8_t{1});
    f.seal_index();
    EXPECT_EQ(f.decoded(), ErrorCode::kCorrupt);
}

TEST(Hostile, LightRecordsNeedLightPaths) {
    Forgery f(make_job(RecordKind::kXyz));
    ASSERT_GT(get<std::uint64_t>(f.run, 80), 0u);
    f.job.light_paths_per_sample = 0;
    const Result<DecodedRun> decoded = decode_run(f.job, f.run);
    ASSERT_FALSE(decoded);
    EXPECT_NE(decoded.error().message.find("light"), std::string::npos) << decoded.error().message;
    const SampleRange range{0, 500};
    EXPECT_FALSE(encode_run(f.job, Coverage(range), synthetic::make_records(make_job(RecordKind::kXyz), range)));
}

TEST(Hostile, ThereIsNoSample2To64Minus1) {
    constexpr std::uint64_t kLast = ~std::uint64_t{0} - 1;
    Job job = make_job(RecordKind::kXyz);
    job.positions = {};
    const SampleRange range{kLast, kLast + 1};
    Records records = synthetic::make_records(job, range, {.light_per_sample = 0});
    ASSERT_EQ(records.size(), 1u);
    const synthetic::FileBytes file =
        synthetic::make_file(job, std::vector<Coverage>{Coverage(range)}, true, {.light_per_sample = 0});
    const auto verified = [&](ByteSpan bytes) {
        const Result<FileContents> contents = read_file(MemorySource(bytes), VerifyLevel::kFull);
        return contents && contents->runs.size() == 1;
    };
    EXPECT_TRUE(verified(file.bytes));

    Forgery f(job, 1);  // a column of one value, which its base holds; then hashes from the inside out
    f.run = *encode_run(job, Coverage(range), records);
    put(f.run, f.first_page() + 12, kLast + 1);
    const Bytes value(8, std::byte{0xFF});
    put(f.run, f.first_page() + 20, hash64(value));
    std::vector<std::uint64_t> hashes;
    for (std::size_t at = f.first_page() + 4; hashes.size() < get<std::uint32_t>(f.run, f.first_page());
         at += 24 + 4 * get<std::uint8_t>(f.run, at + 3)) {
        hashes.push_back(get<std::uint64_t>(f.run, at + 16));
    }
    put(f.run, f.entry(0) + 24, hash64(std::as_bytes(std::span(hashes))));
    f.seal();
    Bytes forged = file.bytes;
    ASSERT_EQ(f.run.size(), file.run_ends[0] - file.header_size);
    forged.resize(file.header_size);
    forged.insert(forged.end(), f.run.begin(), f.run.end());
    EXPECT_EQ(f.decoded(), ErrorCode::kStopped);  // every checksum is right
    const Result<FileContents> contents = read_file(MemorySource(forged), VerifyLevel::kFull);
    ASSERT_TRUE(contents);
    ASSERT_EQ(contents->runs.size(), 0u);
    EXPECT_NE(contents->damage[0].reason.find("outside the run's coverage"), std::string::npos) << contents->damage[0].reason;
    Records beyond = records;
    beyond.sample[0] = kLast + 1;
    EXPECT_FALSE(encode_run(job, Coverage(range), beyond));
}

TEST(Hostile, BitmapsThatMisleadAreRefused) {
    constexpr std::size_t kRows = 12;
    const auto column = [](Transform transform, ByteSpan stored, std::size_t bitmap, std::size_t planes) {
        ColumnEntry entry{.column = Column::kY, .transform = transform, .stored = stored};
        if (bitmap > 0) entry.planes.push_back({PlaneCodec::kRaw, static_cast<std::uint32_t>(bitmap)});
        for (std::size_t p = 0; p < planes; ++p) entry.planes.push_back({PlaneCodec::kConstant, 1});
        return entry;
    };
    ColumnDecoder decoder;
    BrightRows bright;
    const auto y = [&](unsigned rows, std::size_t planes = 4, std::size_t bitmap = 2) {
        const Bytes stored = {static_cast<std::byte>(rows),
                              static_cast<std::byte>(rows >> 8),
                              std::byte{1},
                              std::byte{2},
                              std::byte{3},
                              std::byte{4}};
        std::vector<float> values(kRows);
        return decoder.luminance(column(Transform::kSparse, stored, bitmap, planes), values, bright);
    };
    EXPECT_TRUE(y(0x0FFF));
    EXPECT_TRUE(y(0x0001));
    EXPECT_FALSE(y(0x0000));     // no row
    EXPECT_FALSE(y(0x1001));     // one behind the page's last
    EXPECT_FALSE(y(0x0001, 3));  // a plane too few
    EXPECT_FALSE(y(0x0001, 4, 1));
    EXPECT_FALSE(y(0x0001, 4, 0));
    const Bytes differences(4);
    std::vector<float> values(kRows), of_y(kRows);
    const ColumnEntry x = column(Transform::kSparseCross, differences, 0, 4);
    ASSERT_TRUE(y(0x0801));
    EXPECT_TRUE(decoder.crossed(x, values, of_y, bright));
    EXPECT_EQ(std::ranges::count(values, 0.0f), static_cast<std::ptrdiff_t>(kRows) - 2);
    const ColumnEntry constant{.column = Column::kY, .transform = Transform::kPacked};
    ASSERT_TRUE(decoder.luminance(constant, values, bright));  // a y that names no rows
    EXPECT_FALSE(decoder.crossed(x, values, of_y, bright));
}

TEST(Hostile, StepsOfImpossibleSizeAreRefused) {
    ColumnDecoder decoder;
    const Bytes stored(4);
    std::vector<float> values(5), y(5);
    const std::vector<std::uint16_t> pairs = {2, 3};
    ColumnEntry entry{.column = Column::kX, .stored = stored};
    for (int p = 0; p < 4; ++p) entry.planes.push_back({PlaneCodec::kConstant, 1});
    for (int bits = 0; bits <= 64; ++bits) {
        const bool possible = bits >= 1 && bits <= 22;
        entry.bits = static_cast<std::uint8_t>(bits);
        entry.transform = Transform::kSteppedCross;
        EXPECT_EQ(bool(decoder.crossed(entry, values, y, {})), possible) << bits;
        entry.transform = Transform::kSteppedDelta2;
        EXPECT_EQ(bool(decoder.along_records(entry, values, pairs, 3)), possible) << bits;
    }
}

TEST(Hostile, FileHeadersBeyondTheirCeilingsAreRefused) {
    const Bytes good = *encode_file_header({make_job(RecordKind::kSpectral), "{}"});
    const std::size_t copy = good.size() / 2;
    const auto code = [&](std::size_t offset, auto value) {
        Bytes header = good;
        put(header, offset, value);
        put(header, 32, hash64(ByteSpan(header).subspan(64, copy - 64)));
        put(header, 56, hash64(ByteSpan(header).first(56)));
        const Result<FileHeader> decoded = decode_file_header(header);
        return decoded ? ErrorCode::kStopped : decoded.error().code;
    };
    EXPECT_EQ(code(40, std::uint8_t{0}), ErrorCode::kStopped);
    EXPECT_EQ(code(8, std::uint16_t{2}), ErrorCode::kUnsupported);         // major version
    EXPECT_EQ(code(16, std::uint64_t{1} << 40), ErrorCode::kUnsupported);  // a feature
    EXPECT_EQ(code(12, std::uint32_t{0}), ErrorCode::kCorrupt);            // size
    EXPECT_EQ(code(12, std::uint32_t{4097}), ErrorCode::kCorrupt);         // not a multiple of 4096
    EXPECT_EQ(code(12, std::uint32_t{0xFFFFF000}), ErrorCode::kCorrupt);   // beyond the ceiling
    EXPECT_EQ(code(24, ~std::uint64_t{0}), ErrorCode::kCorrupt);           // fields longer than the header
    EXPECT_EQ(code(24, std::uint64_t{10}), ErrorCode::kCorrupt);           // shorter
    EXPECT_EQ(code(copy - 1, std::uint8_t{1}), ErrorCode::kCorrupt);       // behind the fields, where zeros belong
    const std::size_t body = 64;
    EXPECT_EQ(code(body + 16, std::uint32_t{0}), ErrorCode::kCorrupt);       // film aspect
    EXPECT_EQ(code(body + 16, std::uint32_t{4}), ErrorCode::kCorrupt);       // 4:2 is not in lowest terms
    EXPECT_EQ(code(body + 24, std::uint8_t{9}), ErrorCode::kCorrupt);        // record kind
    EXPECT_EQ(code(body + 25, std::uint8_t{9}), ErrorCode::kUnsupported);    // sampler
    EXPECT_EQ(code(body + 26, std::uint16_t{1025}), ErrorCode::kCorrupt);    // batch
    EXPECT_EQ(code(body + 32, -1.0), ErrorCode::kCorrupt);                   // light unit
    EXPECT_EQ(code(body + 40, ~std::uint64_t{0}), ErrorCode::kCorrupt);      // R
    EXPECT_EQ(code(body + 48, std::uint32_t{1000}), ErrorCode::kCorrupt);    // S
    EXPECT_EQ(code(body + 60, ~std::uint32_t{0}), ErrorCode::kCorrupt);      // knots
    EXPECT_EQ(code(body + 64, std::uint32_t{17}), ErrorCode::kCorrupt);      // extra columns
    EXPECT_EQ(code(body + 68, ~std::uint32_t{0}), ErrorCode::kCorrupt);      // provenance
    EXPECT_EQ(code(body + 72 + 12, std::uint64_t{0}), ErrorCode::kCorrupt);  // a density that does not rise
}

}  // namespace
}  // namespace latent::sampledb
