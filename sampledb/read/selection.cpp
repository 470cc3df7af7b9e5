#include "sampledb/read/selection.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

namespace latent::sampledb {

namespace {

using Runs = std::span<const SelectedRun>;
using Indices = std::vector<std::uint32_t>;

bool has_gaps(const SelectedRun& run) { return run.coverage.ranges().size() > 1; }

// Total order of (job, coverage, bytes) alone: equal coverages stand together, the smaller hash first.
bool before(const SelectedRun& a, const SelectedRun& b) {
    const RunHeader &x = a.header, &y = b.header;
    if (x.samples != y.samples) return std::tie(x.samples.end, x.samples.first) < std::tie(y.samples.end, y.samples.first);
    if (a.coverage != b.coverage) return std::ranges::lexicographical_compare(a.coverage.ranges(), b.coverage.ranges());
    return std::tie(x.content_hash, x.pages_size, x.index_hash) < std::tie(y.content_hash, y.pages_size, y.index_hash);
}

// A union that grows by coverages of many intervals: parts of falling size, so that each interval moves a few times only.
class GrowingCoverage {
 public:
    void add(Coverage coverage) {
        while (!parts_.empty() && parts_.back().ranges().size() <= 2 * coverage.ranges().size()) {
            coverage.add(parts_.back());
            parts_.pop_back();
        }
        parts_.push_back(std::move(coverage));
    }
    bool intersects(const Coverage& coverage) const {
        return std::ranges::any_of(parts_, [&](const Coverage& part) { return part.intersects(coverage); });
    }

 private:
    std::vector<Coverage> parts_;
};

Coverage union_of(Runs runs, const std::vector<std::size_t>& chosen) {
    std::size_t count = 0;
    for (const std::size_t i : chosen) count += runs[i].coverage.ranges().size();
    std::vector<SampleRange> ranges;
    ranges.reserve(count);
    for (const std::size_t i : chosen)
        ranges.insert(ranges.end(), runs[i].coverage.ranges().begin(), runs[i].coverage.ranges().end());
    return Coverage::of(std::move(ranges));
}

// Which runs hold all that another holds.
class Containment {
 public:
    // `order`: ascending by end.
    Containment(Runs runs, const Indices& order) : runs_(runs) {
        std::uint64_t first = ~std::uint64_t{0};
        for (auto at = order.rbegin(); at != order.rend(); ++at) {
            const SampleRange samples = runs[*at].header.samples;
            if (has_gaps(runs[*at])) {
                gapped_.push_back(*at);
            } else if (samples.first < first) {  // among the intervals that end there or later, the one that begins first
                whole_.push_back(samples);
                first = samples.first;
            }
        }
    }
    // Those with gaps, ascending by end.
    Indices gapped() const { return {gapped_.rbegin(), gapped_.rend()}; }

    bool is_contained(std::uint32_t i) const {
        const SelectedRun& run = runs_[i];
        const SampleRange samples = run.header.samples;
        const auto shorter = std::ranges::partition_point(whole_, [&](const SampleRange& r) { return r.end >= samples.end; });
        if (shorter != whole_.begin() && std::prev(shorter)->first <= samples.first) return true;
        return std::ranges::any_of(gapped_, [&](std::uint32_t j) {
            const SelectedRun& other = runs_[j];
            return other.header.sample_count > run.header.sample_count && other.header.samples.end >= samples.end &&
                   other.header.samples.first <= samples.first && other.coverage.contains(run.coverage);
        });
    }

 private:
    Runs runs_;
    Indices gapped_;                  // descending by end
    std::vector<SampleRange> whole_;  // runs without gaps, descending by end and by first sample
};

// Runs with gaps, made by compaction only, cannot take part in the choice below: the largest are taken first.
void choose_runs_with_gaps(Runs runs, const Indices& order, Selection& selection) {
    const Containment containment(runs, order);
    Indices gapped = containment.gapped();
    std::ranges::stable_sort(gapped, std::greater{}, [&](std::uint32_t i) { return runs[i].header.sample_count; });
    GrowingCoverage taken;
    for (const std::uint32_t i : gapped) {
        if (taken.intersects(runs[i].coverage) || containment.is_contained(i)) continue;
        taken.add(runs[i].coverage);
        selection.chosen.push_back(i);
    }
    selection.coverage = union_of(runs, selection.chosen);
}

// The best set of disjoint intervals, by dynamic programming over their ends.
void choose_intervals(Runs runs, const Indices& order, Selection& selection) {
    Indices free;
    for (const std::uint32_t i : order) {
        if (!has_gaps(runs[i]) && !selection.coverage.intersects(runs[i].coverage)) free.push_back(i);
    }
    struct Best {
        std::uint64_t samples = 0;
        std::uint32_t count = 0;  // number of runs
        std::uint32_t continues =
            0;  // how many of the runs before it remain open to it; itself less one if it does not take the last
    };
    const auto range = [&](std::size_t k) { return runs[free[k]].header.samples; };
    const auto before_end = [&](std::uint64_t sample, std::uint32_t i) { return sample < runs[i].header.samples.end; };
    std::vector<Best> best(free.size() + 1);
    std::vector<bool> takes(best.size());  // the last of the runs looked at
    for (std::size_t k = 0; k < free.size(); ++k) {
        const auto overlaps =
            std::upper_bound(free.begin(), free.begin() + static_cast<std::ptrdiff_t>(k), range(k).first, before_end);
        const auto open = static_cast<std::uint32_t>(overlaps - free.begin());  // runs that end at or before this one begins
        const Best with{best[open].samples + range(k).size(), best[open].count + 1, open};
        takes[k + 1] = with.samples > best[k].samples || (with.samples == best[k].samples && with.count < best[k].count);
        best[k + 1] = takes[k + 1] ? with : Best{best[k].samples, best[k].count, static_cast<std::uint32_t>(k)};
    }
    for (std::size_t k = free.size(); k > 0; k = best[k].continues) {
        if (takes[k]) selection.chosen.push_back(free[k - 1]);
    }
}

}  // namespace

Selection select_runs(Runs runs) {
    Selection selection;
    Indices order(runs.size());
    std::iota(order.begin(), order.end(), std::uint32_t{0});
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return before(runs[a], runs[b]); });

    Indices distinct;  // one run for each coverage
    for (const std::uint32_t i : order) {
        if (distinct.empty() || runs[distinct.back()].coverage != runs[i].coverage) {
            distinct.push_back(i);
        } else {
            const bool same = runs[distinct.back()].header.content_hash == runs[i].header.content_hash;
            (same ? selection.repeated : selection.differing).push_back(i);
        }
    }
    order = {};
    choose_runs_with_gaps(runs, distinct, selection);
    choose_intervals(runs, distinct, selection);
    std::ranges::sort(selection.chosen, {}, [&](std::size_t i) { return runs[i].header.samples.first; });
    selection.coverage = union_of(runs, selection.chosen);

    std::vector<bool> chosen(runs.size());
    for (const std::size_t i : selection.chosen) chosen[i] = true;
    for (const std::uint32_t i : distinct) {
        if (chosen[i]) continue;
        (selection.coverage.contains(runs[i].coverage) ? selection.superseded : selection.overlapping).push_back(i);
    }
    return selection;
}

}  // namespace latent::sampledb
