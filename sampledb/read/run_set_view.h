// sampledb/read/run_set_view.h: a run set whose pages are seen otherwise.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sampledb/read/run_set.h"

namespace latent::sampledb {

// All is as in `all`, which must outlive it, but for what a class derived from this says of pages and of reading them.
class RunSetView : public RunSet {
 public:
    explicit RunSetView(const RunSet& all) : all_(all) {}

    const Job& job() const override { return all_.job(); }
    const std::vector<std::filesystem::path>& files() const override { return all_.files(); }
    const std::vector<SelectedRun>& runs() const override { return all_.runs(); }
    const Coverage& coverage() const override { return all_.coverage(); }
    const RunSetReport& report() const override { return all_.report(); }
    std::optional<Resolution> resolution() const override { return all_.resolution(); }
    std::uint64_t list_memory() const override { return all_.list_memory(); }
    void will_read(std::size_t run, const PageInfo& first, const PageInfo& last) const override {
        all_.will_read(run, first, last);
    }
    std::uint64_t bytes_read() const override { return all_.bytes_read(); }

 protected:
    const RunSet& all_;
};

}  // namespace latent::sampledb
