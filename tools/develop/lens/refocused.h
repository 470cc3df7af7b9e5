// tools/develop/lens/refocused.h: the pages of a run set where a lens that is focused elsewhere would have put their records.
// docs/developing.md, "Focus".
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "sampledb/read/run_set.h"

namespace latent::develop {

// Pages lie in larger nodes than those of the files: in the smallest that hold what their records may be moved to, by
// LensWeights::move.
class Refocused final : public sampledb::RunSet {
 public:
    // `all` must outlive it.
    Refocused(const sampledb::RunSet& all, const std::array<double, 2>& shift) : all_(all), shift_(shift) {}

    const sampledb::Job& job() const override { return all_.job(); }
    const std::vector<std::filesystem::path>& files() const override { return all_.files(); }
    const std::vector<sampledb::SelectedRun>& runs() const override { return all_.runs(); }
    const sampledb::Coverage& coverage() const override { return all_.coverage(); }
    const sampledb::RunSetReport& report() const override { return all_.report(); }
    std::optional<sampledb::Resolution> resolution() const override { return all_.resolution(); }
    std::uint64_t list_memory() const override { return all_.list_memory(); }
    Result<std::shared_ptr<const std::vector<sampledb::PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const sampledb::PageInfo& info, const sampledb::ColumnSet& columns,
                     sampledb::PageDecoder& decoder, sampledb::Page& page) const override;
    void will_read(std::size_t run, const sampledb::PageInfo& first, const sampledb::PageInfo& last) const override {
        all_.will_read(run, first, last);
    }
    std::uint64_t bytes_read() const override { return all_.bytes_read(); }

 private:
    sampledb::FilmNode reached_from(const sampledb::FilmNode& node) const;

    const sampledb::RunSet& all_;
    std::array<double, 2> shift_;
};

}  // namespace latent::develop
