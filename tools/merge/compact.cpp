#include "tools/merge/compact.h"

#include <algorithm>
#include <memory>

#include "sampledb/codec/page_codec.h"
#include "sampledb/codec/run_codec.h"
#include "sampledb/data/z_order.h"

namespace latent::merge {

using namespace sampledb;

namespace {

constexpr std::size_t kWriteBytes = std::size_t{4} << 20;

// One run of the group, as a stream of the records of one class: ascending by (Z prefix, sample, order of emission).
class Cursor {
 public:
    Cursor(const Gathering& gathering, std::size_t run, RecordClass record_class)
        : gathering_(gathering), run_(run), record_class_(record_class) {}

    // Moves to the first record. False if there is none.
    Result<bool> begin() {
        const Result<std::shared_ptr<const std::vector<PageInfo>>> pages = gathering_.pages(run_);
        if (!pages) return pages.error();
        for (const PageInfo& page : **pages) {
            if (page.record_class == record_class_) pages_.push_back(page);
        }
        std::ranges::sort(pages_, {}, &PageInfo::offset);  // as they were encoded
        return load();
    }
    // Moves to the next record. False at the end.
    Result<bool> next() { return ++row_ < page_.count ? place() : load(); }

    const Page& page() const { return page_; }
    std::size_t row() const { return row_; }
    std::uint32_t z() const { return z_; }
    bool before(const Cursor& other) const { return std::pair(z_, sample_) < std::pair(other.z_, other.sample_); }

 private:
    bool place() {
        z_ = z_prefix(page_.u[row_], page_.v[row_]);
        sample_ = page_.sample[row_];
        return true;
    }
    Result<bool> load() {
        if (next_page_ == pages_.size()) return false;
        const PageInfo& info = pages_[next_page_++];
        if (Status s = gathering_.read_page(run_, info, ColumnSet{}, page_); !s) return s.error();
        row_ = 0;
        return place();
    }

    const Gathering& gathering_;
    std::size_t run_;
    RecordClass record_class_;
    std::vector<PageInfo> pages_;
    std::size_t next_page_ = 0;
    Page page_;
    std::size_t row_ = 0;
    std::uint32_t z_ = 0;
    std::uint64_t sample_ = 0;
};

// Calls visit(to's column, from's column, bytes or values per row) for the columns with one entry per record.
template <class To, class From, class Visit>
void for_row_columns(const Job& job, To& to, From& from, const Visit& visit) {
    visit(to.sample, from.sample, 1);
    visit(to.u, from.u, 1);
    visit(to.v, from.v, 1);
    visit(to.x, from.x, 1);
    visit(to.y, from.y, 1);
    visit(to.z, from.z, 1);
    visit(to.pairs, from.pairs, 1);
    visit(to.xi, from.xi, 1);
    visit(to.index, from.index, 1);
    for (std::size_t i = 0; i < job.extra.size(); ++i) visit(to.extra[i].values, from.extra[i].values, width(job.extra[i].type));
}

template <class Column>
void append(Column& to, const Column& from, std::size_t first, std::size_t count) {
    const auto at = from.begin() + static_cast<std::ptrdiff_t>(first);
    to.insert(to.end(), at, at + static_cast<std::ptrdiff_t>(count));
}

// The merged records of one class, cut into pages as they arrive.
class PageCutter {
 public:
    PageCutter(const Job& job, RecordClass record_class, RunEncoder& encoder, Bytes& out)
        : job_(job), most_(max_page_records(job)), encoder_(encoder), out_(out) {
        rows_.record_class = page_.record_class = record_class;
        rows_.extra.resize(job.extra.size());
        page_.extra.resize(job.extra.size());
    }

    void add(const Cursor& from) {
        const Page& page = from.page();
        const std::size_t row = from.row();
        for_row_columns(job_, rows_, page, [row](auto& to, const auto& column, std::size_t width_in_values) {
            if (!column.empty()) append(to, column, row * width_in_values, width_in_values);
        });
        if (page.record_class == RecordClass::kCamera) rows_.share.push_back(page.unit_share ? 1.0f : page.share[row]);
        if (!page.pairs.empty()) {
            append(rows_.power, page.power, page.first_pair[row], page.pairs[row]);
            if (!page.lambda_nm.empty()) append(rows_.lambda_nm, page.lambda_nm, page.first_pair[row], page.pairs[row]);
        }
        z_.push_back(from.z());
        // A page's end shows once the record that is one too many is there. Pages are cut in bulk, to move what is left seldom.
        if (z_.size() - lead_ > kBulk * most_) cut(most_);
    }
    void finish() { cut(0); }

 private:
    static constexpr std::size_t kBulk = 4;

    // Encodes pages while more than `keep` records are left.
    void cut(std::size_t keep) {
        while (z_.size() - lead_ - begin_ > keep) {
            const std::size_t end = page_end(z_, lead_ + begin_, most_) - lead_;
            take(begin_, end);
            encoder_.add_page(page_, out_);
            begin_ = end;
        }
        drop_front();
    }

    // Fills page_ with rows `first` .. `end`-1.
    void take(std::size_t first, std::size_t end) {
        page_.count = end - first;
        for_row_columns(job_, page_, rows_, [&](auto& to, const auto& from, std::size_t width_in_values) {
            to.clear();
            if (!from.empty()) append(to, from, first * width_in_values, page_.count * width_in_values);
        });
        page_.share.clear();
        if (!rows_.share.empty()) append(page_.share, rows_.share, first, page_.count);
        page_.unit_share = std::ranges::all_of(page_.share, [](float share) { return share == 1; });
        page_.power.clear();
        page_.lambda_nm.clear();
        std::size_t pairs = 0;
        for (const std::uint16_t n : page_.pairs) pairs += n;
        if (!rows_.power.empty()) append(page_.power, rows_.power, first_pair_, pairs);
        if (!rows_.lambda_nm.empty()) append(page_.lambda_nm, rows_.lambda_nm, first_pair_, pairs);
        first_pair_ += pairs;
    }

    void drop_front() {
        const auto drop = [](auto& column, std::size_t count) {
            if (!column.empty()) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(count));
        };
        for_row_columns(job_, rows_, rows_,
                        [&](auto& column, const auto&, std::size_t width_in_values) { drop(column, begin_ * width_in_values); });
        drop(rows_.share, begin_);
        drop(rows_.power, first_pair_);
        drop(rows_.lambda_nm, first_pair_);
        if (begin_ > 0) {
            drop(z_, lead_ + begin_ - 1);
            lead_ = 1;
        }
        begin_ = first_pair_ = 0;
    }

    const Job& job_;
    const std::size_t most_;
    RunEncoder& encoder_;
    Bytes& out_;
    Page rows_, page_;
    std::vector<std::uint32_t> z_;  // of rows_, behind `lead_` record (0 or 1) that was the last to be encoded
    std::size_t lead_ = 0;
    std::size_t begin_ = 0;       // rows before it are encoded
    std::size_t first_pair_ = 0;  // of row begin_
};

// Merges the records of one class into pages; `flush` takes the bytes in `out` away when there are many.
template <class Flush>
Status merge_class(const Gathering& gathering, const CompactGroup& group, RecordClass record_class, RunEncoder& encoder, Bytes& out,
                   const Flush& flush) {
    std::vector<std::unique_ptr<Cursor>> cursors;  // a heap: the first is the one with the next record
    const auto later = [](const auto& a, const auto& b) { return b->before(*a); };
    for (std::size_t run = group.first; run < group.end; ++run) {
        auto cursor = std::make_unique<Cursor>(gathering, run, record_class);
        const Result<bool> any = cursor->begin();
        if (!any) return any.error();
        if (*any) cursors.push_back(std::move(cursor));
    }
    std::ranges::make_heap(cursors, later);
    PageCutter cutter(gathering.job(), record_class, encoder, out);
    while (!cursors.empty()) {
        std::ranges::pop_heap(cursors, later);
        cutter.add(*cursors.back());
        const Result<bool> more = cursors.back()->next();
        if (!more) return more.error();
        if (*more) {
            std::ranges::push_heap(cursors, later);
        } else {
            cursors.pop_back();
        }
        if (out.size() >= kWriteBytes) {
            if (Status s = flush(); !s) return s;
        }
    }
    cutter.finish();
    return flush();
}

}  // namespace

Result<RunHeader> compact_runs(const Gathering& gathering, const CompactGroup& group, File& out, std::uint64_t offset,
                               const std::function<void(std::uint64_t)>& report) {
    Coverage coverage;
    for (std::size_t i = group.first; i < group.end; ++i) coverage.add(gathering.runs()[i].coverage);
    RunEncoder encoder(gathering.job(), coverage);
    Bytes bytes;
    std::uint64_t end = offset + kRunHeaderSize;
    const auto flush = [&] {
        const Status written = out.write_all(end, bytes);
        end += bytes.size();
        bytes.clear();
        report(end - offset);
        return written;
    };
    for (const RecordClass record_class : {RecordClass::kCamera, RecordClass::kLight}) {
        if (Status s = merge_class(gathering, group, record_class, encoder, bytes, flush); !s) return s.error();
    }
    const RunEncoder::Tail tail = encoder.finish();
    if (Status s = out.write_all(end, tail.index); !s) return s.error();
    if (Status s = out.write_all(offset, encode_run_header(tail.header)); !s) return s.error();
    return tail.header;
}

}  // namespace latent::merge
