#include "sampledb/data/coverage.h"

#include <fmt/format.h>

#include <algorithm>

namespace latent::sampledb {

namespace {

// The first of `ranges` that ends at or behind `sample`.
auto first_reaching(const std::vector<SampleRange>& ranges, std::uint64_t sample) {
    return std::lower_bound(ranges.begin(), ranges.end(), sample, [](const SampleRange& r, std::uint64_t s) { return r.end < s; });
}

}  // namespace

void Coverage::add(SampleRange range) {
    if (range.empty()) return;
    const auto first = first_reaching(ranges_, range.first);  // touching ranges join
    auto last = first;
    for (; last != ranges_.end() && last->first <= range.end; ++last) {
        range.first = std::min(range.first, last->first);
        range.end = std::max(range.end, last->end);
    }
    ranges_.insert(ranges_.erase(first, last), range);
}

void Coverage::add(const Coverage& other) {
    for (const SampleRange& range : other.ranges_) add(range);
}

void Coverage::remove(SampleRange range) {
    if (range.empty()) return;
    std::vector<SampleRange> kept;
    kept.reserve(ranges_.size() + 1);
    for (const SampleRange& r : ranges_) {
        const SampleRange before{r.first, std::min(r.end, range.first)};
        const SampleRange behind{std::max(r.first, range.end), r.end};
        if (!before.empty()) kept.push_back(before);
        if (!behind.empty()) kept.push_back(behind);
    }
    ranges_ = std::move(kept);
}

void Coverage::remove(const Coverage& other) {
    for (const SampleRange& range : other.ranges_) remove(range);
}

bool Coverage::contains(SampleRange range) const {
    if (range.empty()) return true;
    const auto it = first_reaching(ranges_, range.end);
    return it != ranges_.end() && it->first <= range.first;
}

bool Coverage::contains(const Coverage& other) const {
    return std::all_of(other.ranges_.begin(), other.ranges_.end(), [this](const SampleRange& r) { return contains(r); });
}

bool Coverage::intersects(SampleRange range) const {
    if (range.empty()) return false;
    const auto it = first_reaching(ranges_, range.first + 1);
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
