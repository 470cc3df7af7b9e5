#include "sampledb/write/run_assembler.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace latent::sampledb {

RunAssembler::RunAssembler(const Job& job, SampleRange range)
    : run_samples_(job.run_samples), run_bytes_(job.run_bytes), range_(range), next_(range.first), boundary_(range.first) {}

std::vector<AssembledRun> RunAssembler::add(GrainPtr grain) {
    assert(grain->range.first == next_ && grain->range.end <= range_.end);
    std::vector<AssembledRun> closed;
    const std::uint64_t raw = grain->records.raw_bytes();
    if (raw > run_bytes_ || bytes_ > run_bytes_ - raw) close(closed);
    bytes_ += raw;
    next_ = grain->range.end;
    grains_.push_back(std::move(grain));
    if (next_ % run_samples_ == 0 || done()) close(closed);
    return closed;
}

std::vector<AssembledRun> RunAssembler::skip(SampleRange stored) {
    assert(stored.first == next_ && stored.end <= range_.end);
    std::vector<AssembledRun> closed;
    close(closed);
    next_ = boundary_ = stored.end;
    return closed;
}

void RunAssembler::close(std::vector<AssembledRun>& closed) {
    if (!grains_.empty()) closed.push_back({{boundary_, next_}, std::exchange(grains_, {})});
    boundary_ = next_;
    bytes_ = 0;
}

SampleRange grain_range(std::uint64_t sample, SampleRange range) {
    const std::uint64_t first = sample - sample % kGrainSamples;
    return {std::max(first, range.first), range.end - first > kGrainSamples ? first + kGrainSamples : range.end};
}

std::vector<GrainPtr> split(const Records& records, const Coverage& coverage, SampleRange range) {
    std::vector<GrainPtr> grains;
    std::size_t row = 0, first_pair = 0;
    const Coverage within = coverage.intersection(Coverage(range));
    for (const SampleRange& interval : within.ranges()) {
        for (std::uint64_t first = interval.first; first < interval.end;) {
            Grain grain{grain_range(first, range), records.without_rows()};
            const bool whole = grain.range.first >= interval.first && grain.range.end <= interval.end;
            for (; row < records.size() && records.sample[row] < grain.range.end; ++row) {
                if (whole && records.sample[row] >= grain.range.first) grain.records.append(records, row, first_pair);
                if (!records.pairs.empty()) first_pair += records.pairs[row];
            }
            first = grain.range.end;
            if (whole) grains.push_back(std::make_shared<const Grain>(std::move(grain)));
        }
    }
    return grains;
}

}  // namespace latent::sampledb
