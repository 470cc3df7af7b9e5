// sampledb/read/record_cursor.h: the records of a run set, page by page, or only some of them.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "sampledb/codec/page_decoder.h"
#include "sampledb/data/film_region.h"
#include "sampledb/read/run_set.h"

namespace latent::sampledb {

struct RecordSelection {
    ColumnSet columns;
    bool camera = true, light = true;    // classes
    std::optional<SampleRange> samples;  // only these
    std::size_t first_run = 0, end_run = ~std::size_t{0};
    std::optional<FilmRegion> region;
};

// For one thread; several may read one run set.
class RecordCursor {
 public:
    RecordCursor(const RunSet& run_set, const RecordSelection& selection);

    // Decodes the next page that has records of the selection, and keeps these; the page also has the columns that choosing took.
    // False: there are no more. An error that is_unreadable costs one page or one run: call again to continue behind it. After any
    // other error, the same page is tried again.
    Result<bool> next(Page& page);

    std::size_t run() const { return run_; }    // the run of the page that was returned last, or of the error
    std::size_t page() const { return page_; }  // its index in the run

 private:
    bool may_hold(const PageInfo& info) const;
    void keep_selected(const PageInfo& info, Page& page);

    const RunSet& run_set_;
    const RecordSelection selection_;
    ColumnSet columns_;  // those asked for, and those that choosing takes
    std::size_t end_run_;
    std::size_t next_run_, next_page_ = 0;
    std::size_t run_ = 0, page_ = 0;
    std::shared_ptr<const std::vector<PageInfo>> pages_;  // pages of next_run_, once it is begun
    PageDecoder decoder_;
    std::vector<std::size_t> rows_;
};

}  // namespace latent::sampledb
