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

Coverage::Coverage(const Coverage& other)
    : one_(other.one_), many_(other.many_ ? std::make_unique<Ranges>(*other.many_) : nullptr) {}
Coverage::Coverage(Coverage&& other) noexcept : one_(std::exchange(other.one_, {})), many_(std::move(other.many_)) {}
Coverage& Coverage::operator=(const Coverage& other) { return *this = Coverage(other); }
Coverage& Coverage::operator=(Coverage&& other) noexcept {
    one_ = std::exchange(other.one_, {});
    many_ = std::move(other.many_);
    return *this;
}

void Coverage::set(Ranges ranges) {
    one_ = ranges.size() == 1 ? ranges.front() : SampleRange{};
    many_ = ranges.size() > 1 ? std::make_unique<Ranges>(std::move(ranges)) : nullptr;
}

Coverage Coverage::of(Ranges ranges) {
    std::ranges::sort(ranges);
    auto last = ranges.begin();  // end of the union, which grows in the same memory
    for (const SampleRange& range : ranges) {
        if (range.empty()) continue;
        if (last != ranges.begin() && range.first <= (last - 1)->end) {
            (last - 1)->end = std::max((last - 1)->end, range.end);
        } else {
            *last++ = range;
        }
    }
    ranges.erase(last, ranges.end());
    Coverage coverage;
    coverage.set(std::move(ranges));
    return coverage;
}

void Coverage::add(SampleRange range) {
    if (range.empty()) return;
    if (empty()) {
        one_ = range;
        return;
    }
    if (!many_) {
        if (range.first <= one_.end && one_.first <= range.end) {  // touching ranges join
            one_ = {std::min(one_.first, range.first), std::max(one_.end, range.end)};
        } else {
            set({std::min(one_, range), std::max(one_, range)});
        }
        return;
    }
    const auto first = first_reaching(many_->begin(), many_->end(), range.first);
    auto last = first;
    for (; last != many_->end() && last->first <= range.end; ++last) {
        range.first = std::min(range.first, last->first);
        range.end = std::max(range.end, last->end);
    }
    if (first == last) {
        many_->insert(first, range);
        return;
    }
    *first = range;
    many_->erase(first + 1, last);
    if (many_->size() == 1) set(std::move(*many_));
}

void Coverage::add(const Coverage& other) {
    if (!other.many_) return add(other.one_);
    const std::span<const SampleRange> own = ranges();
    Ranges both;
    both.reserve(own.size() + other.many_->size());
    auto a = own.begin();
    auto b = other.many_->begin();
    while (a != own.end() || b != other.many_->end()) {
        const bool from_a = b == other.many_->end() || (a != own.end() && *a < *b);
        append(both, from_a ? *a++ : *b++);
    }
    set(std::move(both));
}

void Coverage::remove(SampleRange range) {
    if (range.empty() || empty()) return;
    if (!many_) {
        const SampleRange before{one_.first, std::min(one_.end, range.first)}, behind{std::max(one_.first, range.end), one_.end};
        Ranges rest;
        for (const SampleRange& left : {before, behind}) append(rest, left);
        return set(std::move(rest));
    }
    auto first = first_reaching(many_->begin(), many_->end(), range.first);
    if (first != many_->end() && first->end == range.first) ++first;  // only touches it
    auto last = first;
    while (last != many_->end() && last->first < range.end) ++last;
    if (first == last) return;
    const SampleRange before{first->first, range.first}, behind{range.end, (last - 1)->end};
    if (!before.empty()) *first++ = before;
    if (!behind.empty() && first == last) {  // the hole is inside one interval
        many_->insert(first, behind);
        return;
    }
    if (!behind.empty()) *--last = behind;
    many_->erase(first, last);
    if (many_->size() <= 1) set(std::move(*many_));
}

void Coverage::remove(const Coverage& other) {
    if (!other.many_) return remove(other.one_);
    const std::span<const SampleRange> holes = *other.many_;
    Ranges rest;
    rest.reserve(ranges().size());
    auto b = first_reaching(holes.begin(), holes.end(), empty() ? 0 : ranges().front().first);
    for (SampleRange left : ranges()) {
        for (; b != holes.end() && b->first < left.end; ++b) {
            append(rest, {left.first, std::min(left.end, b->first)});
            left.first = std::max(left.first, b->end);
            if (b->end >= left.end) break;  // it may reach into the next interval
        }
        append(rest, left);
    }
    set(std::move(rest));
}

bool Coverage::contains(std::uint64_t sample) const {
    const std::span<const SampleRange> all = ranges();
    const auto it = std::ranges::upper_bound(all, sample, {}, &SampleRange::end);
    return it != all.end() && it->first <= sample;
}

bool Coverage::contains(SampleRange range) const {
    if (range.empty()) return true;
    const std::span<const SampleRange> all = ranges();
    const auto it = first_reaching(all.begin(), all.end(), range.end);
    return it != all.end() && it->first <= range.first;
}

bool Coverage::contains(const Coverage& other) const {
    return std::ranges::all_of(other.ranges(), [this](const SampleRange& r) { return contains(r); });
}

bool Coverage::intersects(SampleRange range) const {
    if (range.empty()) return false;
    const std::span<const SampleRange> all = ranges();
    const auto it = first_reaching(all.begin(), all.end(), range.first + 1);
    return it != all.end() && it->first < range.end;
}

bool Coverage::intersects(const Coverage& other) const {
    return std::ranges::any_of(other.ranges(), [this](const SampleRange& r) { return intersects(r); });
}

Coverage Coverage::intersection(const Coverage& other) const {
    Ranges common;
    const std::span<const SampleRange> own = ranges(), others = other.ranges();
    if (own.empty() || others.empty()) return {};
    auto a = first_reaching(own.begin(), own.end(), others.front().first);
    auto b = first_reaching(others.begin(), others.end(), own.front().first);
    while (a != own.end() && b != others.end()) {
        const SampleRange both{std::max(a->first, b->first), std::min(a->end, b->end)};
        if (!both.empty()) common.push_back(both);
        (a->end < b->end ? a : b)++;
    }
    Coverage coverage;
    coverage.set(std::move(common));
    return coverage;
}

std::uint64_t Coverage::size() const {
    std::uint64_t samples = 0;
    for (const SampleRange& range : ranges()) samples += range.size();
    return samples;
}

std::string to_string(const Coverage& coverage, std::size_t most) {
    const std::span<const SampleRange> ranges = coverage.ranges();
    std::string text;
    for (std::size_t i = 0; i < std::min(most, ranges.size()); ++i) {
        text += fmt::format("{}{}:{}", i ? ", " : "", ranges[i].first, ranges[i].end);
    }
    if (ranges.size() > most) text += fmt::format(" and {} more", ranges.size() - most);
    return text.empty() ? "none" : text;
}

}  // namespace latent::sampledb
