// Coverage behaves like the set of numbers that it stands for.
#include "sampledb/data/coverage.h"

#include <gtest/gtest.h>

#include <bitset>
#include <random>

namespace latent::sampledb {
namespace {

constexpr std::size_t kNumbers = 64;
using Set = std::bitset<kNumbers>;

Set set_of(SampleRange range) {
    Set set;
    for (std::uint64_t n = range.first; n < range.end; ++n) set.set(n);
    return set;
}
Set set_of(const Coverage& coverage) {
    Set set;
    for (const SampleRange& range : coverage.ranges()) set |= set_of(range);
    return set;
}

// Sorted, disjoint, not empty, not touching.
bool is_normal(const Coverage& coverage) {
    const auto& ranges = coverage.ranges();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (ranges[i].empty() || (i > 0 && ranges[i].first <= ranges[i - 1].end)) return false;
    }
    return true;
}

TEST(Coverage, EveryOperationIsThatOfSets) {
    std::mt19937 random(4);
    const auto range = [&] {
        const std::uint64_t first = random() % kNumbers, size = random() % 12;
        return SampleRange{first, std::min<std::uint64_t>(first + size, kNumbers)};
    };
    for (int trial = 0; trial < 2000; ++trial) {
        Coverage a, b;
        Set sa, sb;
        for (int i = 0; i < 8; ++i) {
            const SampleRange more = range(), less = range(), other = range();
            a.add(more), sa |= set_of(more);
            a.remove(less), sa &= ~set_of(less);
            b.add(other), sb |= set_of(other);
            ASSERT_TRUE(is_normal(a) && is_normal(b));
            ASSERT_EQ(set_of(a), sa);
            ASSERT_EQ(a.size(), sa.count());
            ASSERT_EQ(a.empty(), sa.none());
            ASSERT_EQ(a.contains(more), (set_of(more) & ~sa).none());
            ASSERT_EQ(a.intersects(less), (set_of(less) & sa).any());
            ASSERT_EQ(a.contains(b), (sb & ~sa).none());
            ASSERT_EQ(a.intersects(b), (sb & sa).any());
            ASSERT_EQ(set_of(a.intersection(b)), (sa & sb));
            ASSERT_TRUE(is_normal(a.intersection(b)));
            Coverage both = a, rest = a;
            both.add(b), rest.remove(b);
            ASSERT_EQ(set_of(both), (sa | sb));
            ASSERT_EQ(set_of(rest), (sa & ~sb));
        }
    }
}

TEST(Coverage, OfAListIsTheUnionOfItsRanges) {
    std::mt19937 random(5);
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<SampleRange> ranges;
        Set set;
        for (std::uint32_t i = random() % 9; i > 0; --i) {
            const std::uint64_t first = random() % kNumbers;
            ranges.push_back({first, std::min<std::uint64_t>(first + random() % 9, kNumbers)});
            set |= set_of(ranges.back());
        }
        const Coverage coverage = Coverage::of(ranges);
        ASSERT_TRUE(is_normal(coverage));
        ASSERT_EQ(set_of(coverage), set);
        for (std::uint64_t n = 0; n < kNumbers; ++n) ASSERT_EQ(coverage.contains(n), set.test(n));
    }
}

TEST(Coverage, EndsBeforeTheLastNumber) {
    constexpr std::uint64_t kEnd = ~std::uint64_t{0};
    const Coverage coverage(SampleRange{kEnd - 1, kEnd});
    EXPECT_TRUE(coverage.contains(kEnd - 1));
    EXPECT_FALSE(coverage.contains(kEnd) || coverage.contains(kEnd - 2));
    EXPECT_TRUE(coverage.intersects(SampleRange{0, kEnd}));
}

TEST(Coverage, IsWrittenAsIntervals) {
    Coverage coverage;
    EXPECT_EQ(to_string(coverage), "none");
    for (std::uint64_t i = 0; i < 5; ++i) coverage.add({i * 10, i * 10 + 5});
    EXPECT_EQ(to_string(coverage, 2), "0:5, 10:15 and 3 more");
}

}  // namespace
}  // namespace latent::sampledb
