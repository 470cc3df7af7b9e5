#include "color/quantise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/color/simd_targets.h"

namespace latent::color {
namespace {

const Transfer kTransfers[] = {Transfer::srgb(), Transfer::rec2020(), Transfer::gamma(563.0 / 256), Transfer::linear()};

std::vector<std::uint8_t> codes_8(const Quantiser& q, const std::vector<float>& v, std::uint32_t x0 = 0, std::uint32_t row = 0) {
    std::vector<std::uint8_t> out(3 * v.size());
    q.to_8_bits(v, v, v, x0, row, out);
    return out;
}
std::vector<std::uint16_t> codes_16(const Quantiser& q, const std::vector<float>& v) {
    std::vector<std::uint16_t> out(3 * v.size());
    q.to_16_bits(v, v, v, 0, 0, out);
    return out;
}

std::vector<float> levels(std::size_t n) {
    std::vector<float> v;
    for (std::size_t i = 0; i < n; ++i) v.push_back(static_cast<float>(i) / static_cast<float>(n - 1));
    for (float small = 1; small > 1e-40F; small /= 1.25F) v.push_back(small);
    return v;
}

// The encoder's error is below 4e-7, so a code may differ from the exact one only within 0.03 codes (16 bits) of a tie.
TEST(Quantiser, CodesAreTheExactOnesRounded) {
    const std::vector<float> v = levels(200'001);
    for (const Transfer& t : kTransfers) {
        const Quantiser q{.transfer = t, .dither = false};
        const std::vector<std::uint8_t> byte = codes_8(q, v);
        const std::vector<std::uint16_t> word = codes_16(q, v);
        for (std::size_t i = 0; i < v.size(); ++i) {
            ASSERT_NEAR(byte[3 * i], 255 * t.encode(v[i]), 0.5 + 255 * 4e-7) << v[i];
            ASSERT_NEAR(word[3 * i + 2], 65535 * t.encode(v[i]), 0.5 + 65535 * 4e-7) << v[i];
        }
    }
}

TEST(Quantiser, EveryInstructionSetGivesTheSameBytes) {
    std::vector<float> v = levels(10'007);
    for (const float odd :
         {-1.0F, 2.0F, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), std::nanf("")}) {
        v.push_back(odd);
    }
    for (const Transfer& t : kTransfers) {
        for (const bool dither : {false, true}) {
            const Quantiser q{.transfer = t, .dither = dither, .seed = 5};
            const std::vector<std::uint8_t> byte = codes_8(q, v);
            const std::vector<std::uint16_t> word = codes_16(q, v);
            with_every_simd_target([&] {
                EXPECT_EQ(codes_8(q, v), byte);
                EXPECT_EQ(codes_16(q, v), word);
            });
        }
    }
}

TEST(Quantiser, ValuesOutsideAreTheNearestPureOnes) {
    const float inf = std::numeric_limits<float>::infinity();
    for (const Transfer& t : kTransfers) {
        for (const bool dither : {false, true}) {
            const Quantiser q{.transfer = t, .dither = dither};
            for (std::uint32_t row = 0; row < 200; ++row) {
                const std::vector<std::uint8_t> code = codes_8(q, {0, 1, -0.0F, -1, 1.5F, inf, -inf, std::nanf("")}, 7 * row, row);
                for (std::size_t i = 0; i < 8; ++i) {
                    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(code[3 * i + c], i == 1 || i == 4 || i == 5 ? 255 : 0) << i;
                }
            }
        }
    }
}

TEST(Quantiser, CropsAndStripsGetTheSameBytes) {
    const Quantiser q{.transfer = Transfer::srgb(), .dither = true, .seed = 9};
    const std::vector<float> v = levels(300);
    const std::vector<std::uint8_t> whole = codes_8(q, v, 1000, 77);
    for (const std::size_t begin : {1U, 13U, 64U, 250U}) {
        const std::vector<std::uint8_t> crop =
            codes_8(q, {v.begin() + static_cast<std::ptrdiff_t>(begin), v.end()}, 1000 + static_cast<std::uint32_t>(begin), 77);
        EXPECT_TRUE(std::equal(crop.begin(), crop.end(), whole.begin() + 3 * static_cast<std::ptrdiff_t>(begin)));
    }
    EXPECT_NE(codes_8(q, v, 1000, 78), whole);
    EXPECT_NE(codes_8({.transfer = Transfer::srgb(), .dither = true, .seed = 10}, v, 1000, 77), whole);
}

// A flat field of 0.3 codes above code 100: the mean over 2^16 pixels is a binomial mean, standard deviation sqrt(0.21 / 65536) =
// 0.0018.
TEST(Quantiser, DitherKeepsTheMeanOfAFlatFieldInEveryChannel) {
    const Quantiser q{.transfer = Transfer::linear(), .dither = true};
    double sum[3] = {};
    const std::vector<float> flat(256, 100.3F / 255);
    for (std::uint32_t row = 0; row < 256; ++row) {
        const std::vector<std::uint8_t> code = codes_8(q, flat, 0, row);
        for (std::size_t i = 0; i < code.size(); ++i) {
            ASSERT_TRUE(code[i] == 100 || code[i] == 101);
            sum[i % 3] += code[i];
        }
    }
    for (const double channel : sum) EXPECT_NEAR(channel / 65536, 100.3, 5 * 0.0018);
}

// Dither values of a 512 x 512 field: uniform (chi-square over 64 classes, 63 degrees of freedom, sd 11.2), not correlated with
// their neighbours or between channels (correlation of n pairs has standard deviation 1/sqrt(n) = 0.002).
TEST(Quantiser, DitherIsUniformAndUncorrelated) {
    constexpr std::uint32_t kSize = 512;
    const auto h = [](std::uint32_t x, std::uint32_t row, std::uint32_t c) { return dither_value(x, row, c, 0) - 0.5; };
    std::vector<int> classes(64);
    double right = 0, down = 0, channel = 0;
    for (std::uint32_t row = 0; row < kSize; ++row) {
        for (std::uint32_t x = 0; x < kSize; ++x) {
            ++classes[static_cast<std::size_t>((h(x, row, 1) + 0.5) * 64)];
            right += h(x, row, 0) * h(x + 1, row, 0);
            down += h(x, row, 0) * h(x, row + 1, 0);
            channel += h(x, row, 0) * h(x, row, 2);
        }
    }
    constexpr double n = kSize * kSize;
    double chi_square = 0;
    for (const int k : classes) chi_square += (k - n / 64) * (k - n / 64) / (n / 64);
    EXPECT_NEAR(chi_square, 63, 5 * 11.2);
    for (const double sum : {right, down, channel}) EXPECT_NEAR(12 * sum / n, 0, 5 * 0.002);
}

TEST(Quantiser, DitherValueIsTheOneUsed) {
    const Quantiser q{.transfer = Transfer::linear(), .dither = true, .seed = 3};
    const std::vector<float> flat(64, 0.4F);
    for (const std::uint32_t row : {0U, 1U, 4'000'000'000U}) {
        const std::vector<std::uint8_t> code = codes_8(q, flat, 4'294'967'280U, row);  // x wraps in 32 bits
        for (std::uint32_t i = 0; i < 64; ++i) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                EXPECT_EQ(code[3 * i + c], std::floor(0.4F * 255 + dither_value(4'294'967'280U + i, row, c, 3)));
            }
        }
    }
}

}  // namespace
}  // namespace latent::color
