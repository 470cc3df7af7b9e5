// sampledb/data/coverage.h: sets of sample numbers, as sorted disjoint intervals.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
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

// Sets of many intervals are made in one go, from a list or from another set: adding them one by one moves what lies behind. A set
// of one interval is as small as a set of none.
class Coverage {
 public:
    Coverage() = default;
    explicit Coverage(SampleRange range) : one_(range.empty() ? SampleRange{} : range) {}
    Coverage(const Coverage& other);
    Coverage(Coverage&& other) noexcept;
    Coverage& operator=(const Coverage& other);
    Coverage& operator=(Coverage&& other) noexcept;
    ~Coverage() = default;
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

    bool empty() const { return ranges().empty(); }
    std::uint64_t size() const;                    // samples in it
    std::span<const SampleRange> ranges() const {  // sorted, disjoint, not adjacent; as long as this object stays as it is
        if (many_) return *many_;
        return {&one_, one_.empty() ? std::size_t{0} : std::size_t{1}};
    }
    bool operator==(const Coverage& other) const { return std::ranges::equal(ranges(), other.ranges()); }

 private:
    void set(std::vector<SampleRange> ranges);  // sorted, disjoint, not adjacent

    SampleRange one_;                                 // without many_: all of it, or empty
    std::unique_ptr<std::vector<SampleRange>> many_;  // two or more
};

// "0..65536, 131072..196608" (end exclusive, as in --samples A:B); at most `most` intervals, then "and 12 more".
std::string to_string(const Coverage& coverage, std::size_t most = 8);

}  // namespace latent::sampledb
