// Laws of the numbers of a sample, and of the functions that turn them into points.
#include "render/sampling/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "render/sampling/alias_table.h"
#include "render/sampling/halton_sampler.h"
#include "render/sampling/piecewise_constant.h"
#include "render/sampling/pixel_sampler.h"
#include "render/sampling/warp.h"
#include "sampledb/data/film_position.h"
#include "tests/transport/numbers.h"

namespace latent::render::testing {
namespace {

using D = Dimension;

const std::vector<std::uint32_t> kImportant = {0, 1, 2, 3, 9, 10, 11};

// Largest distance of the empirical distribution from the uniform one.
double discrepancy(std::vector<float> x) {
    std::sort(x.begin(), x.end());
    double worst = 0;
    const double n = static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        worst = std::max({worst, std::abs(static_cast<double>(x[i]) - static_cast<double>(i) / n),
                          std::abs(static_cast<double>(x[i]) - static_cast<double>(i + 1) / n)});
    }
    return worst;
}

// By Halton's positions, and by pixels.
std::vector<std::unique_ptr<const Sampler>> samplers(std::uint64_t seed) {
    std::vector<std::unique_ptr<const Sampler>> both;
    both.push_back(
        std::make_unique<HaltonSampler>(sampledb::PositionSamplerSpec{sampledb::PositionSampler::kHalton23}, seed, kImportant));
    both.push_back(
        std::make_unique<PixelSampler>(sampledb::PositionSamplerSpec{sampledb::PositionSampler::kPixels, 0, 0, 60, 34}, seed));
    return both;
}

void expect_uniform(const Sampler& sampler) {
    for (const std::uint32_t dimension : {0u, 1u, 3u, 11u, 20u, 100u, Dimension::of_light_vertex(3, Dimension::kLobe)}) {
        std::vector<float> x;
        for (std::uint64_t n = 0; n < 20'000; ++n) x.push_back(sampler.at(n, dimension));
        EXPECT_LT(discrepancy(x), 1.95 / std::sqrt(20'000.0)) << dimension;  // Kolmogorov at 1e-3; spread-out ones are far below
    }
}

TEST(Sampler, EveryDimensionIsUniform) {
    for (const std::unique_ptr<const Sampler>& sampler : samplers(42)) expect_uniform(*sampler);
}

// The samples of one pixel are spread out in the important dimensions, and in those that share their primes, as no random numbers
// are, at any resolution.
TEST(Sampler, SamplesOfOnePixelAreSpreadOut) {
    constexpr std::uint32_t kDimensions = 6;
    const HaltonSampler sampler({}, 7, kImportant, {{4, 0}, {5, 1}});
    for (const std::uint32_t width : {64u, 100u, 256u}) {
        double sum = 0;
        int count = 0;
        std::vector<std::vector<float>> x(std::size_t{width} * kDimensions);  // of the pixels of one row
        for (std::uint64_t n = 0; n < width * width * 16; ++n) {
            const sampledb::FilmPosition p = sampledb::halton23(n, {sampledb::PositionSampler::kHalton23, 0, 0});
            if (std::uint64_t{p.v} * width >> 32 != 40) continue;
            for (std::uint32_t d = 0; d < kDimensions; ++d)
                x[(std::uint64_t{p.u} * width >> 32) * kDimensions + d].push_back(sampler.at(n, d));
        }
        for (const std::vector<float>& of_one : x) {
            sum += discrepancy(of_one) * std::sqrt(static_cast<double>(of_one.size()));
            ++count;
        }
        EXPECT_LT(sum / count, 0.8 * 0.87) << width;  // 0.87: the mean of random numbers
    }
}

// Of 2^m passes, each pixel has one number in each part of 2^-m, and one pair of the numbers of a light's point, and of a
// direction, in each of many boxes: they are (t, m, 2)-nets with a small t.
TEST(Sampler, SamplesOfOnePixelAreStratified) {
    constexpr std::uint32_t kWidth = 60, kHeight = 34, kPasses = 16;
    const PixelSampler sampler({sampledb::PositionSampler::kPixels, 0, 0, kWidth, kHeight}, 7);
    std::map<std::uint64_t, std::vector<std::uint64_t>> samples;  // of each pixel
    for (std::uint64_t n = 3 * kPasses * kWidth * kHeight; n < 4 * kPasses * kWidth * kHeight; ++n) {
        const sampledb::PixelLattice::Place place = sampler.key_of(n).place;
        samples[place.y * kWidth + place.x].push_back(n);
    }
    ASSERT_EQ(samples.size(), kWidth * kHeight);
    const auto part = [&](std::uint64_t n, std::uint32_t dimension, std::uint32_t parts) {
        return sampler.at(n, dimension).index(parts);
    };
    const auto of_vertex = [](std::uint32_t vertex, std::uint32_t what) { return D::of_camera_vertex(vertex, what); };
    for (const auto& [pixel, numbers] : samples) {
        for (const std::uint32_t dimension :
             {+D::kXi, +D::kLensU, +D::kLensV, +D::kTime, +D::kKeptWavelength, of_vertex(0, D::kLightU), of_vertex(0, D::kLobe),
              of_vertex(0, D::kDistance), of_vertex(1, D::kDirectionV)}) {
            std::set<std::uint32_t> parts;
            for (const std::uint64_t n : numbers) parts.insert(part(n, dimension, kPasses));
            ASSERT_EQ(parts.size(), kPasses) << dimension;
        }
        for (const std::uint32_t first : {of_vertex(0, D::kLightU), of_vertex(0, D::kDirectionU), +D::kLensU}) {
            std::set<std::uint32_t> boxes;
            for (const std::uint64_t n : numbers) boxes.insert(part(n, first, 4) * 4 + part(n, first + 1, 4));
            ASSERT_GE(boxes.size(), kPasses / 2) << first;
        }
    }
}

// Of 256 passes, the numbers of any two dimensions are in each of 4 x 4 boxes: neither tells where the other is. Of 16, each
// quarter of the shutter sees both halves of the lens.
TEST(Sampler, NoTwoNumbersOfAPixelGoTogether) {
    const PixelSampler sampler({sampledb::PositionSampler::kPixels, 0, 0, 2, 2}, 7);
    const auto expect_all = [&](std::uint32_t passes, std::uint32_t a, std::uint32_t in_a, std::uint32_t b, std::uint32_t in_b) {
        for (std::uint64_t pixel = 0; pixel < 4; ++pixel) {
            std::set<std::uint32_t> boxes;
            for (std::uint64_t n = pixel; n < 4 * passes; n += 4)
                boxes.insert(sampler.at(n, a).index(in_a) * in_b + sampler.at(n, b).index(in_b));
            EXPECT_EQ(boxes.size(), in_a * in_b) << a << ", " << b;
        }
    };
    std::vector<std::uint32_t> dimensions = {D::kXi, D::kKeptWavelength, D::kLensU, D::kLensV, D::kTime};
    for (const std::uint32_t vertex : {0u, 1u}) {
        for (std::uint32_t what = 0; what < D::kBlock; ++what) dimensions.push_back(D::of_camera_vertex(vertex, what));
    }
    for (const std::uint32_t a : dimensions) {
        for (const std::uint32_t b : dimensions) {
            if (a < b) expect_all(256, a, 4, b, 4);
        }
    }
    for (const std::uint32_t lens : {D::kLensU, D::kLensV}) expect_all(16, D::kTime, 4, lens, 2);
}

TEST(Sampler, IsAFunctionOfSeedSampleAndDimension) {
    const auto first = samplers(1), again = samplers(1), other = samplers(2);
    for (std::size_t i = 0; i < first.size(); ++i) {
        int same = 0;
        for (std::uint64_t n = 0; n < 1000; ++n) {
            for (const std::uint32_t d : {0u, 5u, 10u, D::of_camera_vertex(0, D::kLightU)}) {
                EXPECT_EQ(first[i]->at(n, d).bits, again[i]->at(n, d).bits);
                same += first[i]->at(n, d).bits == other[i]->at(n, d).bits;
            }
        }
        EXPECT_LT(same, 3);
    }
    const HaltonSampler a({}, 1, kImportant);
    const HaltonSampler sharing({}, 1, kImportant, {{4, 0}, {5, 20}});  // 20 is hashed, so 5 is too
    for (std::uint64_t n = 0; n < 1000; ++n) {
        EXPECT_EQ(sharing.at(n, 0).bits, a.at(n, 0).bits);
        EXPECT_EQ(sharing.at(n, 5).bits, a.at(n, 5).bits);
        EXPECT_NE(sharing.at(n, 4).bits, sharing.at(n, 0).bits);
    }
    EXPECT_NE(a.at((std::uint64_t{1} << 53) + 5, 0).bits,
              a.at(5, 0).bits);  // sample numbers beyond the tables are samples of their own
}

TEST(Elementary, FunctionsAgreeWithTheLibrary) {
    for (int i = 0; i < 100'000; ++i) {
        const float x = -static_cast<float>(i) * 8e-4f, u = static_cast<float>(i) * 1e-5f;
        ASSERT_NEAR(exp_nonpositive(x) / std::exp(static_cast<double>(x)), 1, 1e-6) << x;
        ASSERT_NEAR(sincos_turns(u).sin, std::sin(static_cast<double>(u) * 2 * std::numbers::pi), 3e-7);
        ASSERT_NEAR(sincos_turns(u).cos, std::cos(static_cast<double>(u) * 2 * std::numbers::pi), 3e-7);
        const float slope = 1e-7f + 0.01f * u / (1 - u);  // of angles between nothing and almost a quarter turn
        const double turns = std::atan(static_cast<double>(slope)) / (2 * std::numbers::pi);
        ASSERT_NEAR(angle_in_turns(1, slope) / turns, 1, 1e-6) << slope;
        ASSERT_NEAR(angle_in_turns(-1, slope), 0.5 - turns, 1e-7) << slope;
        if (i > 0) {
            ASSERT_NEAR(log_one_minus(u) / std::log1p(-static_cast<double>(u)), 1, 1e-6) << u;
            ASSERT_NEAR(log_one_minus(u * 1e-9f) / std::log1p(-static_cast<double>(u * 1e-9f)), 1, 1e-6) << u;
            ASSERT_NEAR(log_positive(u), std::log(static_cast<double>(u)), 3e-7 * (1 + std::abs(std::log(static_cast<double>(u)))));
        }
    }
}

TEST(AliasTable, FollowsItsWeights) {
    const std::vector<double> weight = {3, 0, 1, 0.25, 12, 1};
    const AliasTable table(weight);
    std::vector<int> counted(weight.size());
    constexpr int kCount = 400'000;
    for (std::uint64_t i = 0; i < kCount; ++i) ++counted[table.sample({~std::uint64_t{0} / kCount * i})];
    for (std::uint32_t i = 0; i < weight.size(); ++i) {
        EXPECT_NEAR(table.probability(i), weight[i] / 17.25, 1e-6);
        EXPECT_NEAR(counted[i], weight[i] / 17.25 * kCount, 20);
    }
}

// However many there are to choose from: every second one has 1/200 of the weight of the others.
// What a choice leaves of its number is as even as the number.
TEST(AliasTable, LeavesTheRestOfItsNumber) {
    const std::vector<double> weight = {3, 0, 1, 0.25, 12, 1};
    const AliasTable table(weight);
    constexpr int kCount = 400'000, kParts = 10;
    std::vector<std::array<double, kParts>> counted(weight.size());
    for (std::uint64_t i = 0; i < kCount; ++i) {
        Uniform rest;
        const std::uint32_t chosen = table.sample({~std::uint64_t{0} / kCount * i}, rest);
        ++counted[chosen][rest.index(kParts)];
    }
    for (std::size_t i = 0; i < weight.size(); ++i) {
        for (const double count : counted[i]) EXPECT_NEAR(count, weight[i] / 17.25 * kCount / kParts, 20);
    }
}

TEST(AliasTable, FollowsItsWeightsAmongAMillion) {
    const HaltonSampler sampler({}, 1, kImportant);
    for (const std::uint32_t size : {1024u, 16'384u, 131'072u, 1u << 20}) {
        std::vector<double> weight(size);
        for (std::uint32_t i = 0; i < size; ++i) weight[i] = i % 2 == 0 ? 1 : 200;
        const AliasTable table(weight);
        constexpr int kCount = 4'000'000;
        for (const std::uint32_t dimension : {0u, 100u}) {  // of the sampler: a radical inverse, and a hash
            double small = 0, probability = 0;
            for (std::uint64_t n = 0; n < kCount; ++n) small += table.sample(sampler.at(n, dimension)) % 2 == 0;
            for (std::uint32_t i = 0; i < size; i += 2) probability += static_cast<double>(table.probability(i));
            EXPECT_NEAR(probability * 201, 1, 1e-5) << size;
            EXPECT_NEAR(small / kCount * 201, 1, 4 * std::sqrt(201.0 / kCount)) << size;
        }
    }
}

// Steps so unequal that all but one have less than 2^-24 of the whole, in order, each evenly filled.
TEST(PiecewiseConstant, FollowsItsWeightsHoweverSmall) {
    constexpr std::uint32_t kSize = 2048, kLarge = 700;
    std::vector<double> weight(kSize, 1);
    weight[kLarge] = 4e7;
    const PiecewiseConstant steps{weight};
    Numbers u(16);
    double whole = 0, middle = 0;
    for (std::uint32_t i = 0; i < kSize; ++i) {
        whole += steps.probability(i);
        if (i == kLarge) continue;
        ASSERT_NEAR(steps.probability(i) * 4e7, 1, 0.02);  // 2^-32 of the whole is 0.9 % of a step
        Uniform begin, inside;
        std::uint64_t from = 0, to = ~std::uint64_t{0};  // the first number of the step, by halving
        while (from < to) {
            const std::uint64_t half = from + (to - from) / 2;
            (steps.sample({half}, inside) < i ? from : to) = steps.sample({half}, inside) < i ? half + 1 : half;
        }
        ASSERT_EQ(steps.sample({from}, begin), i);
        ASSERT_EQ(begin.bits, 0u);
        const auto width = static_cast<std::uint64_t>(steps.probability(i) * 0x1p64);
        ASSERT_EQ(steps.sample({from + width / 2}, inside), i);
        ASSERT_NEAR(inside, 0.5, 1e-6);
        ASSERT_EQ(steps.sample({from + width - 1}, inside), i);
        ASSERT_NEAR(inside, 1, 1e-6);
    }
    EXPECT_EQ(whole, 1);
    for (int n = 0; n < 10'000; ++n) {
        Uniform inside;
        EXPECT_EQ(steps.sample(u(), inside), kLarge);
        middle += static_cast<double>(inside) / 10'000;
    }
    EXPECT_NEAR(middle, 0.5, 4 * std::sqrt(1 / 12.0 / 10'000));
}

TEST(Uniform, KeepsBitsForEveryNumberThatIsTakenFromIt) {
    Numbers u(17);
    for (const std::uint32_t n : {1u, 2u, 3u, 28u, 1'000'000u, 4'000'000'000u}) {
        double middle = 0;
        for (int i = 0; i < 1000; ++i) {
            const Uniform x = u();
            const double scaled = static_cast<double>(x.bits) * 0x1p-64 * n;
            ASSERT_NEAR(x.index(n) + static_cast<double>(x.within(n).bits) * 0x1p-64, scaled, 1e-6);
            middle += static_cast<double>(x.within(n)) / 1000;
        }
        EXPECT_NEAR(middle, 0.5, 4 * std::sqrt(1 / 12.0 / 1000)) << n;
    }
    EXPECT_EQ(Uniform{~std::uint64_t{0}}.index(28), 27u);
    EXPECT_LT(Uniform{~std::uint64_t{0}}, 1.0f);
    EXPECT_EQ(Uniform{3}, 0x1p-63f);  // small numbers keep their digits
    EXPECT_EQ(Uniform{std::uint64_t{1} << 30}, 0x1p-34f);
}

TEST(Sampling, DiskAndTriangleAreUniform) {
    Numbers u(3);
    int inner = 0, corner = 0;
    constexpr int kCount = 200'000;
    for (int i = 0; i < kCount; ++i) {
        const float a = u(), b = u();
        const Vec2f d = sample_disk(a, b), t = sample_triangle(a, b);
        ASSERT_LE(d.x * d.x + d.y * d.y, 1.00001f);
        ASSERT_TRUE(t.x >= 0 && t.y >= 0 && t.x + t.y <= 1.00001f);
        inner += d.x * d.x + d.y * d.y < 0.25f && d.x > 0;
        corner += t.x + t.y < 0.5f;
    }
    EXPECT_NEAR(inner, kCount / 8.0, 5 * std::sqrt(kCount / 8.0));
    EXPECT_NEAR(corner, kCount / 4.0, 5 * std::sqrt(kCount / 4.0));
}

}  // namespace
}  // namespace latent::render::testing
