// tools/inspect/strict_shares.h: do the shares of every sample of a run add up to 1? docs/format.md, "Records".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/page.h"
#include "tools/inspect/violation.h"

namespace latent::inspect {

// Records stand in the order of the film, so those of a sample may be anywhere in the run. Memory is bounded: what does not fit is
// looked at when the pages are read again. Almost always one bit for each sample tells enough.
class ShareCheck {
 public:
    // Checks run `number`, whose coverage is kept; what is wrong joins `violations`.
    ShareCheck(const sampledb::Coverage& coverage, std::size_t number, Violations& violations);

    void add(const sampledb::Page& page);  // the next page, with samples and shares

    // `read(i, page)` reads page i of `pages` again, with samples and shares, or leaves `page` as it is if it is no camera page.
    // Errors: those of `read`.
    using ReadPage = std::function<Status(std::size_t, sampledb::Page&)>;
    Status finish(std::size_t pages, const ReadPage& read);

 private:
    // Samples by their rank in the coverage: 0 for the first.
    std::uint64_t rank(std::uint64_t sample) const;
    std::uint64_t sample_of(std::uint64_t rank) const;

    void mark(const sampledb::Page& page);
    bool marks_are_good() const;
    Status add_up(std::uint64_t begin, std::uint64_t end, std::size_t pages, const ReadPage& read);

    static constexpr std::uint64_t kNoRank = ~std::uint64_t{0};
    const std::span<const sampledb::SampleRange> ranges_;
    std::vector<std::uint64_t> ranks_;  // ranks of the first samples of ranges_
    std::uint64_t samples_ = 0;
    const std::size_t run_;
    Violations& violations_;
    std::uint64_t begin_ = 0;                 // the first rank that is marked
    std::vector<bool> has_record_, has_one_;  // a camera record; one whose share is 1
    std::uint64_t next_ = kNoRank;            // the first rank behind those that has a camera record
    bool simple_ = true;                      // so far: every share is 0 or 1, at most one of a sample is 1
};

}  // namespace latent::inspect
