#include "sampledb/http/range_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <future>

#include "base/url.h"

namespace latent::sampledb {

namespace {
constexpr std::uint64_t kStretch = 4 << 20;  // bytes that a long read asks for at once
constexpr std::uint64_t kKeeping = 512;      // bytes of memory beside those of a range
}  // namespace

Result<RemoteFile> RangeCache::open(const std::string& url) {
    std::promise<Result<Fetched>> promise;
    transfers_.add({url, 0, kOpening, {}, [&](Result<Fetched> fetched) { promise.set_value(std::move(fetched)); }}, true);
    Result<Fetched> fetched = promise.get_future().get();
    if (!fetched) return fetched.error();
    const std::lock_guard lock(mutex_);
    RemoteFile file{++files_, url, fetched->version};
    if (fetched->bytes.empty()) return file;
    const RangePointer opening = add(file, 0, fetched->bytes.size());
    finish(opening, std::move(fetched));
    return file;
}

Status RangeCache::read(const RemoteFile& file, std::uint64_t offset, std::span<std::byte> into) {
    if (offset > file.version.size || into.size() > file.version.size - offset)
        return Error{ErrorCode::kTruncated, fmt::format("{}: ends at byte {}", shown_name(file.url), file.version.size)};
    while (!into.empty()) {
        const std::span<std::byte> stretch = into.first(std::min<std::size_t>(into.size(), kStretch));
        if (Status s = wait_and_copy(cover(file, offset, offset + stretch.size()), offset, stretch); !s) return s;
        offset += stretch.size();
        into = into.subspan(stretch.size());
    }
    return {};
}

void RangeCache::announce(const RemoteFile& file, std::uint64_t offset, std::uint64_t length) {
    if (offset >= file.version.size) return;
    const std::uint64_t end = offset + std::min(length, file.version.size - offset);
    const std::lock_guard lock(mutex_);
    for (std::uint64_t at = offset; at < end && on_their_way_ < kMaxAhead;) {
        if (const RangePointer there = find(file, at)) {
            at = there->end;
        } else {
            const std::uint64_t stop = std::min({end, hole_at(file, at).end, at + kTransfer});
            plan(file, at, stop);
            at = stop;
        }
    }
}

// The range that holds byte `at`; null: none does.
RangeCache::RangePointer RangeCache::find(const RemoteFile& file, std::uint64_t at) {
    const auto next = ranges_.upper_bound({file.number, at});
    if (next == ranges_.begin()) return nullptr;
    const RangePointer& range = std::prev(next)->second;
    if (range->file.number != file.number || range->end <= at) return nullptr;
    if (range->is_here) recent_.splice(recent_.begin(), recent_, range->place);
    return range;
}

// The bytes around byte `at` that no range holds.
RangeCache::Hole RangeCache::hole_at(const RemoteFile& file, std::uint64_t at) const {
    const auto next = ranges_.upper_bound({file.number, at});
    Hole hole{0, file.version.size};
    if (next != ranges_.end() && next->first.first == file.number) hole.end = next->second->begin;
    if (next != ranges_.begin() && std::prev(next)->first.first == file.number) hole.begin = std::prev(next)->second->end;
    return hole;
}

RangeCache::RangePointer RangeCache::add(const RemoteFile& file, std::uint64_t begin, std::uint64_t end) {
    assert(begin < end && hole_at(file, begin).end >= end && !find(file, begin));
    auto range = std::make_shared<Range>();
    range->file = file;
    range->begin = begin;
    range->end = end;
    ranges_[{file.number, begin}] = range;
    on_their_way_ += end - begin;
    return range;
}

// Gets bytes that no range holds along with those that were planned before, if these are near.
void RangeCache::plan(const RemoteFile& file, std::uint64_t begin, std::uint64_t end) {
    const bool is_near = planned_ && planned_->file.number == file.number && begin >= planned_->end &&
                         begin - planned_->end <= kGap && end - planned_->begin <= kTransfer &&
                         hole_at(file, begin).begin == planned_->end;
    if (!is_near) {
        ask_for_planned(false);
        planned_ = add(file, begin, end);
        return;
    }
    on_their_way_ += end - planned_->end;
    planned_->end = end;
}

void RangeCache::ask_for_planned(bool urgent) {
    if (planned_) ask(std::exchange(planned_, nullptr), urgent);
}

void RangeCache::ask(const RangePointer& range, bool urgent) {
    const Status added = caught([&]() -> Status {
        const auto done = [this, range](Result<Fetched> fetched) {
            const std::lock_guard lock(mutex_);
            finish(range, std::move(fetched));
        };
        transfers_.add({range->file.url, range->begin, range->end - range->begin, range->file.version, done}, urgent);
        return {};
    });
    if (!added) finish(range, added.error());
}

// One has arrived, or will not.
void RangeCache::finish(const RangePointer& range, Result<Fetched> fetched) {
    const Key key{range->file.number, range->begin};
    on_their_way_ -= range->end - range->begin;
    range->is_here = true;
    if (fetched) {
        range->bytes = std::move(fetched->bytes);
        range->place = recent_.insert(recent_.begin(), key);
        held_ += range->bytes.size() + kKeeping;
    } else {
        range->status = fetched.error();
        ranges_.erase(key);  // a later read may fare better
    }
    while (held_ > kCapacity) {
        const auto oldest = ranges_.find(recent_.back());
        held_ -= oldest->second->bytes.size() + kKeeping;
        ranges_.erase(oldest);
        recent_.pop_back();
    }
    arrived_.notify_all();
}

// The ranges that hold bytes begin .. end-1, which are requested unless they were before.
std::vector<RangeCache::RangePointer> RangeCache::cover(const RemoteFile& file, std::uint64_t begin, std::uint64_t end) {
    const std::lock_guard lock(mutex_);
    std::vector<RangePointer> ranges;
    for (std::uint64_t at = begin; at < end; at = ranges.back()->end) {
        RangePointer range = find(file, at);
        if (!range) {
            const Hole hole = hole_at(file, at);
            const std::uint64_t from = std::max(at / kUnit * kUnit, hole.begin), to = (end + kUnit - 1) / kUnit * kUnit;
            range = add(file, from, std::min({to, hole.end, from + kTransfer}));
            ask(range, true);
        }
        ranges.push_back(std::move(range));
    }
    const bool waits = std::ranges::any_of(ranges, [](const RangePointer& range) { return !range->is_here; });
    if (waits) ask_for_planned(std::ranges::find(ranges, planned_) != ranges.end());
    return ranges;
}

Status RangeCache::wait_and_copy(const std::vector<RangePointer>& ranges, std::uint64_t offset, std::span<std::byte> into) {
    for (const RangePointer& range : ranges) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, [&] { return range->is_here; });
        }
        if (!range->status) return range->status;
        const std::size_t skip = offset - range->begin, count = std::min(range->bytes.size() - skip, into.size());
        std::copy_n(range->bytes.begin() + static_cast<std::ptrdiff_t>(skip), count, into.begin());
        into = into.subspan(count);
        offset += count;
    }
    return {};
}

}  // namespace latent::sampledb
