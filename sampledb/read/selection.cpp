#include "sampledb/read/selection.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace latent::sampledb {

namespace {

using Indices = std::vector<std::size_t>;

bool has_gaps(const Candidate& c) { return c.coverage.ranges().size() > 1; }

// Total order in which nothing but (job, coverage, bytes) has a say: equal coverages stand together, the smaller hash first.
bool before(const Candidate& a, const Candidate& b) {
    const auto key = [](const Candidate& c) {
        const RunHeader& header = c.run.header;
        return std::tie(header.samples.end, header.samples.first, c.coverage.ranges(), header.content_hash, header.pages_size,
                        header.index_hash);
    };
    return key(a) < key(b);
}

// Runs with gaps, made by compaction only, cannot take part in the choice below: the largest are taken first.
void choose_runs_with_gaps(std::span<const Candidate> candidates, const Indices& order, Selection& selection) {
    Indices gapped;
    for (const std::size_t i : order) {
        if (!has_gaps(candidates[i])) continue;
        const auto contains_it = [&](std::size_t j) { return i != j && candidates[j].coverage.contains(candidates[i].coverage); };
        if (std::ranges::none_of(order, contains_it)) gapped.push_back(i);
    }
    std::ranges::stable_sort(gapped, std::greater{}, [&](std::size_t i) { return candidates[i].run.header.sample_count; });
    for (const std::size_t i : gapped) {
        if (selection.coverage.intersects(candidates[i].coverage)) continue;
        selection.coverage.add(candidates[i].coverage);
        selection.chosen.push_back(i);
    }
}

// The best set of disjoint intervals, by dynamic programming over their ends.
void choose_intervals(std::span<const Candidate> candidates, const Indices& order, Selection& selection) {
    Indices free;
    for (const std::size_t i : order) {
        if (!has_gaps(candidates[i]) && !selection.coverage.intersects(candidates[i].coverage)) free.push_back(i);
    }
    struct Best {
        std::uint64_t samples = 0, runs = 0;
        bool takes = false;         // the last of the runs looked at
        std::size_t continues = 0;  // how many of the runs before it remain open to it
    };
    const auto range = [&](std::size_t k) { return candidates[free[k]].run.header.samples; };
    const auto before_end = [&](std::uint64_t sample, std::size_t i) { return sample < candidates[i].run.header.samples.end; };
    std::vector<Best> best(free.size() + 1);
    for (std::size_t k = 0; k < free.size(); ++k) {
        const auto overlaps =
            std::upper_bound(free.begin(), free.begin() + static_cast<std::ptrdiff_t>(k), range(k).first, before_end);
        const auto open = static_cast<std::size_t>(overlaps - free.begin());  // runs that end at or before this one begins
        const Best with{best[open].samples + range(k).size(), best[open].runs + 1, true, open};
        const bool better = with.samples > best[k].samples || (with.samples == best[k].samples && with.runs < best[k].runs);
        best[k + 1] = better ? with : Best{best[k].samples, best[k].runs, false, k};
    }
    for (std::size_t k = free.size(); k > 0; k = best[k].continues) {
        if (best[k].takes) selection.chosen.push_back(free[k - 1]);
    }
}

}  // namespace

Selection select_runs(std::span<const Candidate> candidates) {
    Selection selection;
    Indices order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return before(candidates[a], candidates[b]); });

    Indices distinct;  // one run for each coverage
    for (const std::size_t i : order) {
        if (distinct.empty() || candidates[distinct.back()].coverage != candidates[i].coverage) {
            distinct.push_back(i);
        } else {
            const bool same = candidates[distinct.back()].run.header.content_hash == candidates[i].run.header.content_hash;
            (same ? selection.repeated : selection.differing).push_back(i);
        }
    }
    choose_runs_with_gaps(candidates, distinct, selection);
    choose_intervals(candidates, distinct, selection);
    std::ranges::sort(selection.chosen, {}, [&](std::size_t i) { return candidates[i].run.header.samples.first; });
    selection.coverage = {};
    for (const std::size_t i : selection.chosen) selection.coverage.add(candidates[i].coverage);

    Indices chosen = selection.chosen;
    std::ranges::sort(chosen);
    for (const std::size_t i : distinct) {
        if (std::ranges::binary_search(chosen, i)) continue;
        (selection.coverage.contains(candidates[i].coverage) ? selection.superseded : selection.overlapping).push_back(i);
    }
    return selection;
}

}  // namespace latent::sampledb
