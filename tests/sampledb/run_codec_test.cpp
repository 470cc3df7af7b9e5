// Records survive a run bit for bit, and a run is a function of its records alone.
#include "sampledb/codec/run_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/data/film_region.h"
#include "sampledb/data/z_order.h"
#include "sampledb/format/frames.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::make_job;
using synthetic::make_records;
using synthetic::pixels_of;
using synthetic::Scene;

// Every value of every column, floats as their bits.
std::vector<std::uint64_t> bits_of(const Records& r) {
    std::vector<std::uint64_t> bits;
    const auto add = [&bits](const auto& column) {
        bits.push_back(column.size());
        for (const auto value : column) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, float>) {
                bits.push_back(std::bit_cast<std::uint32_t>(value));
            } else {
                bits.push_back(static_cast<std::uint64_t>(value));
            }
        }
    };
    add(r.sample), add(r.record_class), add(r.u), add(r.v), add(r.share), add(r.x), add(r.y), add(r.z);
    add(r.pairs), add(r.xi), add(r.index), add(r.power), add(r.lambda_nm);
    for (const ExtraColumn& column : r.extra) {
        add(column.name);
        add(std::vector<std::uint8_t>{static_cast<std::uint8_t>(column.type)});
        add(column.values);
    }
    return bits;
}

std::vector<std::size_t> pair_offsets(const Records& r) {
    std::vector<std::size_t> first(r.pairs.size() + 1);
    std::exclusive_scan(r.pairs.begin(), r.pairs.end(), first.begin(), std::size_t{0});
    if (!r.pairs.empty()) first.back() = r.power.size();
    return first;
}

// The rows of `r` in the order that a decoded run has: by sample, then class, then Z prefix, then as they came.
Records in_decoded_order(const Records& r) {
    std::vector<std::size_t> rows(r.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    std::ranges::stable_sort(rows, {},
                             [&](std::size_t i) { return std::tuple(r.sample[i], r.record_class[i], z_prefix(r.u[i], r.v[i])); });
    Records sorted = r.without_rows();
    const std::vector<std::size_t> first = pair_offsets(r);
    for (const std::size_t row : rows) sorted.append(r, row, r.pairs.empty() ? 0 : first[row]);
    return sorted;
}

Bytes encode(const Job& job, const Coverage& coverage, const Records& records) {
    const Result<Bytes> run = encode_run(job, coverage, records);
    if (!run) ADD_FAILURE() << run.error().message;
    return run.value_or(Bytes{});
}

void expect_round_trip(const Job& job, const Coverage& coverage, const Records& records) {
    const Bytes run = encode(job, coverage, records);
    EXPECT_EQ(run.size() % kBlock, 0u);
    const Result<DecodedRun> decoded = decode_run(job, run);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(decoded->coverage, coverage);
    EXPECT_TRUE(bits_of(decoded->records) == bits_of(in_decoded_order(records)));
    EXPECT_EQ(decoded->header.size(), run.size());
    EXPECT_EQ(decoded->header.camera_records + decoded->header.light_records, records.size());
}

std::vector<Job> jobs_of_each_form() {
    std::vector<Job> jobs;
    jobs.push_back(make_job(RecordKind::kXyz));
    jobs.push_back(make_job(RecordKind::kXyz));
    jobs.back().positions = pixels_of(48, 32);
    jobs.push_back(make_job(RecordKind::kXyz));
    jobs.back().positions = {};
    jobs.back().extra = {{"light_group", ColumnType::kU8}, {"material", ColumnType::kU16}, {"object", ColumnType::kU32},
                         {"path", ColumnType::kU64},       {"depth", ColumnType::kF32},    {"time", ColumnType::kF64}};
    for (const std::uint16_t k : {1, 4, 28, 1024}) {
        jobs.push_back(make_job(RecordKind::kSpectral));
        jobs.back().batch = k;
        jobs.push_back(jobs.back());
        jobs.back().density = {};  // explicit wavelengths
    }
    return jobs;
}

TEST(Run, EveryFormOfRecordSurvivesBitForBit) {
    for (const Job& job : jobs_of_each_form()) {
        const std::uint64_t samples = job.batch > 100 ? 300 : 9000;
        for (const bool split : {false, true}) {
            SCOPED_TRACE(::testing::Message()
                         << "kind " << int(job.kind) << " batch " << job.batch << " density " << !job.density.empty());
            const SampleRange range{1u << 14, (1u << 14) + samples};
            expect_round_trip(job, Coverage(range), make_records(job, range, {.light_per_sample = 0.3, .split_shares = split}));
        }
    }
}

TEST(Run, RunsOfNoneOneAndBlackRecordsSurvive) {
    for (const Job& job : jobs_of_each_form()) {
        const SampleRange range{0, 1024};
        Records none = make_records(job, {0, 0});
        expect_round_trip(job, Coverage(range), none);
        expect_round_trip(job, Coverage(range), make_records(job, {77, 78}, {.light_per_sample = 0}));
        expect_round_trip(job, Coverage(range), make_records(job, range, {.black = 1, .light_per_sample = 0}));
    }
}

TEST(Run, BlackRecordsAmongBrightOnesSurviveAndCostNextToNothing) {
    const Job job = make_job(RecordKind::kXyz);
    const SampleRange range{0, 20000};
    const std::size_t bright = encode(job, Coverage(range), make_records(job, range, {.black = 0, .light_per_sample = 0})).size();
    for (const double black : {0.03, 0.07, 0.5, 0.97}) {
        const Records records = make_records(job, range, {.black = black, .light_per_sample = 0});
        expect_round_trip(job, Coverage(range), records);
        Records stray = records;  // colours without luminance, and a luminance of -0
        stray.x[10000] = 1, stray.y[10000] = 0;
        stray.z[19999] = 1, stray.y[19999] = 0;
        stray.y[5] = -0.0f;
        expect_round_trip(job, Coverage(range), stray);
        if (black < 0.06) continue;
        // what is not x, y, z: two bytes of the sample number, and one bit that says black or not; tables and blocks are in the 2 %
        const double others = 2.125 * 20000, expected = others + (static_cast<double>(bright) - 2.0 * 20000) * (1 - black);
        EXPECT_LE(static_cast<double>(encode(job, Coverage(range), records).size()), expected + 0.02 * static_cast<double>(bright));
    }
}

TEST(Run, ForeignBitsSurvive) {
    const Job job = make_job(RecordKind::kXyz);
    Records records = make_records(job, {0, 500});
    std::mt19937 random(5);
    for (std::vector<float>* column : {&records.x, &records.y, &records.z}) {
        for (float& value : *column) value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));  // NaN payloads and all
        (*column)[3] = -0.0f;
        (*column)[4] = std::numeric_limits<float>::infinity();
        (*column)[5] = std::numeric_limits<float>::denorm_min();
        (*column)[6] = std::numeric_limits<float>::signaling_NaN();
    }
    expect_round_trip(job, Coverage(SampleRange{0, 500}), records);
}

TEST(Run, ExtremePositionsAndSampleNumbersSurvive) {
    Job job = make_job(RecordKind::kXyz);
    const std::uint64_t top = ~std::uint64_t{0};
    for (const PositionSamplerSpec& positions : {job.positions, pixels_of(48, 32), PositionSamplerSpec{}}) {
        job.positions = positions;
        for (const SampleRange range :
             {SampleRange{top - 3000, top}, SampleRange{(std::uint64_t{1} << 32) - 1500, (std::uint64_t{1} << 32) + 1500},
              SampleRange{std::uint64_t{1} << 63, (std::uint64_t{1} << 63) + 3000}}) {
            expect_round_trip(job, Coverage(range), make_records(job, range));
        }
        Records sparse = make_records(job, {0, 2});
        sparse.append(make_records(job, {top - 1, top}, {.light_per_sample = 0}), 0, 0);
        sparse.u[0] = sparse.v[0] = 0;
        sparse.u[1] = sparse.v[1] = ~0u;
        expect_round_trip(job, Coverage(SampleRange{0, top}), sparse);
    }
}

TEST(Run, CoverageWithGapsSurvives) {
    const Job job = make_job(RecordKind::kXyz);
    Coverage coverage(SampleRange{0, 1000});
    coverage.add({5000, 6000});
    Records records = make_records(job, {0, 1000});
    const Records more = make_records(job, {5000, 6000});
    for (std::size_t row = 0; row < more.size(); ++row) records.append(more, row, 0);
    expect_round_trip(job, coverage, records);
}

TEST(Run, BytesDoNotDependOnTheOrderOfGrains) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = make_job(kind);
        const Scene scene{.light_per_sample = 0.5, .split_shares = true};
        const Coverage coverage(SampleRange{0, 8192});
        const Bytes reference = encode(job, coverage, make_records(job, {0, 8192}, scene));
        Records shuffled;
        std::vector<std::uint64_t> grains(8);
        std::iota(grains.begin(), grains.end(), std::uint64_t{0});
        std::ranges::shuffle(grains, std::mt19937(3));
        for (const std::uint64_t grain : grains) {
            const Records records = make_records(job, {grain * 1024, grain * 1024 + 1024}, scene);
            const std::vector<std::size_t> first = pair_offsets(records);
            for (std::size_t row = 0; row < records.size(); ++row)
                shuffled.append(records, row, records.pairs.empty() ? 0 : first[row]);
        }
        EXPECT_TRUE(encode(job, coverage, shuffled) == reference);
    }
}

TEST(Run, AResumedRunIsTheRunThatWasNeverInterrupted) {
    // Many records of one sample on one spot: only their order of emission tells them apart.
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = make_job(kind);
        Records whole = make_records(job, {0, 3000}, {.light_per_sample = 4});
        for (std::size_t row = 0; row < whole.size(); row += 3) whole.u[row] = whole.v[row] = 1u << 31;
        const std::vector<std::size_t> first = pair_offsets(whole);
        Records checkpoint, rest;
        for (std::size_t row = 0; row < whole.size(); ++row) {
            (whole.sample[row] < 2048 ? checkpoint : rest).append(whole, row, whole.pairs.empty() ? 0 : first[row]);
        }
        const Result<DecodedRun> decoded = decode_run(job, encode(job, Coverage(SampleRange{0, 2048}), checkpoint));
        ASSERT_TRUE(decoded);
        Records resumed = decoded->records;
        const std::vector<std::size_t> rest_first = pair_offsets(rest);
        for (std::size_t row = 0; row < rest.size(); ++row) resumed.append(rest, row, rest.pairs.empty() ? 0 : rest_first[row]);
        const Coverage all(SampleRange{0, 3000});
        EXPECT_TRUE(encode(job, all, resumed) == encode(job, all, whole));
    }
}

TEST(Run, RecordsThatDoNotFitTheJobAreRefused) {
    const Job xyz = make_job(RecordKind::kXyz);
    const Job spectral = make_job(RecordKind::kSpectral);
    const Coverage coverage(SampleRange{0, 100});
    const auto refused = [&](const Job& job, auto change) {
        Records records = make_records(job, {0, 100});
        change(records);
        const Result<Bytes> run = encode_run(job, coverage, records);
        return !run && run.error().code == ErrorCode::kOutOfRange;
    };
    EXPECT_FALSE(refused(xyz, [](Records&) {}));
    EXPECT_FALSE(refused(spectral, [](Records&) {}));
    EXPECT_TRUE(refused(xyz, [](Records& r) { r.sample.back() = 100; }));
    EXPECT_TRUE(refused(xyz, [](Records& r) { r.z.pop_back(); }));
    EXPECT_TRUE(refused(xyz, [](Records& r) { r.record_class[0] = RecordClass::kLight; }));  // with a share
    EXPECT_TRUE(refused(spectral, [](Records& r) { r.power.pop_back(); }));
    EXPECT_TRUE(refused(spectral, [](Records& r) { r.index[0] = 3; }));
    EXPECT_FALSE(encode_run(xyz, Coverage(), Records{}));
}

TEST(Run, DerivedPositionsAreLeftOutAndExplicitOnesKept) {
    const Job derived = make_job(RecordKind::kXyz);
    Job explicit_job = derived;
    explicit_job.positions = {};
    const SampleRange range{0, 1u << 16};
    const Coverage coverage(range);
    Records records = make_records(derived, range, {.light_per_sample = 0});
    const std::size_t without = encode(derived, coverage, records).size();
    const std::size_t with = encode(explicit_job, coverage, records).size();
    EXPECT_LT(static_cast<double>(without) + 4.5 * static_cast<double>(range.size()), static_cast<double>(with));
    records.u[40000] ^= 1;  // one record off the lattice costs its own page the saving, no other
    const std::size_t one_off = encode(derived, coverage, records).size();
    EXPECT_GT(one_off, without + 4 * 2000);
    EXPECT_LT(one_off, without + 8 * 6144 + 2 * kBlock);
    expect_round_trip(derived, coverage, records);
}

TEST(Run, AWrongGeneratorIsCaughtByTheContentHash) {
    const Job job = make_job(RecordKind::kXyz);
    const SampleRange range{0, 5000};
    const Bytes run = encode(job, Coverage(range), make_records(job, range));
    Job other = job;
    other.positions.shift_v += 1;
    const Result<DecodedRun> decoded = decode_run(other, run);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, ErrorCode::kCorrupt);
}

TEST(Pages, AreNodesOfTheFilmThatHoldAllTheirRecords) {
    Job job = make_job(RecordKind::kXyz);
    job.positions = {};
    std::mt19937 random(11);
    std::size_t upper = 0, lower = 0;
    for (const int spread : {0, 8, 20, 32}) {  // all on one spot, clustered, everywhere
        Records records = make_records(job, {0, 40000}, {.light_per_sample = 0});
        for (std::size_t i = 0; i < records.size() / 2; ++i) {
            const auto near = [&] {
                return 0x9ABCDEF0u ^ (spread == 0 ? 0u : static_cast<std::uint32_t>(random()) >> (32 - spread));
            };
            records.u[i] = near(), records.v[i] = near();
        }
        const Bytes run = encode(job, Coverage(SampleRange{0, 40000}), records);
        const RunHeader header = *decode_run_header(run);
        Result<RunIndex> index = decode_run_index(ByteSpan(run).subspan(header.index_offset()), header, job);
        ASSERT_TRUE(index);
        find_parts(index->pages);
        PageDecoder decoder;
        Page page;
        std::uint32_t last_z = 0;
        for (const PageInfo& info : index->pages) {
            ASSERT_TRUE(decoder.decode(job, info, ByteSpan(run).subspan(info.offset, info.stored_size), ColumnSet{}, page, true));
            EXPECT_LE(page.count, max_page_records(job));
            for (std::size_t i = 0; i < page.count; ++i) {
                const int shift = 32 - info.node.level;
                ASSERT_TRUE(info.node.level == 0 || (page.u[i] >> shift == info.node.x && page.v[i] >> shift == info.node.y));
                ASSERT_LE(last_z, z_prefix(page.u[i], page.v[i]));
                last_z = z_prefix(page.u[i], page.v[i]);
                if (info.part == NodePart::kAnywhere) continue;
                ASSERT_EQ(page.v[i] >> (shift - 1) & 1, info.part == NodePart::kUpper ? 0u : 1u);
            }
            upper += info.part == NodePart::kUpper;
            lower += info.part == NodePart::kLower;
        }
    }
    EXPECT_GT(upper, 3u);
    EXPECT_GT(lower, 3u);
}

TEST(Pages, OfOneHalfDoNotTouchRegionsInTheOther) {
    const FilmNode node{2, 1, 2};  // u in [1/4, 1/2), v in [1/2, 3/4)
    const FilmRegion above = *FilmRegion::from({0.3, 0.4, 0.4, 0.625}), below = *FilmRegion::from({0.3, 0.625, 0.4, 0.9});
    EXPECT_TRUE(above.touches(node) && above.touches(node, NodePart::kUpper) && !above.touches(node, NodePart::kLower));
    EXPECT_TRUE(below.touches(node) && !below.touches(node, NodePart::kUpper) && below.touches(node, NodePart::kLower));
}

TEST(Pages, ColumnsThatAreNotWantedStayEmptyAndTheOthersAreTheSame) {
    const SampleRange range{0, 1024};
    for (const Job& job : jobs_of_each_form()) {
        const Bytes run = encode(job, Coverage(range), make_records(job, range, {.split_shares = true}));
        const RunHeader header = *decode_run_header(run);
        const Result<RunIndex> index = decode_run_index(ByteSpan(run).subspan(header.index_offset()), header, job);
        ASSERT_TRUE(index);
        PageDecoder decoder;
        Page all, some;
        for (const PageInfo& info : index->pages) {
            const ByteSpan stored = ByteSpan(run).subspan(info.offset, info.stored_size);
            ASSERT_TRUE(decoder.decode(job, info, stored, ColumnSet{}, all));
            for (unsigned wanted = 0; wanted < 64; ++wanted) {
                ExtraSet extra = (wanted & 16) != 0 ? kAllExtra : ExtraSet();
                extra.set(0, (wanted & 32) != 0);
                const ColumnSet columns{.samples = (wanted & 1) != 0,
                                        .positions = (wanted & 2) != 0,
                                        .values = (wanted & 4) != 0,
                                        .share = (wanted & 8) != 0,
                                        .extra = extra};
                ASSERT_TRUE(decoder.decode(job, info, stored, columns, some));
                const auto expect = [&](bool is_wanted, const auto& column, const auto& of_all, std::size_t count) {
                    const std::size_t expected = is_wanted && !of_all.empty() ? count : 0;
                    ASSERT_TRUE(expected == 0 ? column.empty() : column.size() >= count);
                    if (expected == 0) return;
                    EXPECT_EQ(std::memcmp(column.data(), of_all.data(), expected * sizeof(column[0])), 0);
                };
                const auto rows = [&](bool is_wanted, const auto& column, const auto& of_all) {
                    expect(is_wanted, column, of_all, info.record_count);
                };
                rows(columns.samples, some.sample, all.sample);
                rows(columns.positions, some.u, all.u), rows(columns.positions, some.v, all.v);
                rows(columns.share, some.share, all.share);
                rows(columns.values, some.x, all.x), rows(columns.values, some.y, all.y), rows(columns.values, some.z, all.z);
                rows(columns.values, some.pairs, all.pairs), rows(columns.values, some.first_pair, all.first_pair);
                rows(columns.values, some.xi, all.xi), rows(columns.values, some.index, all.index);
                expect(columns.values, some.power, all.power, info.pair_count);
                expect(columns.values, some.lambda_nm, all.lambda_nm, info.pair_count);
                ASSERT_EQ(some.extra.size(), job.extra.size());
                for (std::size_t i = 0; i < job.extra.size(); ++i) {
                    expect(columns.extra[i], some.extra[i].values, all.extra[i].values,
                           info.record_count * width(job.extra[i].type));
                }
            }
        }
    }
}

TEST(Pages, AreCutAtTheLargestNodesThatFit) {
    // A page's node of the binary tree holds at most `most` records, its parent more; siblings come out whole.
    std::vector<std::uint32_t> z;
    std::mt19937 random(2);
    for (int i = 0; i < 20000; ++i) z.push_back(static_cast<std::uint32_t>(random()) >> (i % 3 == 0 ? 12 : 0));
    z.insert(z.end(), 1000, 0x80000000u);  // more on one spot than fit
    std::ranges::sort(z);
    const std::size_t most = 300;
    const auto count_under = [&](std::uint32_t value, int bits) {
        const std::uint32_t inside = bits == 0 ? ~0u : bits == 32 ? 0 : ~0u >> bits;
        return std::ranges::upper_bound(z, value | inside) - std::ranges::lower_bound(z, value & ~inside);
    };
    for (std::size_t begin = 0; begin < z.size();) {
        const std::size_t end = page_end(z, begin, most);
        ASSERT_GT(end, begin);
        ASSERT_LE(end - begin, most);
        const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(end - begin);
        bool is_node = false, parent_is_too_large = true;
        for (int bits = 32; bits >= 0 && !is_node; --bits) {
            if (count_under(z[begin], bits) != count) continue;
            is_node = true;
            int parent = bits;
            while (parent > 0 && count_under(z[begin], parent) == count) --parent;
            parent_is_too_large = count_under(z[begin], parent) > static_cast<std::ptrdiff_t>(most);
        }
        EXPECT_TRUE(is_node ? parent_is_too_large : z[begin] == 0x80000000u);
        begin = end;
    }
}

}  // namespace
}  // namespace latent::sampledb
