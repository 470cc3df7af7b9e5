#include "sampledb/data/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace latent::sampledb {

namespace {

using Ranges = std::vector<SampleRange>;

// The first of `ranges` that ends at or behind `sample`.
template <class Iterator>
Iterator first_reaching(Iterator begin, Iterator end, std::uint64_t sample) {
    return std::lower_bound(begin, end, sample, [](const SampleRange& r, std::uint64_t s) { return r.end < s; });
}

// Appends a range that begins no earlier than the last one.
void append(Ranges& ranges, SampleRange range) {
    if (range.empty()) return;
    if (!ranges.empty() && range.first <= ranges.back().end) {
        ranges.back().end = std::max(ranges.back().end, range.end);
    } else {
        ranges.push_back(range);
    }
}

}  // namespace

Coverage Coverage::of(Ranges ranges) {
    std::ranges::sort(ranges);
    Coverage coverage;
    for (const SampleRange& range : ranges) append(coverage.ranges_, range);
    return coverage;
}

void Coverage::add(SampleRange range) {
    if (range.empty()) return;
    const auto first = first_reaching(ranges_.begin(), ranges_.end(), range.first);  // touching ranges join
    auto last = first;
    for (; last != ranges_.end() && last->first <= range.end; ++last) {
        range.first = std::min(range.first, last->first);
        range.end = std::max(range.end, last->end);
    }
    if (first == last) {
        ranges_.insert(first, range);
    } else {
        *first = range;
        ranges_.erase(first + 1, last);
    }
}

void Coverage::add(const Coverage& other) {
    if (other.ranges_.size() == 1) return add(other.ranges_.front());
    Ranges both;
    both.reserve(ranges_.size() + other.ranges_.size());
    auto a = ranges_.begin();
    auto b = other.ranges_.begin();
    while (a != ranges_.end() || b != other.ranges_.end()) {
        const bool from_a = b == other.ranges_.end() || (a != ranges_.end() && *a < *b);
        append(both, from_a ? *a++ : *b++);
    }
    ranges_ = std::move(both);
}

void Coverage::remove(SampleRange range) {
    if (range.empty()) return;
    auto first = first_reaching(ranges_.begin(), ranges_.end(), range.first);
    if (first != ranges_.end() && first->end == range.first) ++first;  // only touches it
    auto last = first;
    while (last != ranges_.end() && last->first < range.end) ++last;
    if (first == last) return;
    const SampleRange before{first->first, range.first}, behind{range.end, (last - 1)->end};
    if (!before.empty()) *first++ = before;
    if (!behind.empty() && first == last) {  // the hole is inside one interval
        ranges_.insert(first, behind);
        return;
    }
    if (!behind.empty()) *--last = behind;
    ranges_.erase(first, last);
}

void Coverage::remove(const Coverage& other) {
    if (other.ranges_.size() == 1) return remove(other.ranges_.front());
    Ranges rest;
    rest.reserve(ranges_.size());
    auto b = other.ranges_.begin();
    for (SampleRange left : ranges_) {
        for (; b != other.ranges_.end() && b->first < left.end; ++b) {
            append(rest, {left.first, std::min(left.end, b->first)});
            left.first = std::max(left.first, b->end);
            if (b->end >= left.end) break;  // it may reach into the next interval
        }
        append(rest, left);
    }
    ranges_ = std::move(rest);
}

bool Coverage::contains(std::uint64_t sample) const {
    const auto it = std::ranges::upper_bound(ranges_, sample, {}, &SampleRange::end);
    return it != ranges_.end() && it->first <= sample;
}

bool Coverage::contains(SampleRange range) const {
    if (range.empty()) return true;
    const auto it = first_reaching(ranges_.begin(), ranges_.end(), range.end);
    return it != ranges_.end() && it->first <= range.first;
}

bool Coverage::contains(const Coverage& other) const {
    return std::all_of(other.ranges_.begin(), other.ranges_.end(), [this](const SampleRange& r) { return contains(r); });
}

bool Coverage::intersects(SampleRange range) const {
    if (range.empty()) return false;
    const auto it = first_reaching(ranges_.begin(), ranges_.end(), range.first + 1);
    return it != ranges_.end() && it->first < range.end;
}

bool Coverage::intersects(const Coverage& other) const {
    return std::any_of(other.ranges_.begin(), other.ranges_.end(), [this](const SampleRange& r) { return intersects(r); });
}

Coverage Coverage::intersection(const Coverage& other) const {
    Coverage common;
    auto a = ranges_.begin();
    auto b = other.ranges_.begin();
    while (a != ranges_.end() && b != other.ranges_.end()) {
        const SampleRange both{std::max(a->first, b->first), std::min(a->end, b->end)};
        if (!both.empty()) common.ranges_.push_back(both);
        (a->end < b->end ? a : b)++;
    }
    return common;
}

std::uint64_t Coverage::size() const {
    std::uint64_t samples = 0;
    for (const SampleRange& range : ranges_) samples += range.size();
    return samples;
}

std::string to_string(const Coverage& coverage, std::size_t most) {
    const std::vector<SampleRange>& ranges = coverage.ranges();
    std::string text;
    for (std::size_t i = 0; i < std::min(most, ranges.size()); ++i) {
        text += fmt::format("{}{}..{}", i ? ", " : "", ranges[i].first, ranges[i].end);
    }
    if (ranges.size() > most) text += fmt::format(" and {} more", ranges.size() - most);
    return text.empty() ? "none" : text;
}

}  // namespace latent::sampledb
