// tools/merge/compact_front.h: the pages of one run that are decoded and not used up: where compaction has got to in it.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "base/result.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/read/run_set.h"

namespace latent::merge {

// What records are sorted by: the Z prefix of their position, then their sample; then the order of emission.
using SortKey = std::pair<std::uint32_t, std::uint64_t>;

struct DecodedPage {
    sampledb::Page page;
    std::vector<std::uint32_t> z;  // prefixes
    std::size_t used = 0;          // rows that are taken
    SortKey key(std::size_t row) const { return {z[row], page.sample[row]}; }
    // The rows from `used` on whose key is at most `last` end before this one.
    std::size_t end_of(const SortKey& last) const;
};

// The records of one class of a run, ascending.
class RunFront {
 public:
    RunFront(const sampledb::RunSet& run_set, std::size_t run, sampledb::RecordClass record_class)
        : run_set_(run_set), run_(run), record_class_(record_class) {}

    Status open();
    // Pages to decode until `ahead` are there. `announce` tells the system, `decode` does it; the latter of several runs at a time.
    void announce(std::size_t ahead) const;
    Status decode(std::size_t ahead, sampledb::PageDecoder& decoder);

    bool complete() const { return next_ == infos_.size(); }  // every page that is left is decoded
    SortKey last() const { return pages_.back()->key(pages_.back()->page.count - 1); }
    const std::vector<std::unique_ptr<DecodedPage>>& pages() const { return pages_; }
    // Lets pages go whose rows are all taken.
    void drop_used();

 private:
    const sampledb::RunSet& run_set_;
    std::size_t run_;
    sampledb::RecordClass record_class_;
    std::vector<sampledb::PageInfo> infos_;
    std::size_t next_ = 0;
    std::vector<std::unique_ptr<DecodedPage>> pages_;
    std::vector<std::unique_ptr<DecodedPage>> spare_;  // their memory serves the next ones
};

}  // namespace latent::merge
