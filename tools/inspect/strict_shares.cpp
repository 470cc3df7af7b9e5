#include "tools/inspect/strict_shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace latent::inspect {

using namespace sampledb;

namespace {

constexpr std::uint64_t kMarked = std::uint64_t{1} << 25;  // samples with marks at once: 8 MiB
constexpr std::uint64_t kAdded = std::uint64_t{1} << 21;   // samples with sums at once: 8 MiB
constexpr float kTolerance = 0x1p-12f;                     // 1024 shares, rounded and added up in float

}  // namespace

ShareCheck::ShareCheck(const Coverage& coverage, std::size_t number, Violations& violations)
    : ranges_(coverage.ranges()), run_(number), violations_(violations) {
    for (const SampleRange& range : ranges_) {
        ranks_.push_back(samples_);
        samples_ += range.size();
    }
}

std::uint64_t ShareCheck::rank(std::uint64_t sample) const {
    const auto behind = std::ranges::upper_bound(ranges_, sample, {}, &SampleRange::first);
    const auto i = static_cast<std::size_t>(behind - ranges_.begin()) - 1;
    return ranks_[i] + (sample - ranges_[i].first);
}

std::uint64_t ShareCheck::sample_of(std::uint64_t rank) const {
    const auto i = static_cast<std::size_t>(std::ranges::upper_bound(ranks_, rank) - ranks_.begin()) - 1;
    return ranges_[i].first + (rank - ranks_[i]);
}

void ShareCheck::add(const Page& page) { mark(page); }

void ShareCheck::mark(const Page& page) {
    if (page.record_class != RecordClass::kCamera) return;
    if (has_record_.empty()) {  // most of what a run claims to cover may be empty
        has_record_.resize(std::min(samples_, kMarked));
        has_one_.resize(has_record_.size());
    }
    for (std::size_t row = 0; row < page.count; ++row) {
        const std::uint64_t here = rank(page.sample[row]), at = here - begin_;
        if (here >= begin_ && at >= has_record_.size()) next_ = std::min(next_, here);
        if (here < begin_ || at >= has_record_.size() || !simple_) continue;
        const float share = share_of(page, row);
        has_record_[at] = true;
        simple_ = share == 0 || (share == 1 && !has_one_[at]);
        if (share == 1) has_one_[at] = true;
    }
}

bool ShareCheck::marks_are_good() const { return simple_ && has_record_ == has_one_; }

Status ShareCheck::finish(std::size_t pages, const ReadPage& read) {
    Page page;
    for (;;) {
        const std::uint64_t end = begin_ + std::min(samples_ - begin_, kMarked);
        if (!marks_are_good()) {
            for (std::uint64_t at = begin_; at < end; at += kAdded) {
                if (Status s = add_up(at, std::min(end, at + kAdded), pages, read); !s) return s;
            }
        }
        if (next_ == kNoRank) return {};
        begin_ = std::exchange(next_, kNoRank);
        has_record_.assign(has_record_.size(), false);
        has_one_.assign(has_one_.size(), false);
        simple_ = true;
        for (std::size_t i = 0; i < pages; ++i) {
            page.count = 0;
            if (Status s = read(i, page); !s) return s;
            mark(page);
        }
    }
}

// The shares of the samples of ranks `begin` .. `end`-1.
Status ShareCheck::add_up(std::uint64_t begin, std::uint64_t end, std::size_t pages, const ReadPage& read) {
    constexpr float kNone = -std::numeric_limits<float>::infinity();
    std::vector<float> sums(end - begin, kNone);
    Page page;
    for (std::size_t i = 0; i < pages; ++i) {
        page.count = 0;
        if (Status s = read(i, page); !s) return s;
        for (std::size_t row = 0; row < page.count; ++row) {
            const std::uint64_t at = rank(page.sample[row]) - begin;
            if (at >= sums.size()) continue;
            sums[at] = (sums[at] == kNone ? 0 : sums[at]) + share_of(page, row);
        }
    }
    for (std::uint64_t at = begin; at < end; ++at) {
        const float sum = sums[at - begin];
        if (sum == kNone || std::abs(sum - 1) <= kTolerance) continue;
        violations_.add(
            {.run = run_, .what = fmt::format("the shares of sample {} add up to {}", sample_of(at), sum), .wanted = "1"});
    }
    return {};
}

}  // namespace latent::inspect
