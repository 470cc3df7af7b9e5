// Positions of sample numbers, against the definition in exact arithmetic and against the vectors of docs/format.md.
#include "sampledb/data/film_position.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/hash.h"

namespace latent::sampledb {
namespace {

constexpr std::uint64_t kPow3_26 = 2541865828329, kPow3_40 = 12157665459056928801u;

// floor(phi_3(n) 2^32): the 40 low digits in reverse order are a number below 3^40.
std::uint32_t radical_inverse_3(std::uint64_t n) {
    unsigned __int128 reversed = 0;
    for (int i = 0; i < 40; ++i, n /= 3) reversed = reversed * 3 + n % 3;
    return static_cast<std::uint32_t>((reversed << 32) / kPow3_40);
}

std::uint32_t radical_inverse_2(std::uint64_t n) {
    std::uint32_t u = 0;
    for (int bit = 0; bit < 32; ++bit) u |= static_cast<std::uint32_t>(n >> bit & 1) << (31 - bit);
    return u;
}

TEST(FilmPosition, FollowsTheDefinition) {
    const PositionSamplerSpec plain{PositionSampler::kHalton23, 0, 0};
    std::uint64_t n = 0;
    for (int i = 0; i < 200000; ++i) {
        ASSERT_EQ(halton23(n, plain), (FilmPosition{radical_inverse_2(n), radical_inverse_3(n)})) << n;
        n += i < 20000 ? 1 : n / 999 + 7;  // the first ones, then up to 2^64 and around
    }
}

// phi_3 of these lies less than 13122 units of 2^-64 above a multiple of 2^-32: sums of rounded terms end below it.
TEST(FilmPosition, IsExactWhereRoundingCouldTell) {
    const PositionSamplerSpec plain{PositionSampler::kHalton23, 0, 0};
    for (const std::uint64_t n : {2897563, 28709126, 42393755, 50444298, 72444930})
        EXPECT_EQ(halton23(n, plain).v, radical_inverse_3(n)) << n;
}

TEST(FilmPosition, MeetsTheVectorsOfTheSpecification) {
    const PositionSamplerSpec plain{PositionSampler::kHalton23, 0, 0};
    const auto at = [&](std::uint64_t n) { return halton23(n, plain); };
    EXPECT_EQ(at(0), (FilmPosition{0, 0}));
    EXPECT_EQ(at(1), (FilmPosition{0x80000000, 0x55555555}));
    EXPECT_EQ(at(2), (FilmPosition{0x40000000, 0xAAAAAAAA}));
    EXPECT_EQ(at(3), (FilmPosition{0xC0000000, 0x1C71C71C}));
    EXPECT_EQ(at(12345), (FilmPosition{0x9C0C0000, 0x3F111A63}));
    EXPECT_EQ(at(1000000000000), (FilmPosition{0x0008A52B, 0x5A27ABC8}));
    EXPECT_EQ(at(0xFFFFFFFF), (FilmPosition{0xFFFFFFFF, 0x34330C78}));
    EXPECT_EQ(at(std::uint64_t{1} << 32), (FilmPosition{0, 0x898861CD}));
    EXPECT_EQ(at(kPow3_26 - 1), (FilmPosition{0x17FE40CB, 0xFFFFFFFF}));
    EXPECT_EQ(at(kPow3_40 - 1).v, 0xFFFFFFFFu);
    EXPECT_EQ(at(kPow3_40).v, 0u);  // beyond 40 digits v begins again
    EXPECT_EQ(at(std::uint64_t{1} << 63), (FilmPosition{0, 0xF97647B3}));
}

// XXH3-128 over (u, v) of n = 0 .. 9999, of 10000 numbers from 10^12 on and of 10000 multiples of 0x9E3779B97F4A7C15: as
// docs/format.md.
TEST(FilmPosition, MeetsTheHashOfTheSpecification) {
    const PositionSamplerSpec shifted{PositionSampler::kHalton23, 0x12345678, 0x9ABCDEF0};
    std::vector<std::uint64_t> n(30000);
    for (std::uint64_t i = 0; i < 10000; ++i) {
        n[i] = i;
        n[10000 + i] = 1000000000000 + i;
        n[20000 + i] = i * 0x9E3779B97F4A7C15u;
    }
    std::vector<std::uint32_t> u(n.size()), v(n.size());
    halton23(n, shifted, u, v);
    Bytes bytes;
    ByteWriter out(bytes);
    for (std::size_t i = 0; i < n.size(); ++i) {
        EXPECT_EQ(halton23(n[i], shifted), (FilmPosition{u[i], v[i]}));
        out.put(u[i]);
        out.put(v[i]);
    }
    EXPECT_EQ(to_hex(hash128(bytes)), "ef499311d4124f571743f953d4e64c21");
}

TEST(FilmPosition, ShiftsAddModuloOne) {
    const FilmPosition plain = halton23(12345, {PositionSampler::kHalton23, 0, 0});
    const FilmPosition shifted = halton23(12345, {PositionSampler::kHalton23, 0xF0000000, 0xFFFFFFFF});
    EXPECT_EQ(shifted.u, plain.u + 0xF0000000u);
    EXPECT_EQ(shifted.v, plain.v - 1u);
}

TEST(FilmPosition, EveryElementaryIntervalHoldsOneSample) {
    // 2^a 3^b consecutive samples fall into the 2^a x 3^b equal rectangles of the film, one each, wherever the block begins.
    constexpr std::uint32_t kColumns = 16, kRows = 27;
    const PositionSamplerSpec plain{PositionSampler::kHalton23, 0, 0};
    std::vector<int> count(kColumns * kRows);
    for (std::uint64_t n = 1000; n < 1000 + kColumns * kRows; ++n) {
        const FilmPosition p = halton23(n, plain);
        // v is rounded down, so a value on a row's edge may lie one unit below it
        const std::uint64_t row = (std::uint64_t{p.v} + 1) * kRows >> 32;
        ++count[(p.u >> 28) * kRows + row % kRows];
    }
    for (const int c : count) EXPECT_EQ(c, 1);
}

}  // namespace
}  // namespace latent::sampledb
