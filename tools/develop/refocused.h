// tools/develop/refocused.h: the records of a gathering as a lens focused elsewhere would have put them on the film.
// docs/developing.md, "Focus".
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "sampledb/read/gathering.h"

namespace latent::develop {

// Each record lies at (u, v) + shift x its point of the lens; those off the film are left out. Pages may lie in larger nodes than
// those of the files; in a page, records are sorted along the Z curve.
class Refocused final : public sampledb::Gathering {
 public:
    // `all`, whose job has the columns of the lens, must outlive it.
    Refocused(const sampledb::Gathering& all, const std::array<double, 2>& shift);

    const sampledb::Job& job() const override { return all_.job(); }
    const std::vector<std::filesystem::path>& files() const override { return all_.files(); }
    const std::vector<sampledb::SelectedRun>& runs() const override { return all_.runs(); }
    const sampledb::Coverage& coverage() const override { return all_.coverage(); }
    const sampledb::GatherReport& report() const override { return all_.report(); }
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
    void move(sampledb::Page& page) const;

    const sampledb::Gathering& all_;
    std::array<double, 2> shift_;
    std::array<std::size_t, 2> columns_;  // of the lens
};

}  // namespace latent::develop
