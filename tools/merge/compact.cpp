#include "tools/merge/compact.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "base/first_error.h"
#include "base/in_order.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/page_encoder.h"
#include "sampledb/codec/run_codec.h"
#include "tools/merge/compact_front.h"
#include "tools/merge/compact_rows.h"
#include "tools/merge/compact_sort.h"

namespace latent::merge {

using namespace sampledb;

namespace {

constexpr std::size_t kWriteBytes = std::size_t{4} << 20;
constexpr std::size_t kPagesPerThread = 4;                        // that are encoded at once
constexpr std::uint64_t kComfortable = std::uint64_t{192} << 20;  // bytes of decoded pages: more of them make nothing faster
constexpr std::uint64_t kRowBytes = 16;                           // a decoded record's Z prefixes and its place in the order

// Pages that are in memory at once.
struct Budget {
    std::size_t ahead;    // decoded, of each run
    std::size_t encoded;  // made and not yet written
};

// Half of the memory holds decoded pages, a quarter those that are made of them; the rest is for indexes, and to sort in.
Budget budget_of(const Job& job, std::size_t runs, std::uint64_t memory) {
    const std::uint64_t page = page_memory(job);
    const std::uint64_t decoded = std::min(memory / 2, kComfortable) / (page + max_page_records(job) * kRowBytes);
    const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
    // With one page of each run, a round would end wherever the first of them does.
    return {std::max<std::size_t>(2, decoded / runs), std::clamp<std::uint64_t>(memory / 4 / page, 1, kPagesPerThread * threads)};
}

// Appends to the output file, in large pieces.
class Writer {
 public:
    Writer(File& out, std::uint64_t offset, const std::function<void(std::uint64_t)>& report)
        : out_(out), begin_(offset), end_(offset + kRunHeaderSize), report_(report) {}
    Status append(ByteSpan bytes) {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return bytes_.size() >= kWriteBytes ? flush() : Status{};
    }
    Status flush() {
        const Status written = out_.write_all(end_, bytes_);
        end_ += bytes_.size();
        bytes_.clear();
        report_(end_ - begin_);
        return written;
    }

 private:
    File& out_;
    std::uint64_t begin_, end_;
    const std::function<void(std::uint64_t)>& report_;
    Bytes bytes_;
};

// An array whose memory is kept, and not cleared when it grows: threads touch it first where they fill it.
template <class T>
class Scratch {
 public:
    std::span<T> of(std::size_t size) {  // what was in it is gone
        if (size > room_) values_ = std::make_unique_for_overwrite<T[]>(room_ = size);
        return {values_.get(), size};
    }

 private:
    std::unique_ptr<T[]> values_;
    std::size_t room_ = 0;
};

// Makes the pages of one class out of those of many runs. In rounds: every run has some pages decoded; the records that come before
// all that is not decoded are sorted, cut into pages, encoded. Each step is parallel; what it yields follows from the records
// alone.
class ClassMerger {
 public:
    ClassMerger(const RunSet& run_set, const CompactGroup& group, RecordClass record_class, const Budget& budget,
                RunEncoder& encoder, Writer& writer)
        : job_(run_set.job()),
          page_records_(max_page_records(run_set.job())),
          budget_(budget),
          encoder_(encoder),
          writer_(writer),
          table_(job_) {
        left_over_.record_class = record_class;
        left_over_.extra = extra_columns(job_);
        for (std::size_t run = group.first; run < group.end; ++run) fronts_.emplace_back(run_set, run, record_class);
    }

    Status merge() {
        if (Status s = of_each_front([](RunFront& front) { return front.open(); }); !s) return s;
        for (bool more = true; more;) {
            if (Status s = decode(); !s) return s;
            const SortKey last = last_complete();
            more = last != kEnd;
            take(last);
            if (Status s = encode(more); !s) return s;
            for (RunFront& front : fronts_) front.drop_used();
        }
        return writer_.flush();
    }

 private:
    static constexpr SortKey kEnd{std::numeric_limits<std::uint32_t>::max(), std::numeric_limits<std::uint64_t>::max()};

    template <class Do>
    Status of_each_front(const Do& work) {
        FirstError error;
        tbb::parallel_for(std::size_t{0}, fronts_.size(), [&](std::size_t i) {
            if (!error) error.keep(work(fronts_[i]));
        });
        return error.status();
    }

    Status decode() {
        for (const RunFront& front : fronts_) front.announce(budget_.ahead);
        return of_each_front([&](RunFront& front) { return front.decode(budget_.ahead, workers_.local().decoder); });
    }

    // No record that is not decoded yet comes before one with this key, or in front of it in its own run.
    SortKey last_complete() const {
        SortKey last = kEnd;
        for (const RunFront& front : fronts_) {
            if (!front.complete()) last = std::min(last, front.last());
        }
        return last;
    }

    // The records up to `last`, behind those that were left over.
    void take(const SortKey& last) {
        table_.clear();
        std::vector<Slice> slices;
        const std::uint32_t leftover_page = table_.add(left_over_);
        for (const RunFront& front : fronts_) {
            for (const auto& page : front.pages()) {
                const std::size_t begin = page->used;
                page->used = page->end_of(last);
                if (begin < page->used) slices.push_back({page.get(), table_.add(page->page), begin, page->used});
            }
        }
        const std::size_t left_over = left_over_.count, taken = rows_of(slices);
        order_ = order_memory_.of(left_over + taken);
        z_ = z_memory_.of(left_over_z_.size() + taken);
        std::ranges::copy(left_over_z_, z_.begin());
        for (std::uint32_t row = 0; row < left_over; ++row) order_[row] = {leftover_page, row};
        merge_slices(slices, z_.last(taken), order_.last(taken));
    }

    // Encodes the pages that are complete; `more` records are to come.
    Status encode(bool more) {
        std::vector<std::size_t> cuts{0};  // a page's end shows once the record that is one too many is there
        const std::size_t lead = z_.size() - order_.size();
        while (order_.size() - cuts.back() > (more ? page_records_ : 0))
            cuts.push_back(page_end(z_, lead + cuts.back(), page_records_) - lead);
        struct Encoded {
            PageInfo info;
            Bytes bytes;
        };
        const auto make = [&](std::size_t i) -> Result<Encoded> {
            Worker& worker = workers_.local();
            table_.gather(order_.subspan(cuts[i], cuts[i + 1] - cuts[i]), worker.page);
            Encoded encoded;
            encoded.info = worker.encoder.encode(job_, worker.page, encoded.bytes);
            return encoded;
        };
        const auto write = [&](std::size_t, const Encoded& encoded) {
            encoder_.add_page(encoded.info);
            return writer_.append(encoded.bytes);
        };
        if (Status s = make_in_order(cuts.size() - 1, make, write, budget_.encoded); !s) return s;
        keep_rest(cuts.back());
        return {};
    }

    // What no page has taken is copied, so that the pages which it comes from can go.
    void keep_rest(std::size_t begin) {
        Page rest;
        table_.gather(order_.subspan(begin), rest);
        left_over_ = std::move(rest);
        const std::size_t with_lead = std::min(z_.size(), order_.size() - begin + 1);
        const std::span<std::uint32_t> z = z_.last(with_lead);
        left_over_z_.assign(z.begin(), z.end());
    }

    struct Worker {
        PageDecoder decoder;
        Page page;
        PageEncoder encoder;
    };

    const Job& job_;
    const std::size_t page_records_;
    const Budget budget_;
    tbb::enumerable_thread_specific<Worker> workers_;
    RunEncoder& encoder_;
    Writer& writer_;
    std::vector<RunFront> fronts_;
    PageTable table_;
    Page left_over_;
    std::vector<std::uint32_t> left_over_z_;  // its Z prefixes, behind that of the last record to be encoded, if there is one
    Scratch<RowRef> order_memory_;
    Scratch<std::uint32_t> z_memory_;
    std::span<RowRef> order_;     // rows of table_, ascending
    std::span<std::uint32_t> z_;  // prefixes of order_, behind that of the last record to be encoded
};

}  // namespace

Result<RunHeader> compact_runs(const RunSet& run_set, const CompactGroup& group, std::uint64_t memory, File& out,
                               std::uint64_t offset, const std::function<void(std::uint64_t)>& report) {
    Coverage coverage;
    for (std::size_t i = group.first; i < group.end; ++i) coverage.add(run_set.runs()[i].coverage);
    const Budget budget = budget_of(run_set.job(), group.end - group.first, memory);
    RunEncoder encoder(run_set.job(), coverage);
    Writer writer(out, offset, report);
    for (const RecordClass record_class : {RecordClass::kCamera, RecordClass::kLight}) {
        ClassMerger merger(run_set, group, record_class, budget, encoder, writer);
        if (Status s = merger.merge(); !s) return s.error();
    }
    const RunEncoder::Tail tail = encoder.finish();
    if (Status s = writer.append(tail.index); !s) return s.error();
    if (Status s = writer.flush(); !s) return s.error();
    if (Status s = out.write_all(offset, encode_run_header(tail.header)); !s) return s.error();
    return tail.header;
}

}  // namespace latent::merge
