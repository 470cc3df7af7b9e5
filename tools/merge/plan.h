// tools/merge/plan.h: what the output will hold, in its order: runs as they are, or groups of them made into one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampledb/read/run_set.h"

namespace latent::merge {

// One run of the output: from run `first` of a run set, or from `first` .. `end`-1.
struct Step {
    std::uint32_t first = 0, end = 0;
    bool compacted() const { return end - first > 1; }
};

// `compact`: groups as compact_groups makes them within `memory`; else every run for itself.
std::vector<Step> make_plan(const sampledb::RunSet& run_set, bool compact, std::uint64_t memory);

// How many steps at the front of two plans are the same, though their run sets number files and runs differently.
std::size_t same_steps(const sampledb::RunSet& a, const std::vector<Step>& a_plan, const sampledb::RunSet& b,
                       const std::vector<Step>& b_plan);

}  // namespace latent::merge
