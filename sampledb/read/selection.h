// sampledb/read/selection.h: the one rule by which every tool chooses runs when several hold the same samples. docs/format.md,
// "Selection".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampledb/data/coverage.h"
#include "sampledb/format/run_header.h"

namespace latent::sampledb {

// A run of one of several files: at first one to choose from, then one that was chosen.
struct SelectedRun {
    std::uint32_t file = 0;    // which of them; has no say in the choice
    bool cut = false;          // only part of it counts: its pages are filtered when they are read
    std::uint64_t offset = 0;  // where the run's first byte is in its file
    RunHeader header;          // its counts and hashes; header.size() bytes on disk
    Coverage coverage;         // what it holds completely (one interval unless compacted), less what is cut off
};

// Indices into the runs; each stands in exactly one list.
struct Selection {
    std::vector<std::size_t> chosen;       // ascending by first sample; their coverages are disjoint
    std::vector<std::size_t> superseded;   // all their samples are covered by chosen runs
    std::vector<std::size_t> repeated;     // the same coverage and content as another
    std::vector<std::size_t> differing;    // the same coverage as another, but other content, with the larger hash
    std::vector<std::size_t> overlapping;  // overlaps chosen runs, and its other samples are lost
    Coverage coverage;                     // what the chosen runs cover
};

// Chooses, among all sets of disjoint runs, those that cover the most samples, and among these the smallest: so a canonical run
// wins over its checkpoints, a longer attempt over a shorter one, a compacted run over what it was made from. A function of the
// set of runs, not of their order or of the files that they are in.
Selection select_runs(std::span<const SelectedRun> runs);

}  // namespace latent::sampledb
