#include "sampledb/read/record_cursor.h"

#include <algorithm>

#include "sampledb/codec/page_filter.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

RecordCursor::RecordCursor(const RunSet& run_set, const RecordSelection& selection)
    : run_set_(run_set),
      selection_(selection),
      columns_(selection.columns),
      end_run_(std::min(selection.end_run, run_set.runs().size())),
      next_run_(selection.first_run) {
    columns_.samples |= selection.samples.has_value();
    columns_.positions |= selection.region.has_value();
}

bool RecordCursor::may_hold(const PageInfo& info) const {
    if (info.record_class == RecordClass::kCamera ? !selection_.camera : !selection_.light) return false;
    return !selection_.region || selection_.region->touches(info.node, info.part);
}

void RecordCursor::keep_selected(const PageInfo& info, Page& page) {
    const bool by_region = selection_.region && !selection_.region->contains(info.node);
    if (!by_region && !selection_.samples) return;
    rows_.clear();
    for (std::size_t i = 0; i < page.count; ++i) {
        if (by_region && !selection_.region->contains(page.u[i], page.v[i])) continue;
        if (selection_.samples && (page.sample[i] < selection_.samples->first || page.sample[i] >= selection_.samples->end))
            continue;
        rows_.push_back(i);
    }
    if (rows_.size() < page.count) keep_rows(rows_, page);
}

Result<bool> RecordCursor::next(Page& page) {
    for (; next_run_ < end_run_; ++next_run_, next_page_ = 0, pages_.reset()) {
        run_ = next_run_;
        if (selection_.samples && !run_set_.runs()[run_].coverage.intersects(*selection_.samples)) continue;
        if (pages_ == nullptr) {
            auto pages = run_set_.pages(run_);
            if (!pages) {
                if (is_unreadable(pages.error())) ++next_run_;
                return pages.error();
            }
            pages_ = std::move(*pages);
        }
        while (next_page_ < pages_->size()) {
            const PageInfo& info = (*pages_)[next_page_];
            page_ = next_page_;
            if (may_hold(info)) {
                if (Status s = run_set_.read_page(run_, info, columns_, decoder_, page); !s) {
                    if (is_unreadable(s.error())) ++next_page_;
                    return s.error();
                }
                keep_selected(info, page);
                ++next_page_;
                if (page.count > 0) return true;
                continue;
            }
            ++next_page_;
        }
    }
    page.count = 0;
    return false;
}

}  // namespace latent::sampledb
