// tools/develop/engine/subset.h: some runs of a run set, seen as a run set: what a quick preview is developed from.
#pragma once

#include <cstdint>
#include <vector>

#include "sampledb/read/run_set_view.h"

namespace latent::develop {

// The numbers of all runs in an order that has nothing to do with where their samples lie, and is a function of the set of runs:
// any number of them from the front is a fair choice, and more of them is a better picture of the same.
std::vector<std::uint32_t> shuffled_runs(const sampledb::RunSet& all);

// How many of these, from the front, hold at least `fraction` of all samples; at least one, if there is any.
std::size_t count_for(const sampledb::RunSet& all, const std::vector<std::uint32_t>& order, double fraction);

class Subset final : public sampledb::RunSetView {
 public:
    Subset(const sampledb::RunSet& all, std::vector<std::uint32_t> runs);

    const std::vector<sampledb::SelectedRun>& runs() const override { return runs_; }
    const sampledb::Coverage& coverage() const override { return coverage_; }
    std::uint64_t list_memory() const override { return all_.list_memory() + runs_.size() * sizeof(sampledb::SelectedRun); }
    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override {
        return all_.pages(numbers_[run]);
    }
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override {
        return all_.read_page(numbers_[run], info, columns, decoder, page);
    }
    void will_read(std::size_t run, const sampledb::PageInfo& first, const sampledb::PageInfo& last) const override {
        all_.will_read(numbers_[run], first, last);
    }
    std::uint64_t bytes_read() const override { return all_.bytes_read() - read_before_; }

 private:
    std::vector<std::uint32_t> numbers_;  // in `all_`
    std::vector<sampledb::SelectedRun> runs_;
    sampledb::Coverage coverage_;
    std::uint64_t read_before_;
};

}  // namespace latent::develop
