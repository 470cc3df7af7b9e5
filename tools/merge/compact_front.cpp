#include "tools/merge/compact_front.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/url.h"
#include "sampledb/data/z_order.h"

namespace latent::merge {

using namespace sampledb;

std::size_t DecodedPage::end_of(const SortKey& last) const {
    std::size_t first = used;  // by hand, for clang 14 cannot compile libstdc++'s std::views::iota
    for (std::size_t count = page.count - used; count > 0;) {
        const std::size_t half = count / 2;
        if (key(first + half) <= last)
            first += half + 1, count -= half + 1;
        else
            count = half;
    }
    return first;
}

Status RunFront::open() {
    const auto pages = run_set_.pages(run_);
    if (!pages) return pages.error();
    for (const PageInfo& page : **pages) {
        if (page.record_class == record_class_ && page.record_count > 0) infos_.push_back(page);
    }
    std::ranges::sort(infos_, {}, &PageInfo::offset);  // as they were encoded
    return {};
}

void RunFront::announce(std::size_t ahead) const {
    const std::size_t wanted = ahead - std::min(ahead, pages_.size());
    const std::size_t end = std::min(infos_.size(), next_ + wanted);
    if (next_ < end) run_set_.will_read(run_, infos_[next_], infos_[end - 1]);
}

Status RunFront::decode(std::size_t ahead, PageDecoder& decoder) {
    for (; pages_.size() < ahead && next_ < infos_.size(); ++next_) {
        std::unique_ptr<DecodedPage> decoded;
        if (spare_.empty()) {
            decoded = std::make_unique<DecodedPage>();
        } else {
            decoded = std::move(spare_.back());
            spare_.pop_back();
        }
        Page& page = decoded->page;
        if (Status s = run_set_.read_page(run_, infos_[next_], ColumnSet{}, decoder, page); !s) return s;
        decoded->used = 0;
        decoded->z.resize(page.count);
        for (std::size_t i = 0; i < page.count; ++i) decoded->z[i] = z_prefix(page.u[i], page.v[i]);
        bool sorted = pages_.empty() || last() <= decoded->key(0);
        for (std::size_t i = 1; i < page.count; ++i) sorted &= decoded->key(i - 1) <= decoded->key(i);
        if (!sorted) {
            const SelectedRun& run = run_set_.runs()[run_];
            return Error{ErrorCode::kCorrupt,
                         fmt::format("{}: run at byte {}: its records are not in order; merge without --compact",
                                     shown_name(run_set_.files()[run.file]), run.offset)};
        }
        pages_.push_back(std::move(decoded));
    }
    return {};
}

void RunFront::drop_used() {
    const auto used_up = [](const auto& decoded) { return decoded->used == decoded->page.count; };
    const auto left = std::ranges::find_if_not(pages_, used_up);
    std::move(pages_.begin(), left, std::back_inserter(spare_));
    pages_.erase(pages_.begin(), left);
}

}  // namespace latent::merge
