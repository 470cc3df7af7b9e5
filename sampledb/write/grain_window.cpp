#include "sampledb/write/grain_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace latent::sampledb {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;  // in order, and out of order
constexpr std::uint64_t kGrainOverhead = 1024;                // what an empty grain costs

std::uint64_t size_of(const Grain& grain) { return grain.records.raw_bytes() + kGrainOverhead; }

}  // namespace

GrainWindow::GrainWindow(Coverage missing, SampleRange range)
    : range_(range), unsubmitted_(std::move(missing)), taken_(range.first), saved_(range.first) {}

bool GrainWindow::has_room(std::uint64_t first, std::uint64_t size) const {
    if (first != first_gap()) return out_of_order_bytes_ + size <= kMaxBytes;
    return in_order_bytes_ == 0 || in_order_bytes_ + size <= kMaxBytes;
}

Status GrainWindow::put(Grain grain) {
    const std::uint64_t size = size_of(grain);
    const SampleRange samples = grain.range;
    GrainPtr shared = std::make_shared<const Grain>(std::move(grain));
    Lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || given_up_ || has_room(samples.first, size); });
    if (closed_ || !has_room(samples.first, size)) return Error{ErrorCode::kStopped, "stopped before an older grain was finished"};
    if (samples.empty() || !unsubmitted_.contains(samples) || samples != grain_range(samples.first, range_))
        return Error{ErrorCode::kOutOfRange, fmt::format("samples {} are not a missing grain", to_string(Coverage(samples)))};

    const bool closes_gap = samples.first == first_gap();
    unsubmitted_.remove(samples);
    out_of_order_bytes_ += size;
    auto at = waiting_.emplace(samples.first, Submitted{std::move(shared), CheckpointClock::Clock::now()}).first;
    for (const std::uint64_t gap = first_gap(); closes_gap && at != waiting_.end() && at->first < gap; ++at) {
        const std::uint64_t moved = size_of(*at->second.grain);
        out_of_order_bytes_ -= moved;
        in_order_bytes_ += moved;
    }
    changed_.notify_all();
    changed_.wait(lock, [&] { return closed_ || given_up_ || !at_stake() || CheckpointClock::Clock::now() < late_at_; });
    return {};
}

void GrainWindow::give_up() {
    const Lock lock(mutex_);
    given_up_ = true;
    changed_.notify_all();
}

void GrainWindow::flush() {
    Lock lock(mutex_);
    const std::uint64_t finished = first_gap();
    flush_to_ = std::max(flush_to_, finished);
    changed_.notify_all();
    changed_.wait(lock, [&] { return closed_ || saved_ >= finished; });
}

Coverage GrainWindow::unsubmitted() const {
    const Lock lock(mutex_);
    return unsubmitted_;
}

GrainWindow::Submitted GrainWindow::take(std::uint64_t sample, Time deadline) {
    Lock lock(mutex_);
    const auto must_flush = [&] { return flush_to_ > saved_ && sample >= flush_to_; };
    changed_.wait_until(lock, deadline, [&] { return closed_ || must_flush() || waiting_.contains(sample); });
    if (flush_to_ <= saved_ && CheckpointClock::Clock::now() >= deadline) flush_to_ = first_gap();
    if (closed_ || must_flush() || !waiting_.contains(sample)) return {};
    Submitted taken = std::move(waiting_.extract(sample).mapped());
    in_order_bytes_ -= size_of(*taken.grain);
    taken_ = taken.grain->range.end;
    changed_.notify_all();
    return taken;
}

GrainWindow::Time GrainWindow::oldest() const {
    const Lock lock(mutex_);
    Time oldest = Time::max();
    for (const auto& [first, waiting] : waiting_) oldest = std::min(oldest, waiting.since);
    return oldest;
}

void GrainWindow::saved(std::uint64_t end, Time late_at) {
    const Lock lock(mutex_);
    saved_ = end;
    late_at_ = late_at;
    changed_.notify_all();
}

void GrainWindow::close() {
    const Lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

bool GrainWindow::closed() const {
    const Lock lock(mutex_);
    return closed_;
}

}  // namespace latent::sampledb
