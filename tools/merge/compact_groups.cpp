#include "tools/merge/compact_groups.h"

#include <algorithm>
#include <span>

#include "sampledb/codec/run_codec.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/page.h"

namespace latent::merge {

using namespace sampledb;

namespace {

// Whether a run covers nothing but whole intervals of S samples.
bool covers_whole_intervals(const Coverage& coverage, std::uint64_t run_samples) {
    return std::ranges::all_of(coverage.ranges(), [&](const SampleRange& range) {
        return range.first % run_samples == 0 && range.end % run_samples == 0;
    });
}

// Bytes that a run costs while it is compacted: decoded pages and the list of its pages.
std::uint64_t memory_of(const Job& job, const SelectedRun& run) {
    return 2 * page_memory(job) + 2 * run.header.page_count * sizeof(PageInfo);
}

}  // namespace

std::uint64_t page_memory(const Job& job) {
    const std::uint64_t pairs = job.kind == RecordKind::kSpectral ? max_page_records(job) * job.batch : 0;
    return decoded_page_size(job, RecordClass::kCamera, max_page_records(job), pairs);
}

std::vector<CompactGroup> compact_groups(const RunSet& run_set, std::uint64_t memory) {
    const std::vector<SelectedRun>& runs = run_set.runs();
    const std::uint64_t run_samples = run_set.job().run_samples;
    std::vector<CompactGroup> groups;
    CompactGroup group{0, 0};
    std::uint64_t group_memory = 0, group_pages = 0, group_intervals = 0;
    std::uint64_t group_reaches = 0;  // the end of its last interval
    const auto close = [&](std::size_t next) {
        if (group.end - group.first > 1) groups.push_back(group);
        group = {next, next};
        group_memory = group_pages = group_intervals = 0;
    };
    for (std::size_t i = 0; i < runs.size();) {
        // The runs of one interval; or one run that is whole intervals already.
        const std::uint64_t interval = runs[i].header.samples.first / run_samples;
        Coverage coverage = runs[i].coverage;
        std::size_t end = i + 1;
        while (!covers_whole_intervals(coverage, run_samples) && end < runs.size() &&
               runs[end].header.samples.first / run_samples == interval) {
            coverage.add(runs[end++].coverage);
        }
        if (!covers_whole_intervals(coverage, run_samples)) {
            close(end);
            i = end;
            continue;
        }
        std::uint64_t more_memory = 0, more_pages = 0;
        for (std::size_t j = i; j < end; ++j) {
            more_memory += memory_of(run_set.job(), runs[j]);
            more_pages += runs[j].header.page_count;
        }
        const std::span<const SampleRange> intervals = coverage.ranges();
        const std::uint64_t joins = group_intervals > 0 && intervals.front().first == group_reaches ? 1 : 0;
        std::uint64_t more_intervals = intervals.size() - joins;  // more than there will be, if they fill gaps
        if (group_memory + more_memory > memory / 2 || group_pages + more_pages > kMaxPagesPerRun / 2 ||
            group_intervals + more_intervals > kMaxIntervalsPerRun) {
            close(i);
            more_intervals = intervals.size();
        }
        group.end = i = end;
        group_memory += more_memory;
        group_pages += more_pages;
        group_intervals += more_intervals;
        group_reaches = intervals.back().end;
    }
    close(runs.size());
    return groups;
}

}  // namespace latent::merge
