#include "color/quantise.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "color/blue_noise.h"
#include "tests/color/simd_targets.h"

namespace latent::color {
namespace {

const Transfer kTransfers[] = {Transfer::srgb(), Transfer::rec2020(), Transfer::gamma(563.0 / 256), Transfer::linear()};

constexpr Dither kDithers[] = {Dither::kNone, Dither::kRandom, Dither::kTriangular, Dither::kBlue};

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
        const Quantiser q{.transfer = t, .dither = Dither::kNone};
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
        for (const Dither dither : kDithers) {
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
        for (const Dither dither : kDithers) {
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
    for (const Dither dither : {Dither::kRandom, Dither::kTriangular, Dither::kBlue}) {
        const Quantiser q{.transfer = Transfer::srgb(), .dither = dither, .seed = 9};
        const std::vector<float> v = levels(300);
        const std::vector<std::uint8_t> whole = codes_8(q, v, 1000, 77);
        for (const std::size_t begin : {1U, 13U, 64U, 250U}) {
            const std::vector<std::uint8_t> crop =
                codes_8(q, {v.begin() + static_cast<std::ptrdiff_t>(begin), v.end()}, 1000 + static_cast<std::uint32_t>(begin), 77);
            EXPECT_TRUE(std::equal(crop.begin(), crop.end(), whole.begin() + 3 * static_cast<std::ptrdiff_t>(begin)));
        }
        EXPECT_NE(codes_8(q, v, 1000, 78), whole);
        EXPECT_NE(codes_8({.transfer = Transfer::srgb(), .dither = dither, .seed = 10}, v, 1000, 77), whole);
    }
}

// A flat field of 256 x 256 pixels, `level` codes bright: the mean and the mean square of what is wrong with each channel.
struct Errors {
    std::array<double, 3> mean{}, square{};
    std::vector<double> green;  // of each pixel
};
Errors errors_of(Dither dither, float level) {
    constexpr std::uint32_t kSize = 256;
    const Quantiser q{.transfer = Transfer::linear(), .dither = dither};
    const std::vector<float> flat(kSize, level / 255);
    Errors errors;
    for (std::uint32_t row = 0; row < kSize; ++row) {
        const std::vector<std::uint8_t> code = codes_8(q, flat, 0, row);
        for (std::size_t i = 0; i < code.size(); ++i) {
            const double error = code[i] - static_cast<double>(level);
            errors.mean[i % 3] += error / (kSize * kSize);
            errors.square[i % 3] += error * error / (kSize * kSize);
            if (i % 3 == 1) errors.green.push_back(error);
        }
    }
    return errors;
}

// The error of a pixel has a standard deviation of at most 1/2, so its mean over 2^16 pixels one of 1/512: five of them. The
// pattern holds each of 4096 thresholds equally often.
TEST(Quantiser, DitherKeepsTheMeanOfAFlatFieldInEveryChannelUpToTheEnds) {
    for (const float level : {0.0F, 0.1F, 0.45F, 0.7F, 100.3F, 100.5F, 254.2F, 254.6F, 254.9F, 255.0F}) {
        for (const Dither dither : {Dither::kRandom, Dither::kTriangular, Dither::kBlue}) {
            const Errors errors = errors_of(dither, level);
            for (const double mean : errors.mean) EXPECT_NEAR(mean, 0, dither == Dither::kBlue ? 1.01 / 4096 : 5.0 / 512) << level;
        }
    }
}

// f (1 - f) for a fraction f of a code; 1/4 for the sum of two dithers. Means of squares over 2^16 pixels are within 1 %.
TEST(Quantiser, NoiseOfTriangularDitherDoesNotDependOnTheLevel) {
    for (const float fraction : {0.0F, 0.1F, 0.25F, 0.5F, 0.8F}) {
        const Errors random = errors_of(Dither::kRandom, 100 + fraction),
                     triangular = errors_of(Dither::kTriangular, 100 + fraction);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(random.square[c], static_cast<double>(fraction * (1 - fraction)), 0.005) << fraction;
            EXPECT_NEAR(triangular.square[c], 0.25, 0.005) << fraction;
        }
    }
}

// What the eye sees from afar: the noise of means over 8 x 8 pixels. That of random dither is 1/8 of a pixel's.
TEST(Quantiser, BlueDitherIsFarLessNoisyFromAfar) {
    const auto variance_of_means = [](const Errors& errors) {
        double sum = 0;
        for (std::size_t by = 0; by < 32; ++by) {
            for (std::size_t bx = 0; bx < 32; ++bx) {
                double block = 0;
                for (std::size_t i = 0; i < 64; ++i) block += errors.green[(8 * by + i / 8) * 256 + 8 * bx + i % 8] / 64;
                sum += block * block / 1024;
            }
        }
        return sum;
    };
    for (const float level : {30.1F, 30.3F, 30.5F, 30.8F}) {
        const double random = variance_of_means(errors_of(Dither::kRandom, level)),
                     blue = variance_of_means(errors_of(Dither::kBlue, level));
        EXPECT_LT(blue, random / 6) << level;
    }
}

TEST(BlueNoise, HoldsEachThresholdOnceAndRowsTwice) {
    std::vector<int> seen(4096);
    for (const BlueNoiseRow& row : blue_noise()) {
        for (std::size_t x = 0; x < 64; ++x) {
            ++seen[static_cast<std::size_t>(row[x] * 4096)];
            EXPECT_EQ(row[x], row[x + 64]);
        }
    }
    EXPECT_EQ(seen, std::vector<int>(4096, 1));
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
    const Quantiser q{.transfer = Transfer::linear(), .dither = Dither::kRandom, .seed = 3};
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
