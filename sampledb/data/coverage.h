// sampledb/data/coverage.h: sets of sample numbers, as sorted disjoint intervals.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

namespace latent::sampledb {

// Sample numbers first .. end-1. The highest that there is is 2^64 - 2.
struct SampleRange {
    std::uint64_t first = 0;
    std::uint64_t end = 0;
    std::uint64_t size() const { return end - first; }
    bool empty() const { return end <= first; }
    auto operator<=>(const SampleRange&) const = default;
};

// Sets of many intervals are made in one go, from a list or from another set: adding them one by one moves what lies behind.
class Coverage {
 public:
    Coverage() = default;
    explicit Coverage(SampleRange range) { add(range); }
    // The union of ranges in any order.
    static Coverage of(std::vector<SampleRange> ranges);

    void add(SampleRange range);  // union
    void add(const Coverage& other);
    void remove(SampleRange range);
    void remove(const Coverage& other);

    bool contains(std::uint64_t sample) const;
    bool contains(SampleRange range) const;
    bool contains(const Coverage& other) const;
    bool intersects(SampleRange range) const;
    bool intersects(const Coverage& other) const;
    Coverage intersection(const Coverage& other) const;

    bool empty() const { return ranges_.empty(); }
    std::uint64_t size() const;  // samples in it
    const std::vector<SampleRange>& ranges() const { return ranges_; }
    bool operator==(const Coverage&) const = default;

 private:
    std::vector<SampleRange> ranges_;  // sorted, disjoint, not adjacent
};

// "0..65536, 131072..196608" (end exclusive, as in --samples A:B); at most `most` intervals, then "and 12 more".
std::string to_string(const Coverage& coverage, std::size_t most = 8);

}  // namespace latent::sampledb
