#include "tools/develop/kernel/splat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>

#include "tests/develop/developed.h"

namespace latent::develop {
namespace {

constexpr std::size_t kSide = 64;  // pixels of a cell
constexpr int kLanes = 4;

// Records of one cell, and segments that hold them.
struct SplatRecords {
    std::vector<std::uint32_t> x, y;
    std::vector<float> values;
    std::vector<std::byte> memory;
    std::vector<Segment> segments;

    // Cut into segments of so many records, one after the other; the last is as short as it must be.
    void cut(const std::function<std::size_t(std::size_t segment)>& length) {
        memory.assign(SegmentColumns::bytes(x.size(), kLanes) + Segment::kReadable, std::byte{0xFF});
        segments.clear();
        for (std::size_t first = 0, n = 0; first < x.size(); first += n) {
            n = std::min(length(segments.size()), x.size() - first);
            segments.push_back({0, memory.data() + SegmentColumns::bytes(first, kLanes), static_cast<std::uint32_t>(n)});
            const SegmentColumns to = segments.back().columns();
            std::copy_n(x.data() + first, n, to.x);
            std::copy_n(y.data() + first, n, to.y);
            std::copy_n(values.data() + kLanes * first, kLanes * n, to.values);
        }
    }
};
SplatRecords make_records(std::size_t count) {
    std::mt19937 random(11);
    SplatRecords records;
    for (std::size_t i = 0; i < count; ++i) {
        records.x.push_back(static_cast<std::uint32_t>(random() % (kSide << 24)));
        records.y.push_back(static_cast<std::uint32_t>(random() % (kSide << 24)));
        for (int c = 0; c < kLanes; ++c) records.values.push_back(std::ldexp(static_cast<float>(random()), -31) - 0.7f);
    }
    records.cut([](std::size_t segment) { return segment % 3 == 0 ? 1 + 31 * segment % 201 : 1 + segment % 5; });
    return records;
}

std::size_t window_side(const Filter& filter) { return kSide + static_cast<std::size_t>(filter.kernel().side()); }

std::vector<double> window_of(const Filter& filter, Weights weights, const SplatRecords& records) {
    std::vector<double> window(window_side(filter) * window_side(filter) * kLanes);
    splat(filter.kernel(), kLanes, weights, records.segments, window.data(), window_side(filter));
    return window;
}

TEST(Splat, SumsAreThoseOfTheDefinitionAndCutSegmentsChangeNone) {
    const SplatRecords records = make_records(3000);
    SplatRecords whole = records;
    whole.cut([](std::size_t) { return 3000; });
    for (const char* name : kFilters) {
        const Filter filter = *Filter::parse(name);
        for (const Weights weights : {Weights::kSigned, Weights::kPositive, Weights::kUnitSum}) {
            SCOPED_TRACE(::testing::Message() << name << ' ' << static_cast<int>(weights));
            const std::vector<double> window = window_of(filter, weights, records);
            EXPECT_EQ(window, window_of(filter, weights, whole));
            const int side = filter.kernel().side(), reach = filter.reach();
            std::vector<double> expected(window.size()), most(window.size());
            for (std::size_t i = 0; i < 3000; ++i) {
                const double gx = (records.x[i] & 0xFFFFFF) * 0x1p-24, gy = (records.y[i] & 0xFFFFFF) * 0x1p-24;
                const auto w = [&](int k, int l) { return filter.weight(k - reach + 1 - gx, l - reach + 1 - gy); };
                double lattice = 0;
                for (int k = 0; k < side * side; ++k) lattice += w(k % side, k / side);
                for (int k = 0; k < side * side; ++k) {
                    double weight = w(k % side, k / side);
                    if (weights == Weights::kPositive) weight = std::max(weight, 0.0);
                    if (weights == Weights::kUnitSum) weight /= lattice;
                    const std::size_t at = ((records.y[i] >> 24) + static_cast<std::size_t>(k / side)) * window_side(filter) +
                                           (records.x[i] >> 24) + static_cast<std::size_t>(k % side);
                    for (std::size_t c = 0; c < kLanes; ++c) {
                        const double s = static_cast<double>(records.values[i * kLanes + c]);
                        expected[at * kLanes + c] += weight * s;
                        most[at * kLanes + c] += std::abs(s);
                    }
                }
            }
            // Weights are float32, where tables are linear between steps: errors of some 1e-7 of the largest weight, 1.
            for (std::size_t i = 0; i < window.size(); ++i) ASSERT_NEAR(window[i], expected[i], 2e-6 * most[i]) << i;
        }
    }
}

TEST(Splat, ThreeByThreePixelsGetTheVerySumsOfTheFourByFourAroundThem) {
    const SplatRecords records = make_records(3000);
    for (const char* name : {"quartic:-3,1.5", "quartic:-6,1.5", "quartic:-3,1.2", "gaussian:0.5,1.5"}) {
        const Filter filter = *Filter::parse(name);
        ASSERT_EQ(filter.kernel().covered, 3) << name;
        FilterKernel wide = filter.kernel();
        wide.covered = 4;
        for (int k = 0; k < 16; ++k) {
            wide.column[static_cast<std::size_t>(k)] = static_cast<float>(k % 4 - 1);
            wide.row[static_cast<std::size_t>(k)] = static_cast<float>(k / 4 - 1);
        }
        for (const Weights weights : {Weights::kSigned, Weights::kPositive, Weights::kUnitSum}) {
            const std::vector<double> window = window_of(filter, weights, records);
            std::vector<double> expected(window.size());
            splat(wide, kLanes, weights, records.segments, expected.data(), window_side(filter));
            EXPECT_EQ(window, expected) << name << ' ' << static_cast<int>(weights);
        }
    }
    EXPECT_EQ(Filter::parse("quartic:-3,1.51")->kernel().covered, 4);
}

TEST(Splat, APatchHasTheVerySumsOfTheWindow) {
    const SplatRecords records = make_records(3000);
    for (const char* name : kFilters) {
        const Filter filter = *Filter::parse(name);
        const auto side = static_cast<std::int64_t>(window_side(filter));
        for (const Weights weights : {Weights::kSigned, Weights::kPositive, Weights::kUnitSum}) {
            const std::vector<double> window = window_of(filter, weights, records);
            for (const PixelRect& pixels : {PixelRect{0, 0, 5, 3}, {20, 30, 21, 31}, {side - 4, 7, side, 50}, {0, 0, side, side}}) {
                SCOPED_TRACE(::testing::Message() << name << ' ' << static_cast<int>(weights) << ' ' << pixels.x0);
                const PixelRect reach = patch_of(filter.kernel(), pixels);
                std::vector<double> patch(static_cast<std::size_t>(reach.width() * reach.height() * kLanes));
                splat_patch(filter.kernel(), kLanes, weights, records.segments, pixels, patch.data());
                for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
                    for (std::int64_t i = pixels.x0 * kLanes; i < pixels.x1 * kLanes; ++i) {
                        const auto in_patch = (y - reach.y0) * reach.width() * kLanes + i - reach.x0 * kLanes;
                        ASSERT_EQ(patch[static_cast<std::size_t>(in_patch)],
                                  window[static_cast<std::size_t>(y * side * kLanes + i)])
                            << y << ' ' << i;
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace latent::develop
