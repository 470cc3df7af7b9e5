// Rounded values are right in the mean, and a function of job, sample, position and index alone.
#include "sampledb/codec/rounding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "sampledb/codec/run_codec.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/frames.h"
#include "tests/support/synthetic.h"

namespace latent::sampledb {
namespace {

using synthetic::make_job;
using synthetic::make_records;

Job rounding_job(std::uint8_t precision, RecordKind kind = RecordKind::kXyz) {
    Job job = make_job(kind);
    job.precision = precision;
    return job;
}

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

// One value, by the page that holds nothing else.
float round_one(float value, std::uint8_t precision, std::uint64_t sample = 7, std::uint32_t u = 1, std::uint32_t v = 2) {
    Page page;
    page.count = 1;
    page.sample = {sample};
    page.u = {u}, page.v = {v};
    page.x = page.y = page.z = {value};
    round_values(rounding_job(precision), page);
    return page.y[0];
}

// Errors in units of the step between neighbours, and the variance that they ought to have.
struct Errors {
    double sum = 0, variance = 0;

    void add(std::uint32_t before, std::uint32_t after, unsigned dropped) {
        const double step = std::exp2(dropped), cut = (before & ((1u << dropped) - 1)) / step;
        sum += (static_cast<double>(after & 0x7FFFFFFF) - static_cast<double>(before & 0x7FFFFFFF)) / step;
        variance += cut * (1 - cut);
    }
    double sigmas() const { return variance > 0 ? sum / std::sqrt(variance) : sum; }
};

// Ten million values in all; 4 standard errors for the sum of a precision (6e-5 that chance breaks it), 5 for each exponent.
TEST(Rounding, IsUnbiasedForValuesOfEverySignAndExponent) {
    constexpr std::size_t kRecords = 6144;
    std::mt19937_64 random(1);
    for (const std::uint8_t precision : {1, 7, 9, 11, 15, 22}) {
        SCOPED_TRACE(int{precision});
        const Job job = rounding_job(precision);
        const unsigned dropped = 23u - precision;
        Errors all;
        std::array<Errors, 256> by_exponent;
        std::array<Errors, 3> by_index;
        std::uint64_t sample = std::uint64_t{1} << 40;
        Page page;
        page.count = kRecords;
        for (int i = 0; i < 91; ++i) {
            for (std::vector<float>* column : {&page.x, &page.y, &page.z}) column->resize(kRecords);
            page.sample.resize(kRecords), page.u.resize(kRecords), page.v.resize(kRecords);
            for (std::size_t row = 0; row < kRecords; ++row) {
                page.sample[row] = sample++;
                const FilmPosition at = halton23(page.sample[row], job.positions);
                page.u[row] = at.u, page.v[row] = at.v;
                for (std::vector<float>* column : {&page.x, &page.y, &page.z})
                    (*column)[row] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
            }
            const Page before = page;
            round_values(job, page);
            std::size_t index = 0;
            for (const auto column : {&Page::x, &Page::y, &Page::z}) {
                for (std::size_t row = 0; row < kRecords; ++row) {
                    const std::uint32_t a = bits_of((before.*column)[row]), b = bits_of((page.*column)[row]);
                    ASSERT_EQ(a >> 31, b >> 31);
                    if (!std::isfinite((before.*column)[row])) {
                        ASSERT_EQ(a, b);
                        continue;
                    }
                    ASSERT_TRUE(std::isfinite((page.*column)[row]));
                    ASSERT_LT(std::max(a, b) - std::min(a, b), 1u << dropped);
                    if ((a & 0x7FFFFFFF) > 0x7F800000 - (1u << dropped)) continue;  // no neighbour above
                    all.add(a, b, dropped);
                    by_exponent[a >> 23 & 0xFF].add(a, b, dropped);
                    by_index[index].add(a, b, dropped);
                }
                ++index;
            }
        }
        EXPECT_LT(std::abs(all.sigmas()), 4);
        for (const Errors& errors : by_index) EXPECT_LT(std::abs(errors.sigmas()), 4);
        for (const Errors& errors : by_exponent) EXPECT_LT(std::abs(errors.sigmas()), 5);
    }
}

// The same for powers, whose random numbers belong to (record, pair): two million of a precision, by exponent and by pair.
TEST(Rounding, IsUnbiasedForPowersOfEveryPair) {
    constexpr std::size_t kRecords = 2520, kPairs = 28;
    std::mt19937_64 random(2);
    for (const std::uint8_t precision : {1, 9, 15, 22}) {
        SCOPED_TRACE(int{precision});
        const Job job = rounding_job(precision, RecordKind::kSpectral);
        ASSERT_EQ(job.batch, kPairs);
        const unsigned dropped = 23u - precision;
        Errors all;
        std::array<Errors, 256> by_exponent;
        std::array<Errors, kPairs> by_pair;
        std::uint64_t sample = 0;
        for (int i = 0; i < 36; ++i) {
            Page page;
            page.count = kRecords;
            for (std::size_t row = 0; row < kRecords; ++row) {
                page.sample.push_back(sample++);
                const FilmPosition at = halton23(page.sample[row], job.positions);
                page.u.push_back(at.u), page.v.push_back(at.v);
                page.pairs.push_back(row % 7 == 3 ? 1 : row % 11 == 5 ? 0 : kPairs);  // whole batches, single pairs, black
                for (std::size_t pair = 0; pair < page.pairs[row]; ++pair)
                    page.power.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0x7FFFFFFF));
            }
            const std::vector<float> before = page.power;
            round_values(job, page);
            std::size_t at = 0;
            for (std::size_t row = 0; row < kRecords; ++row) {
                for (std::size_t pair = 0; pair < page.pairs[row]; ++pair, ++at) {
                    const std::uint32_t a = bits_of(before[at]), b = bits_of(page.power[at]);
                    if (a > 0x7F800000 - (1u << dropped)) continue;  // no neighbour above, or no number
                    ASSERT_LT(std::max(a, b) - std::min(a, b), 1u << dropped);
                    all.add(a, b, dropped);
                    by_exponent[a >> 23].add(a, b, dropped);
                    by_pair[pair].add(a, b, dropped);
                }
            }
            ASSERT_EQ(at, before.size());
        }
        EXPECT_LT(std::abs(all.sigmas()), 4);
        for (const Errors& errors : by_pair) EXPECT_LT(std::abs(errors.sigmas()), 4.5);
        for (const Errors& errors : by_exponent) EXPECT_LT(std::abs(errors.sigmas()), 5);
    }
}

// As a light that is seen directly: every sample has one value. 4 standard errors for each.
TEST(Rounding, TheMeanOfEqualSamplesConvergesToTheirValue) {
    constexpr std::size_t kRecords = 4096;
    constexpr int kPages = 512;
    const Job job = rounding_job(9);
    constexpr unsigned dropped = 23 - 9;
    const std::array<float, 3> values = {1 / 3.0f, 17.0001f, 0.999999f};
    std::array<Errors, 3> errors;
    Page page;
    page.count = kRecords;
    for (int i = 0; i < kPages; ++i) {
        page.sample.resize(kRecords), page.u.resize(kRecords), page.v.resize(kRecords);
        for (std::size_t row = 0; row < kRecords; ++row) page.sample[row] = static_cast<std::uint64_t>(i) * kRecords + row;
        halton23(page.sample, job.positions, page.u, page.v);
        page.x.assign(kRecords, values[0]), page.y.assign(kRecords, values[1]), page.z.assign(kRecords, values[2]);
        round_values(job, page);
        for (std::size_t row = 0; row < kRecords; ++row) {
            errors[0].add(bits_of(values[0]), bits_of(page.x[row]), dropped);
            errors[1].add(bits_of(values[1]), bits_of(page.y[row]), dropped);
            errors[2].add(bits_of(values[2]), bits_of(page.z[row]), dropped);
        }
    }
    for (const Errors& e : errors) EXPECT_LT(std::abs(e.sigmas()), 4);
}

TEST(Rounding, OfWhatIsRoundedChangesNothing) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = rounding_job(9, kind);
        const Coverage coverage(SampleRange{0, 9000});
        const Bytes run = *encode_run(job, coverage, make_records(job, {0, 9000}, {.light_per_sample = 0.3}));
        const DecodedRun decoded = *decode_run(job, run);
        for (const std::vector<float>* column :
             {&decoded.records.x, &decoded.records.y, &decoded.records.z, &decoded.records.power})
            for (const float value : *column) ASSERT_EQ(bits_of(value) & 0x3FFF, 0u);
        EXPECT_TRUE(*encode_run(job, coverage, decoded.records) == run);
        Job other = job;  // other random numbers
        other.id.low ^= 1;
        const DecodedRun again = *decode_run(other, *encode_run(other, coverage, decoded.records));
        EXPECT_TRUE(again.records.x == decoded.records.x && again.records.power == decoded.records.power);
        EXPECT_EQ(again.header.content_hash, decoded.header.content_hash);
    }
}

TEST(Rounding, LeavesSignsZerosInfinitiesAndNaNAsTheyAre) {
    using Limits = std::numeric_limits<float>;
    for (const std::uint8_t precision : {1, 2, 9, 22, 23}) {
        for (const std::uint32_t bits :
             {0x00000000u, 0x80000000u, 0x7F800000u, 0xFF800000u, 0x7FC00000u, 0xFFC12345u, 0x7F800001u}) {
            for (std::uint64_t sample = 0; sample < 50; ++sample)
                EXPECT_EQ(bits_of(round_one(std::bit_cast<float>(bits), precision, sample)), bits);
        }
        for (std::uint64_t sample = 0; sample < 50; ++sample) {
            EXPECT_EQ(round_one(Limits::max(), precision, sample), Limits::max());
            EXPECT_EQ(round_one(-Limits::max(), precision, sample), -Limits::max());
            const float step = std::ldexp(1.0f, 23 - precision - 149);  // between subnormal numbers
            const float least = round_one(-Limits::denorm_min(), precision, sample);
            EXPECT_TRUE(bits_of(least) == 0x80000000 || least == -step);
        }
    }
    const float last = std::bit_cast<float>(0x7F7FC000u), before = std::bit_cast<float>(0x7F7F8000u);  // with 9 bits
    std::array<int, 2> seen{};
    for (std::uint64_t sample = 0; sample < 50; ++sample) {
        const float rounded = round_one(std::bit_cast<float>(0x7F7FA000u), 9, sample);
        EXPECT_TRUE(rounded == last || rounded == before);
        ++seen[rounded == last];
        EXPECT_EQ(round_one(std::bit_cast<float>(0x7F7FC001u), 9, sample), std::bit_cast<float>(0x7F7FC001u));
    }
    EXPECT_GT(seen[0], 0);
    EXPECT_GT(seen[1], 0);
}

TEST(Rounding, RecordsOfASampleHaveRandomNumbersOfTheirOwn) {
    std::array<int, 4> differ{};
    for (std::uint64_t sample = 0; sample < 1000; ++sample) {
        const float value = 1 + 1.5f * 0x1p-9f;  // just between two neighbours
        const float here = round_one(value, 9, sample, 5, 6);
        differ[0] += here != round_one(value, 9, sample, 6, 6);
        differ[1] += here != round_one(value, 9, sample, 5, 7);
        differ[2] += here != round_one(value, 9, sample + 1000, 5, 6);
        Page page;
        page.count = 1;
        page.sample = {sample}, page.u = {5}, page.v = {6};
        page.x = page.y = page.z = {value};
        round_values(rounding_job(9), page);
        differ[3] += page.x[0] != page.z[0];
    }
    for (const int count : differ) EXPECT_NEAR(count, 500, 4 * std::sqrt(250));
}

TEST(Rounding, GrainsTheirOrderAndTheBoundariesOfRunsHaveNoSay) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = rounding_job(7, kind);
        const synthetic::Scene scene{.light_per_sample = 0.5, .split_shares = true};
        const auto piece = [&](std::uint64_t first, std::uint64_t end) {
            return std::make_shared<const Records>(make_records(job, {first, end}, scene));
        };
        const Coverage all(SampleRange{0, 4096});
        const DecodedRun whole = *decode_run(job, *encode_run(job, all, *piece(0, 4096)));
        EXPECT_EQ(decode_run(job, *RunBuilder().build(job, all, {piece(0, 1000), piece(1000, 1001), piece(1001, 4096)}))
                      ->header.content_hash,
                  whole.header.content_hash);
        Records together;
        for (const SampleRange range : {SampleRange{0, 1024}, {1024, 4096}}) {
            const DecodedRun part = *decode_run(job, *encode_run(job, Coverage(range), *piece(range.first, range.end)));
            std::size_t first_pair = 0;
            for (std::size_t row = 0; row < part.records.size(); ++row) {
                together.append(part.records, row, first_pair);
                if (kind == RecordKind::kSpectral) first_pair += part.records.pairs[row];
            }
        }
        EXPECT_TRUE(together.x == whole.records.x && together.y == whole.records.y && together.z == whole.records.z);
        EXPECT_TRUE(together.power == whole.records.power);
        EXPECT_TRUE(together.sample == whole.records.sample);
    }
}

TEST(Rounding, TakesNothingAwayFromWhatIsNoValue) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        Job exact = make_job(kind);
        exact.density = {};
        exact.extra = {{"depth", ColumnType::kF32}};
        Job job = exact;
        job.precision = 7;
        const Coverage coverage(SampleRange{0, 3000});
        const Records records = make_records(exact, {0, 3000}, {.light_per_sample = 0.3, .split_shares = true});
        const Records a = decode_run(exact, *encode_run(exact, coverage, records))->records;
        const Records b = decode_run(job, *encode_run(job, coverage, records))->records;
        EXPECT_TRUE(a.sample == b.sample && a.u == b.u && a.v == b.v && a.share == b.share && a.pairs == b.pairs);
        EXPECT_TRUE(a.lambda_nm == b.lambda_nm && a.extra[0].values == b.extra[0].values);
        EXPECT_FALSE(a.x == b.x && a.power == b.power);
    }
}

// Differences are counted in steps where all of them fit, else as they are.
TEST(Rounding, ValuesWithMoreBitsThanTheJobAreStoredBesideRoundedOnes) {
    for (const RecordKind kind : {RecordKind::kXyz, RecordKind::kSpectral}) {
        const Job job = rounding_job(9, kind);
        const Coverage coverage(SampleRange{0, 5000});
        Records records = make_records(job, {0, 5000}, {.black = 0.5});
        const Bytes plain = *encode_run(job, coverage, records);
        for (std::vector<float>* column : {&records.x, &records.y, &records.z, &records.power}) {
            if (column->empty()) continue;
            (*column)[1000] = std::bit_cast<float>(0xFFC12345u);
            (*column)[2000] = std::numeric_limits<float>::max();
            (*column)[2001] = std::numeric_limits<float>::infinity();
        }
        const Bytes run = *encode_run(job, coverage, records);
        EXPECT_GT(decode_run_header(run)->pages_size, decode_run_header(plain)->pages_size);
        const DecodedRun decoded = *decode_run(job, run);
        const auto count = [&](std::uint32_t bits) {
            std::size_t found = 0;
            for (const auto* column : {&decoded.records.x, &decoded.records.y, &decoded.records.z, &decoded.records.power})
                found += static_cast<std::size_t>(std::ranges::count(*column, bits, bits_of));
            return found;
        };
        const std::size_t columns = kind == RecordKind::kXyz ? 3 : 1;
        EXPECT_EQ(count(0xFFC12345), columns);
        EXPECT_EQ(count(0x7F7FFFFF), columns);
        EXPECT_EQ(count(0x7F800000), columns);
    }
}

TEST(Rounding, HeadersSayWhatOlderReadersWouldGetWrong) {
    const auto word_at = [](const Bytes& header, std::size_t at) { return load_le<std::uint64_t>(&header[at]); };
    const Bytes exact = *encode_file_header({rounding_job(23), "{}"}), rounded = *encode_file_header({rounding_job(22), "{}"});
    EXPECT_EQ(word_at(exact, 8) & 0xFFFFFFFF, 1u);  // major 1, minor 0
    EXPECT_EQ(word_at(exact, 16), kFooterFeature);
    EXPECT_EQ(word_at(rounded, 8) & 0xFFFFFFFF, 0x00010001u);
    EXPECT_EQ(word_at(rounded, 16), kPrecisionFeature | kFooterFeature);
    EXPECT_EQ(decode_file_header(rounded)->job.precision, 22);

    for (const Bytes& header : {exact, rounded}) {  // the feature without the field, the field without the feature
        Bytes wrong = header;
        wrong[16] ^= std::byte{1};
        store_le(&wrong[56], hash64(ByteSpan(wrong).first(56)));
        const Result<FileHeader> decoded = decode_file_header(wrong);
        ASSERT_FALSE(decoded);
        EXPECT_EQ(decoded.error().code, ErrorCode::kCorrupt);
    }
}

}  // namespace
}  // namespace latent::sampledb
