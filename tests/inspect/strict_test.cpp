// verify --strict: a small writer that makes one mistake at a time. Every reader takes its files; --strict names the mistake.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/hash.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/z_order.h"
#include "sampledb/format/footer.h"
#include "tests/inspect/inspect_test.h"
#include "tests/support/paths.h"
#include "tools/inspect/verify.h"

namespace latent::inspect {
namespace {

namespace fs = std::filesystem;
using namespace sampledb;
using namespace latent::testing;

struct Row {
    std::uint64_t sample;
    std::uint32_t u, v;
    float share = 1;
    float y = 0.5f;
};

// A column as it is about to be stored.
struct StoredPlane {
    PlaneCodec codec;
    Bytes bytes;
};
struct TestColumn {
    Column id;
    Transform transform = Transform::kPlanes;
    std::uint8_t bits = 0;
    std::uint32_t s = 0;
    std::uint64_t base = 0;
    Bytes values{};
    std::vector<StoredPlane> planes{};
};
using Columns = std::vector<TestColumn>;

struct TestPage {
    RecordClass record_class = RecordClass::kCamera;
    std::vector<Row> rows{};
    std::function<void(Columns&)> spoil{};  // on the way to the file
    std::optional<FilmNode> square{};       // named by the entry, instead of the smallest
};

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    return {bytes.begin(), bytes.end()};
}

// The simplest encoding: sample numbers with 64 bits, everything else as raw planes.
TestColumn plain(Column id, const Bytes& values, std::size_t width) {
    TestColumn column{.id = id, .values = values};
    if (values.empty()) return column;
    if (id == Column::kSample) {
        column.transform = Transform::kPacked;
        column.bits = 64;
        column.planes = {{PlaneCodec::kRaw, values}};
        return column;
    }
    for (std::size_t p = 0; p < width; ++p) {
        Bytes plane;
        for (std::size_t at = p; at < values.size(); at += width) plane.push_back(values[at]);
        column.planes.push_back({PlaneCodec::kRaw, plane});
    }
    return column;
}

Columns columns_of(const Job& job, const TestPage& page) {
    const std::size_t n = page.rows.size();
    const auto column = [&](auto get) {
        std::vector<decltype(get(page.rows[0]))> values;
        for (const Row& row : page.rows) values.push_back(get(row));
        return bytes_of(values);
    };
    Columns columns = {plain(Column::kSample, column([](const Row& r) { return r.sample; }), 8),
                       plain(Column::kU, column([](const Row& r) { return r.u; }), 4),
                       plain(Column::kV, column([](const Row& r) { return r.v; }), 4)};
    if (page.record_class == RecordClass::kCamera)
        columns.push_back(plain(Column::kShare, column([](const Row& r) { return r.share; }), 4));
    if (job.kind == RecordKind::kXyz) {
        for (const Column id : {Column::kX, Column::kY, Column::kZ})
            columns.push_back(plain(id, column([](const Row& r) { return r.y; }), 4));
    } else {  // black records
        columns.push_back(plain(Column::kPairs, Bytes(2 * n), 2));
        columns.push_back(plain(Column::kXi, Bytes(4 * n), 4));
        columns.push_back(plain(Column::kIndex, bytes_of(std::vector<std::uint16_t>(n, kNoIndex)), 2));
        columns.push_back(plain(Column::kPower, {}, 4));
    }
    return columns;
}

FilmNode smallest_square(const std::vector<Row>& rows) {
    std::uint32_t different = 0;
    for (const Row& row : rows) different |= (row.u ^ rows[0].u) | (row.v ^ rows[0].v);
    const int level = std::min(16, std::countl_zero(different));
    if (level == 0) return {};
    return {static_cast<std::uint8_t>(level), rows[0].u >> (32 - level), rows[0].v >> (32 - level)};
}

PageInfo write_page(const Job& job, const TestPage& page, Bytes& out) {
    Columns columns = columns_of(job, page);
    std::vector<std::uint64_t> hashes;
    std::size_t decoded = 0;
    for (const TestColumn& column : columns) hashes.push_back(hash64(column.values)), decoded += column.values.size();
    if (page.spoil) page.spoil(columns);
    const std::size_t begin = out.size();
    ByteWriter writer(out);
    writer.put(static_cast<std::uint32_t>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const TestColumn& column = columns[i];
        writer.put(static_cast<std::uint8_t>(column.id));
        writer.put(static_cast<std::uint8_t>(column.transform));
        writer.put(column.bits);
        writer.put(static_cast<std::uint8_t>(column.planes.size()));
        writer.put(column.s);
        writer.put(column.base);
        writer.put(hashes[i]);
        for (const StoredPlane& plane : column.planes)
            writer.put(PlaneEntry{plane.codec, static_cast<std::uint32_t>(plane.bytes.size())}.word());
    }
    for (const TestColumn& column : columns) {
        for (const StoredPlane& plane : column.planes) writer.put(plane.bytes);
    }
    PageInfo info{};
    info.node = page.square.value_or(smallest_square(page.rows));
    info.record_class = page.record_class;
    info.record_count = static_cast<std::uint32_t>(page.rows.size());
    info.decoded_size = static_cast<std::uint32_t>(decoded);
    info.content_hash = hash64(std::as_bytes(std::span(hashes)));
    info.stored_size = static_cast<std::uint32_t>(out.size() - begin);
    info.stored_hash = hash64(ByteSpan(out).subspan(begin));
    return info;
}

Bytes write_run(const Job& job, const Coverage& coverage, const std::vector<TestPage>& pages) {
    Bytes run(kRunHeaderSize);
    RunIndex index{coverage, {}};
    for (const TestPage& page : pages) index.pages.push_back(write_page(job, page, run));
    RunHeader header;
    header.job = job.id;
    const Bytes end = encode_run_index(index, header);
    run.insert(run.end(), end.begin(), end.end());
    std::ranges::copy(encode_run_header(header), run.begin());
    return run;
}

class Strict : public InspectTest {
 protected:
    Job job_ = synthetic::make_short_job();

    // A file of these runs.
    fs::path write_file(const std::vector<Bytes>& runs, const std::string& provenance = "",
                        const std::function<void(Bytes&)>& spoil = {}) const {
        Bytes file = *encode_file_header({job_, provenance});
        if (spoil) spoil(file);
        std::vector<RunInfo> list;
        for (const Bytes& run : runs) {
            list.push_back({file.size(), *decode_run_header(run)});
            file.insert(file.end(), run.begin(), run.end());
        }
        const Bytes footer = *encode_footer(list, "", file.size());
        file.insert(file.end(), footer.begin(), footer.end());
        return write("a.latent", file);
    }
    fs::path write_pages(const std::vector<TestPage>& pages) const {
        return write_file({write_run(job_, Coverage(SampleRange{0, 1 << 13}), pages)});
    }
    static Violations violations_of(const fs::path& file) {
        const Result<VerifyReport> deep = verify(file, VerifyLevel::kFull, false, 1);
        EXPECT_TRUE(deep && deep->damage.empty()) << (deep ? deep->damage.front() : deep.error().message);  // readers take it
        const Result<VerifyReport> strict = verify(file, VerifyLevel::kFull, true, 1);
        EXPECT_TRUE(strict && strict->damage.empty());
        return strict ? strict->violations : Violations{};
    }
    // Exactly one violation: there, with these words.
    static void expect_one(const fs::path& file, const Violation& expected) {
        const Violations found = violations_of(file);
        ASSERT_EQ(found.count(), 1u) << (found.listed().empty() ? "" : found.listed().back().what);
        const Violation& one = found.listed().front();
        EXPECT_EQ(one.run, expected.run);
        EXPECT_EQ(one.page, expected.page);
        EXPECT_EQ(one.record, expected.record);
        EXPECT_NE(one.what.find(expected.what), std::string::npos) << one.what;
        EXPECT_NE(one.wanted.find(expected.wanted), std::string::npos) << one.wanted;
    }
    // Mistakes in how the columns of one page are stored.
    void expect_one_in_page(const std::function<void(Columns&)>& spoil, const std::string& what, const std::string& wanted,
                            RecordClass record_class = RecordClass::kCamera) const {
        std::vector<TestPage> pages = {{.rows = diagonal(10)}};
        if (record_class == RecordClass::kLight) pages.push_back({.record_class = record_class, .rows = diagonal(10)});
        pages.back().spoil = spoil;
        expect_one(write_pages(pages), {.run = 0, .page = pages.size() - 1, .what = what, .wanted = wanted});
    }

    // Rows in order: Z prefixes ascend with the position along the diagonal.
    static std::vector<Row> diagonal(std::uint32_t count) {
        std::vector<Row> rows;
        for (std::uint32_t i = 0; i < count; ++i) rows.push_back({i, i << 18, i << 18});
        return rows;
    }
};

TEST_F(Strict, WhatTheSmallWriterMakesWithoutMistakeFollowsTheFormat) {
    EXPECT_EQ(
        violations_of(write_pages({{.rows = diagonal(100)}, {.record_class = RecordClass::kLight, .rows = diagonal(50)}})).count(),
        0u);
    job_ = synthetic::make_short_job(RecordKind::kSpectral);
    EXPECT_EQ(violations_of(write_pages({{.rows = diagonal(100)}})).count(), 0u);
}

TEST_F(Strict, WhatOurWritersMakeFollowsTheFormat) {
    synthetic::Scene scene;
    scene.split_shares = true;
    scene.light_per_sample = 0.4;
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        Job job = synthetic::make_short_job(kind);
        job.extra = {{"depth", ColumnType::kF32}, {"light_group", ColumnType::kU16}};
        write("a.latent", synthetic::make_file(job, four_runs(), true, scene).bytes);
        ASSERT_EQ(run({tool("latent-merge"), folder_ / "a.latent", "--compact", "--force", "-o", folder_ / "b.latent"}).status, 0);
        for (const char* name : {"a.latent", "b.latent"}) {
            const Outcome outcome = inspect({"verify", "--strict", folder_ / name});
            EXPECT_EQ(outcome.status, 0) << outcome.out;
            EXPECT_NE(outcome.out.find("sound, and follows the format"), std::string::npos) << outcome.out;
        }
    }
    for (const char* options : {"--light=0.3", "--every=77", "--kind=spectral", "--random-positions", "--precision=9"}) {
        ASSERT_EQ(
            inspect({"gen", "-o", folder_ / "c.latent", "--records", "30k", "--run-samples", "8192", "--force", options}).status,
            0);
        EXPECT_EQ(inspect({"verify", "--strict", folder_ / "c.latent"}).status, 0) << options;
    }
    for (const char* name :
         {"explicit.latent", "rounded.latent", "sparse.latent", "spectral.latent", "xyz.latent", "xyz_extra.latent.part.golden"})
        EXPECT_EQ(inspect({"verify", "--strict", testing::in_tree(std::string("tests/golden/") + name)}).status, 0) << name;
}

TEST_F(Strict, WhatTheWriterInPythonMakesFollowsTheFormat) {
    for (const char* kind : {"smallest", "xyz", "spectral", "explicit"}) {
        for (const char* seed : {"1"}) {
            const fs::path file = folder_ / "p.latent";
            ASSERT_EQ(run_python("tests/sampledb/write_latent.py", {kind, file.string(), "--vary", seed}).status, 0);
            const Outcome outcome = inspect({"verify", "--strict", file});
            EXPECT_EQ(outcome.status, 0) << kind << outcome.out;
        }
    }
}

TEST_F(Strict, RecordsOutOfOrderAreNamedOneByOne) {
    std::vector<Row> rows = diagonal(100);
    std::swap(rows[41], rows[42]);
    expect_one(write_pages({{.rows = rows}}),
               {.run = 0, .page = 0, .record = 42, .what = "sample 41", .wanted = "not before Z prefix"});
    rows = diagonal(100);
    for (Row& row : rows) row.u = row.v = 0;
    std::swap(rows[7].sample, rows[8].sample);
    expect_one(
        write_pages({{.rows = rows}}),
        {.run = 0, .page = 0, .record = 8, .what = "Z prefix 00000000, sample 7", .wanted = "sample 8, the previous record"});
    std::ranges::reverse(rows);
    EXPECT_EQ(violations_of(write_pages({{.rows = rows}})).count(), 98u);
}

TEST_F(Strict, ARunThatBreaksWhatReadersRelyOnIsLostAndNoOther) {
    std::vector<Row> mixed = diagonal(6000);
    for (Row& row : mixed) row.u = row.v = row.sample % 2 == 0 ? 0 : ~0u;
    for (Row& row : mixed) row.sample += 1 << 13;
    const fs::path file = write_file({write_run(job_, Coverage(SampleRange{0, 1 << 13}), {{.rows = diagonal(100)}}),
                                      write_run(job_, Coverage(SampleRange{1 << 13, 1 << 14}), {{.rows = mixed}})});
    EXPECT_EQ(inspect({"verify", "--deep", file}).status, 0);
    const Outcome developed = run({tool("latent-develop"), file, "--size", "1000", "-o", folder_ / "a.exr"});
    EXPECT_EQ(developed.status, 3) << developed.err;
    EXPECT_NE(developed.err.find("its records are not in order; samples 8192:16384 lost"), std::string::npos) << developed.err;
    EXPECT_NE(developed.out.find("100 camera"), std::string::npos) << developed.out;
}

TEST_F(Strict, TheOrderGoesOnFromPageToPageOfAClass) {
    std::vector<Row> rows = diagonal(6200);
    for (Row& row : rows) row.u = row.v = 0;
    const std::vector<Row> first(rows.begin(), rows.begin() + 6144), second(rows.begin() + 6144, rows.end());
    const TestPage light{.record_class = RecordClass::kLight, .rows = diagonal(3)};
    EXPECT_EQ(violations_of(write_pages({{.rows = first}, {.rows = second}, light})).count(), 0u);
    std::vector<Row> exchanged = rows;
    std::swap(exchanged[6143].sample, exchanged[6144].sample);
    expect_one(write_pages({{.rows = {exchanged.begin(), exchanged.begin() + 6144}},
                            {.rows = {exchanged.begin() + 6144, exchanged.end()}}}),
               {.run = 0, .page = 1, .record = 0, .what = "sample 6143", .wanted = "sample 6144"});
}

TEST_F(Strict, PagesThatAreCutElsewhereAreNamed) {
    // Eight records, two in each quarter of the film.
    std::vector<Row> rows;
    for (std::uint32_t i = 0; i < 8; ++i) rows.push_back({i, (i / 2 & 1) << 31 | i, i / 4 << 31});
    expect_one(write_pages({{.rows = {rows.begin(), rows.begin() + 4}}, {.rows = {rows.begin() + 4, rows.end()}}}),
               {.run = 0, .page = 0, .what = "ends after 4 records", .wanted = "8 records, those of the largest node"});
    // More than fit a page: 3000 in the upper half, 3200 in the lower.
    rows.clear();
    for (std::uint32_t i = 0; i < 6200; ++i) rows.push_back({i, i << 8, i < 3000 ? 0 : 1u << 31});
    EXPECT_EQ(
        violations_of(write_pages({{.rows = {rows.begin(), rows.begin() + 3000}}, {.rows = {rows.begin() + 3000, rows.end()}}}))
            .count(),
        0u);
    const Violations found =
        violations_of(write_pages({{.rows = {rows.begin(), rows.begin() + 6144}}, {.rows = {rows.begin() + 6144, rows.end()}}}));
    ASSERT_GE(found.count(), 1u);
    EXPECT_EQ(found.listed()[0].what, "ends after 6144 records");
    EXPECT_EQ(found.listed()[0].wanted.substr(0, 13), "3000 records,");
    // More than fit one Z prefix.
    for (Row& row : rows) row.u = row.v = 0;
    expect_one(write_pages({{.rows = {rows.begin(), rows.begin() + 100}}, {.rows = {rows.begin() + 100, rows.end()}}}),
               {.run = 0, .page = 0, .what = "ends after 100 records", .wanted = "6144 records, "});
}

TEST_F(Strict, ASquareThatIsNotTheSmallestIsNamed) {
    expect_one(write_pages({{.rows = {{.sample = 0, .u = 1u << 31, .v = 3u << 30}}, .square = FilmNode{1, 1, 1}}}),
               {.run = 0, .page = 0, .what = "its entry names the square 1 (1, 1)", .wanted = "16 (32768, 49152), the smallest"});
}

TEST_F(Strict, FieldsWithoutMeaningAreZero) {
    expect_one_in_page([](Columns& c) { c[1].bits = 3; }, "column u: bits is 3", "0, unless the transform is 1, 2 or 8 to 12");
    expect_one_in_page([](Columns& c) { c[5].base = 0xabc; }, "column y: base is 0xabc", "0, unless");
    expect_one_in_page(
        [](Columns& c) {
            c[3].transform = Transform::kPacked;
            c[3].planes.clear();
            c[3].base = 0x1'3F800000;
        },
        "column share: base is 0x13f800000", "zero above its 4 low bytes");
}

// Those transforms shift values by the bits that the precision leaves out.
TEST_F(Strict, BitsOfATransformAreThoseOfThePrecision) {
    const auto stepped = [](std::uint8_t bits) {
        return [bits](Columns& c) { c[4].transform = Transform::kSteppedCross, c[4].bits = bits; };
    };
    std::vector<Row> rows = diagonal(10);
    for (Row& row : rows) row.y = 0;
    for (const auto& [precision, bits, mistakes] : {std::tuple{9, 14, 0u}, {9, 13, 1u}, {23, 5, 1u}}) {
        SCOPED_TRACE(precision);
        job_.precision = static_cast<std::uint8_t>(precision);
        TestPage page{.rows = rows};
        page.spoil = stepped(static_cast<std::uint8_t>(bits));
        const Violations found = violations_of(write_pages({page}));
        ASSERT_EQ(found.count(), mistakes);
        if (mistakes == 0) continue;
        EXPECT_NE(found.listed().front().what.find("column x: transform 8 with"), std::string::npos) << found.listed().front().what;
    }
}

TEST_F(Strict, PaddingIsZero) {
    const auto packed = [](std::byte last) {
        return [last](Columns& c) {
            c[0].bits = 4;  // 0 .. 9
            c[0].planes = {
                {PlaneCodec::kRaw, {std::byte{0x10}, std::byte{0x32}, std::byte{0x54}, std::byte{0x76}, std::byte{0x98}}}};
            if (last == std::byte{0}) return;
            c[0].bits = 5;
            Bytes plane(7);  // 50 bits
            for (unsigned i = 0; i < 10; ++i) {
                const unsigned at = 5 * i, value = i << at % 8;
                plane[at / 8] |= static_cast<std::byte>(value);
                if (value > 255) plane[at / 8 + 1] |= static_cast<std::byte>(value >> 8);
            }
            plane.back() |= last;
            c[0].planes = {{PlaneCodec::kRaw, plane}};
        };
    };
    EXPECT_EQ(violations_of(write_pages({{.rows = diagonal(10), .spoil = packed(std::byte{0})}})).count(), 0u);
    expect_one_in_page(packed(std::byte{0x80}), "column sample, plane 0: padding bits after the last number are set", "zero");
}

TEST_F(Strict, WhatADictionaryDoesNotUseIsZero) {
    // Every y is 0.5f, so its highest byte is 0x3f everywhere: number 0 of a dictionary of two.
    const auto dictionary = [](std::byte unused, std::byte padding) {
        return [=](Columns& c) {
            c[5].planes[3] = {PlaneCodec::kDictionary, {std::byte{1}, std::byte{0x3f}, unused, std::byte{0}, padding}};
        };
    };
    EXPECT_EQ(violations_of(write_pages({{.rows = diagonal(10), .spoil = dictionary(std::byte{0}, std::byte{0})}})).count(), 0u);
    expect_one_in_page(dictionary(std::byte{0x40}, std::byte{0}), "column y, plane 3: byte 1 of its dictionary is 0x40", "0");
    expect_one_in_page(dictionary(std::byte{0}, std::byte{0x80}), "column y, plane 3: padding bits", "zero");
}

TEST_F(Strict, AZstdFrameKeepsToTheWindowAllowed) {
    const auto frame = [](unsigned window_log) {
        return [window_log](Columns& c) {
            Bytes stored;
            ByteWriter out(stored);
            out.put(std::uint32_t{0xFD2FB528});
            out.put(std::uint8_t{0});  // neither a size nor a checksum
            out.put(static_cast<std::uint8_t>((window_log - 10) << 3));
            const Bytes plane = c[4].planes[3].bytes;
            const auto block = static_cast<std::uint32_t>(plane.size() << 3 | 1);  // raw, the last
            for (const unsigned shift : {0u, 8u, 16u}) out.put(static_cast<std::uint8_t>(block >> shift));
            out.put(plane);
            c[4].planes[3] = {PlaneCodec::kZstd, stored};
        };
    };
    EXPECT_EQ(violations_of(write_pages({{.rows = diagonal(10), .spoil = frame(23)}})).count(), 0u);
    expect_one_in_page(frame(24), "column x, plane 3: its zstd frame needs a window", "2^23 at most");
}

TEST_F(Strict, PositionsAreLeftOutOfCameraPagesOnly) {
    const auto leave_out = [](Columns& c) {
        for (const std::size_t i : {1, 2}) {
            c[i].transform = Transform::kSampler;
            c[i].planes.clear();
        }
    };
    std::vector<Row> rows;
    for (std::uint64_t n = 0; n < 10; ++n) {
        const FilmPosition at = halton23(n, job_.positions);
        rows.push_back({n, at.u, at.v});
    }
    std::ranges::sort(rows, {}, [](const Row& row) { return z_prefix(row.u, row.v); });
    EXPECT_EQ(violations_of(write_pages({{.rows = rows, .spoil = leave_out}})).count(), 0u);
    const Violations found = violations_of(write_pages({{.record_class = RecordClass::kLight, .rows = rows, .spoil = leave_out}}));
    ASSERT_EQ(found.count(), 2u);
    EXPECT_EQ(found.listed()[0].what, "column u: positions are left out of a light page");
    EXPECT_EQ(found.listed()[1].what, "column v: positions are left out of a light page");
}

TEST_F(Strict, AColumnWithoutValuesHasNoPlanes) {
    job_ = synthetic::make_short_job(RecordKind::kSpectral);
    expect_one_in_page(
        [](Columns& c) {
            c[7].planes.assign(4, {PlaneCodec::kRaw, {}});
        },
        "column power: has no values, but transform 0 and 4 planes", "transform 0 and no planes");
}

TEST_F(Strict, SharesOfASampleAddUpToOne) {
    const auto shares = [&](std::vector<std::pair<std::uint64_t, float>> list) {
        std::vector<Row> rows = diagonal(static_cast<std::uint32_t>(list.size()));
        for (std::size_t i = 0; i < list.size(); ++i) rows[i].sample = list[i].first, rows[i].share = list[i].second;
        return write_pages({{.rows = rows}});
    };
    EXPECT_EQ(violations_of(shares({{5, 1}, {6, 1}, {7, 1}})).count(), 0u);
    EXPECT_EQ(violations_of(shares({{5, 1}, {5, 0}, {7, 0}, {7, 1}})).count(), 0u);
    EXPECT_EQ(violations_of(shares({{5, 0.25f}, {6, 1}, {5, 0.75f}})).count(), 0u);
    EXPECT_EQ(violations_of(shares({{5, 1 / 3.0f}, {5, 1 / 3.0f}, {5, 1 / 3.0f}})).count(), 0u);
    expect_one(shares({{5, 1}, {6, 1}, {5, 1}}), {.run = 0, .what = "the shares of sample 5 add up to 2", .wanted = "1"});
    expect_one(shares({{5, 1}, {6, 0}}), {.run = 0, .what = "the shares of sample 6 add up to 0", .wanted = "1"});
    expect_one(shares({{5, 0.5f}, {6, 1}}), {.run = 0, .what = "the shares of sample 5 add up to 0.5", .wanted = "1"});
    expect_one(shares({{9, NAN}, {6, 1}}), {.run = 0, .what = "the shares of sample 9 add up to nan", .wanted = "1"});
}

TEST_F(Strict, SharesAreAddedUpHoweverManySamplesARunCovers) {
    const std::uint64_t far = (std::uint64_t{1} << 25) + 5;
    const auto file = [&](std::vector<std::uint64_t> samples) {
        std::vector<Row> rows = diagonal(static_cast<std::uint32_t>(samples.size()));
        for (std::size_t i = 0; i < samples.size(); ++i) rows[i].sample = samples[i];
        Coverage coverage(SampleRange{0, 4096});
        coverage.add(SampleRange{8192, 3 * far});
        return write_file({write_run(job_, coverage, {{.rows = rows}})});
    };
    EXPECT_EQ(violations_of(file({5, far, 2 * far})).count(), 0u);
    expect_one(file({5, far, 3 * far - 1, far}),
               {.run = 0, .what = fmt::format("the shares of sample {} add up to 2", far), .wanted = "1"});
    expect_one(file({5, far, 3 * far - 1, 3 * far - 1}),
               {.run = 0, .what = fmt::format("the shares of sample {} add up to 2", 3 * far - 1), .wanted = "1"});
}

TEST_F(Strict, ValuesHaveNoMoreBitsThanTheJob) {
    std::vector<Row> rows = diagonal(10);
    job_.precision = 9;
    rows[3].y = std::numeric_limits<float>::max();  // has no neighbour above
    EXPECT_EQ(violations_of(write_pages({{.rows = rows}})).count(), 0u);
    rows[5].y = 1 + 0x1p-10f;  // x, y and z
    const Violations found = violations_of(write_pages({{.rows = rows}}));
    ASSERT_EQ(found.count(), 3u);
    EXPECT_EQ(found.listed().front().what, "column x: value 5 has the bits 3f802000");
    EXPECT_EQ(found.listed().front().wanted, "9 bits of mantissa");
    job_.precision = 10;
    EXPECT_EQ(violations_of(write_pages({{.rows = rows}})).count(), 0u);
}

TEST_F(Strict, RunsThatOthersWouldNotCutSoAreNotedAndNoMistake) {
    const auto notes = [&](SampleRange samples) {
        std::vector<Row> rows = diagonal(10);
        for (Row& row : rows) row.sample += samples.first;
        const fs::path file = write_file({write_run(job_, Coverage(samples), {{.rows = rows}})});
        EXPECT_EQ(violations_of(file).count(), 0u);
        return verify(file, VerifyLevel::kFull, true, 1)->notes;
    };
    EXPECT_TRUE(notes({4096, 8192}).empty());
    EXPECT_TRUE(notes({4096, 6000}).empty());
    EXPECT_TRUE(notes({4096, 16384}).empty());
    ASSERT_EQ(notes({4000, 8192}).size(), 1u);
    EXPECT_NE(notes({4000, 8192})[0].find("run 0, samples 4000:8192, does not begin at a multiple of 1024 samples"),
              std::string::npos);
    ASSERT_EQ(notes({5120, 9216}).size(), 1u);
    EXPECT_NE(notes({5120, 9216})[0].find("crosses a multiple of S = 4096"), std::string::npos);
    job_.run_bytes = 1 << 16;
    std::vector<Row> rows = diagonal(3000);
    const fs::path file = write_file({write_run(job_, Coverage(SampleRange{0, 4096}), {{.rows = rows}})});
    const std::vector<std::string> large = verify(file, VerifyLevel::kFull, true, 1)->notes;
    ASSERT_EQ(large.size(), 1u);
    EXPECT_NE(large[0].find("holds 99000 raw bytes, more than R = 65536"), std::string::npos) << large[0];
}

TEST_F(Strict, RunsOfTheSameSamplesHaveTheSameRecords) {
    std::vector<Row> other = diagonal(10);
    other[3].y = 0.75f;
    const Coverage coverage(SampleRange{0, 1 << 13});
    const Bytes a = write_run(job_, coverage, {{.rows = diagonal(10)}}), b = write_run(job_, coverage, {{.rows = other}});
    EXPECT_EQ(violations_of(write_file({a, a})).count(), 0u);
    expect_one(write_file({a, b}),
               {.run = 1, .what = "its records of samples 0:8192 differ from those in run 0", .wanted = "the same records"});
}

TEST_F(Strict, TheHeaderIsAsThePageSays) {
    const Bytes run = write_run(job_, Coverage(SampleRange{0, 1 << 13}), {{.rows = diagonal(10)}});
    const auto reserved = [](Bytes& file) {
        for (const std::size_t copy : {std::size_t{0}, file.size() / 2}) {
            file[copy + 44] = std::byte{1};
            store_le(file.data() + copy + 56, hash64(ByteSpan(file).subspan(copy, 56)));
        }
    };
    expect_one(write_file({run}, "", reserved), {.what = "reserved bytes of the header are not zero", .wanted = "bytes 40..55"});
    expect_one(write_file({run}, "[]"), {.what = "the provenance in the header is not a JSON object", .wanted = "32 deep"});
    EXPECT_EQ(violations_of(write_file({run}, R"({"by":"a test"})")).count(), 0u);
    job_.extra = {{"\xff", ColumnType::kU8}};
    expect_one(write_file({}), {.what = R"(the column '\xff' has a name that is not UTF-8)", .wanted = "UTF-8"});
}

TEST_F(Strict, TheToolListsViolationsAndEndsWithFour) {
    std::vector<Row> rows = diagonal(100);
    std::swap(rows[41], rows[42]);
    const fs::path file = write_pages({{.rows = rows, .square = FilmNode{}}});
    EXPECT_EQ(inspect({"verify", "--deep", file}).status, 0);
    const Outcome text = inspect({"verify", "--strict", file});
    EXPECT_EQ(text.status, 4);
    EXPECT_NE(text.out.find("a.latent: run 0, page 0: its entry names the square 0 (0, 0); expected: "), std::string::npos)
        << text.out;
    EXPECT_NE(text.out.find("a.latent: run 0, page 0, record 42: Z prefix "), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("a.latent: readable, but VIOLATES THE FORMAT: 1 run"), std::string::npos) << text.out;
    const nlohmann::json report = nlohmann::json::parse(inspect({"verify", "--strict", "--json", file}).out);
    EXPECT_EQ(report["sound"], true);
    EXPECT_EQ(report["violation_count"], 2);
    EXPECT_EQ(report["violations"][1]["record"], 42);
    EXPECT_EQ(inspect({"verify", "--strict", "--quick", file}).status, 2);
}

TEST_F(Strict, AMistakeInEveryRecordIsListedAThousandTimesAndCounted) {
    std::vector<Row> rows = diagonal(6000);
    for (Row& row : rows) row.u = row.v = 0;
    std::ranges::reverse(rows);
    const Violations found = violations_of(write_pages({{.rows = rows}}));
    EXPECT_EQ(found.count(), 5999u);
    EXPECT_EQ(found.listed().size(), Violations::kMaxListed);
    EXPECT_NE(inspect({"verify", "--strict", folder_ / "a.latent"}).out.find("4999 more violations"), std::string::npos);
}

}  // namespace
}  // namespace latent::inspect
