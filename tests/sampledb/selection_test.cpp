// Which runs are chosen is a function of the set of runs.
#include "sampledb/read/selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

namespace latent::sampledb {
namespace {

SelectedRun run(const Coverage& coverage, std::uint64_t hash = 0) {
    SelectedRun c;
    c.coverage = coverage;
    c.header.samples = {coverage.ranges().front().first, coverage.ranges().back().end};
    c.header.sample_count = coverage.size();
    c.header.interval_count = static_cast<std::uint32_t>(coverage.ranges().size());
    c.header.content_hash = {hash, hash};
    return c;
}
SelectedRun run(std::uint64_t first, std::uint64_t end, std::uint64_t hash = 0) {
    return run(Coverage(SampleRange{first, end}), hash);
}

std::vector<Coverage> chosen(const std::vector<SelectedRun>& candidates) {
    std::vector<Coverage> coverages;
    for (const std::size_t i : select_runs(candidates).chosen) coverages.push_back(candidates[i].coverage);
    return coverages;
}
std::vector<Coverage> list(std::initializer_list<SampleRange> ranges) {
    std::vector<Coverage> coverages;
    for (const SampleRange& range : ranges) coverages.emplace_back(range);
    return coverages;
}

TEST(Selection, ACanonicalRunSupersedesItsCheckpoints) {
    const Selection s = select_runs(std::vector{run(0, 3), run(3, 6), run(0, 8), run(8, 16)});
    EXPECT_EQ(s.chosen, (std::vector<std::size_t>{2, 3}));
    EXPECT_EQ(s.superseded.size(), 2u);
    EXPECT_TRUE(s.overlapping.empty() && s.repeated.empty() && s.differing.empty());
}

TEST(Selection, TheAttemptWithTheMostSamplesIsTaken) {
    EXPECT_EQ(chosen({run(0, 3), run(3, 6), run(0, 5)}), list({{0, 3}, {3, 6}}));
    EXPECT_EQ(chosen({run(0, 3), run(3, 6), run(0, 7)}), list({{0, 7}}));
    EXPECT_EQ(chosen({run(0, 3), run(3, 6), run(6, 8)}), list({{0, 3}, {3, 6}, {6, 8}}));  // whoever wrote them
}

TEST(Selection, ACompactedRunSupersedesWhatItWasMadeFrom) {
    EXPECT_EQ(chosen({run(0, 8), run(8, 16), run(16, 24), run(0, 16)}), list({{0, 16}, {16, 24}}));
    Coverage gaps(SampleRange{0, 8});
    gaps.add({16, 24});
    const std::vector<SelectedRun> all = {run(0, 8), run(8, 16), run(16, 24), run(gaps)};
    const Selection s = select_runs(all);
    EXPECT_EQ(s.chosen, (std::vector<std::size_t>{3, 1}));
    EXPECT_EQ(s.superseded.size(), 2u);
    EXPECT_EQ(chosen({run(gaps), run(0, 32)}), list({{0, 32}}));
}

TEST(Selection, RepeatsAreDroppedAndTheSmallerHashIsKept) {
    const Selection same = select_runs(std::vector{run(0, 8, 5), run(0, 8, 5)});
    EXPECT_EQ(same.chosen.size(), 1u);
    EXPECT_EQ(same.repeated.size(), 1u);
    const Selection other = select_runs(std::vector{run(0, 8, 7), run(0, 8, 5)});
    EXPECT_EQ(other.chosen, (std::vector<std::size_t>{1}));
    EXPECT_EQ(other.differing, (std::vector<std::size_t>{0}));
}

TEST(Selection, SamplesThatAreLostAreReported) {
    const Selection s = select_runs(std::vector{run(0, 16), run(8, 20)});
    EXPECT_EQ(s.chosen, (std::vector<std::size_t>{0}));
    EXPECT_EQ(s.overlapping, (std::vector<std::size_t>{1}));
}

std::uint32_t bits_of(const Coverage& coverage) {
    std::uint32_t set = 0;
    for (const SampleRange& r : coverage.ranges()) {
        for (std::uint64_t n = r.first; n < r.end; ++n) set |= 1u << n;
    }
    return set;
}

// The rule for runs with gaps word by word.
std::vector<std::uint32_t> chosen_with_gaps(const std::vector<SelectedRun>& runs) {
    std::vector<const SelectedRun*> left;
    for (const SelectedRun& run : runs) {
        const std::uint32_t own = bits_of(run.coverage);
        const bool inside = std::ranges::any_of(runs, [&](const SelectedRun& other) {
            return bits_of(other.coverage) != own && (own & ~bits_of(other.coverage)) == 0;
        });
        if (run.coverage.ranges().size() > 1 && !inside) left.push_back(&run);
    }
    std::ranges::sort(left, {}, [](const SelectedRun* run) {
        return std::tuple(-static_cast<int>(run->coverage.size()), run->header.samples.end, run->header.samples.first,
                          std::vector(run->coverage.ranges().begin(), run->coverage.ranges().end()));
    });
    std::uint32_t taken = 0;
    std::vector<std::uint32_t> sets;
    for (const SelectedRun* run : left) {
        const std::uint32_t own = bits_of(run->coverage);
        if ((own & taken) != 0) continue;
        taken |= own;
        sets.push_back(own);
    }
    std::ranges::sort(sets);
    return sets;
}

TEST(Selection, RunsWithGapsAreTakenByTheRule) {
    std::mt19937 random(12);
    for (int trial = 0; trial < 3000; ++trial) {
        std::vector<SelectedRun> runs;
        for (int i = 0; i < 10; ++i) {
            Coverage coverage;
            const std::uint64_t first = random() % 12, span = 2 + random() % 20;
            for (std::uint64_t n = first; n < first + span; ++n) {
                if (random() % 4 != 0) coverage.add({n, n + 1});
            }
            const bool repeated = std::ranges::any_of(runs, [&](const SelectedRun& other) { return other.coverage == coverage; });
            if (!coverage.empty() && !repeated) runs.push_back(run(coverage));
        }
        std::vector<std::uint32_t> sets;
        for (const std::size_t i : select_runs(runs).chosen) {
            if (runs[i].coverage.ranges().size() > 1) sets.push_back(bits_of(runs[i].coverage));
        }
        std::ranges::sort(sets);
        ASSERT_EQ(sets, chosen_with_gaps(runs));
    }
}

// Random sets of intervals, small enough to try every subset.
TEST(Selection, CoversTheMostWithTheFewestRunsInAnyOrder) {
    std::mt19937 random(9);
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<SelectedRun> candidates;
        for (int i = 0; i < 9; ++i) {
            const std::uint64_t first = random() % 24;
            candidates.push_back(run(first, first + 1 + random() % 10, random() % 3));
        }
        std::uint64_t most = 0;
        int fewest = 0;
        for (unsigned subset = 0; subset < 1u << candidates.size(); ++subset) {
            Coverage covered;
            bool disjoint = true;
            for (std::size_t i = 0; i < candidates.size(); ++i) {
                if ((subset >> i & 1) == 0) continue;
                disjoint = disjoint && !covered.intersects(candidates[i].coverage);
                covered.add(candidates[i].coverage);
            }
            const int runs = std::popcount(subset);
            if (disjoint && (covered.size() > most || (covered.size() == most && runs < fewest)))
                most = covered.size(), fewest = runs;
        }
        const Selection s = select_runs(candidates);
        EXPECT_EQ(s.coverage.size(), most);
        EXPECT_EQ(static_cast<int>(s.chosen.size()), fewest);
        EXPECT_EQ(s.chosen.size() + s.superseded.size() + s.repeated.size() + s.differing.size() + s.overlapping.size(),
                  candidates.size());

        std::vector<SelectedRun> shuffled = candidates;
        std::ranges::shuffle(shuffled, random);
        const Selection again = select_runs(shuffled);
        ASSERT_EQ(again.chosen.size(), s.chosen.size());
        for (std::size_t i = 0; i < s.chosen.size(); ++i) {
            EXPECT_EQ(shuffled[again.chosen[i]].coverage, candidates[s.chosen[i]].coverage);
            EXPECT_EQ(shuffled[again.chosen[i]].header, candidates[s.chosen[i]].header);
        }
    }
}

}  // namespace
}  // namespace latent::sampledb
