#include "tools/merge/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "base/size.h"
#include "sampledb/format/footer.h"
#include "tools/merge/compact.h"
#include "tools/merge/copy_check.h"

namespace latent::merge {

using namespace sampledb;

namespace {

constexpr std::size_t kOpenInputs = 16;                      // inputs that are kept open while runs are copied
constexpr std::uint64_t kPagesListed = 1 << 17;              // in the runs of a stretch
constexpr std::uint64_t kStretch = std::uint64_t{64} << 20;  // the disk begins to write after each

DamagedRun damaged_run(const std::filesystem::path& file, const SelectedRun& run, const Error& why) {
    const SampleRange& samples = run.header.samples;
    return {file, run.offset,
            fmt::format("run at byte {}: {}; samples {}:{} lost", run.offset, why.message, samples.first, samples.end)};
}

}  // namespace

// One call of Output::append.
class Output::Appending {
 public:
    Appending(Output& output, const RunSet& run_set, std::vector<Step>& plan)
        : output_(output), run_set_(run_set), plan_(plan), done_(output.runs_.size()) {
        for (const SelectedRun& run : run_set.runs()) bytes_ahead_ += run.header.size();
    }

    Result<std::vector<DamagedRun>> append() {
        bool stopped = false;
        for (std::size_t at = done_; at < plan_.size() && !stopped;) {
            const Step step = plan_[at];
            if (step.compacted()) {
                const Result<bool> added = compact({step.first, step.end});
                if (!added) return added.error();
                if (*added) plan_[done_++] = step;
                stopped = !*added;  // what is behind it depends on what becomes of the group
                ++at;
            } else {
                const std::size_t end = end_of_stretch(at);
                const Result<std::size_t> copied = copy(at, end);
                if (!copied) return copied.error();
                for (std::size_t i = at; i < at + *copied; ++i) plan_[done_++] = plan_[i];
                at = std::min(end, at + *copied + 1);  // the next one, if there is one in the stretch, is damaged
            }
        }
        plan_.resize(done_);
        return std::move(damaged_);
    }

 private:
    const SelectedRun& run_of(std::size_t step) const { return run_set_.runs()[plan_[step].first]; }
    File& file() { return output_.out_.file(); }
    FileView view(std::uint64_t size) { return FileView(file(), output_.out_.path().string(), size); }

    Result<std::shared_ptr<const ByteSource>> input(std::uint32_t number) {
        if (std::shared_ptr<const ByteSource> open = inputs_.find(number)) return open;
        Result<std::shared_ptr<const ByteSource>> opened = open_source(run_set_.files()[number]);
        if (opened) inputs_.insert(number, *opened, 1);
        return opened;
    }

    void begin_writeback(std::uint64_t end) {
        if (end > handed_over_) file().begin_writeback(handed_over_, end - handed_over_);
        handed_over_ = end;
    }

    void tell_progress(std::uint64_t bytes) const {
        if (output_.progress_) {
            output_.progress_(std::min(1.0, static_cast<double>(bytes_done_ + bytes) / static_cast<double>(bytes_ahead_)),
                              format_size(output_.end_ + bytes));
        }
    }

    // Neighbours in one file are copied in one go, as many as make a stretch.
    std::size_t end_of_stretch(std::size_t begin) const {
        const SelectedRun& head = run_of(begin);
        std::uint64_t length = head.header.size();
        std::size_t end = begin + 1;
        for (; end < plan_.size() && !plan_[end].compacted() && length < kStretch; ++end) {
            const SelectedRun& next = run_of(end);
            if (next.file != head.file || next.offset != head.offset + length) break;
            length += next.header.size();
        }
        return end;
    }

    // Copies runs of steps `begin` .. `end`-1, neighbours, and checks the copies. Returns how many come before the first that is
    // damaged, which joins damaged_.
    Result<std::size_t> copy(std::size_t begin, std::size_t end) {
        const SelectedRun& head = run_of(begin);
        const Result<std::shared_ptr<const ByteSource>> from = input(head.file);
        if (!from) return from.error();
        CopyCheck check(run_set_.job(), output_.level_, output_.threads_);
        std::vector<RunInfo> copies;
        std::uint64_t length = 0, listed = 0;
        for (std::size_t i = begin; i < end; ++i) {
            std::shared_ptr<const std::vector<PageInfo>> pages;
            if (output_.level_ == VerifyLevel::kStored && listed + run_of(i).header.page_count <= kPagesListed) {
                listed += run_of(i).header.page_count;
                const auto read = run_set_.pages(plan_[i].first);
                if (!read && read.error().code == ErrorCode::kIo) return read.error();
                if (!read) break;  // as the look at the original will show
                pages = *read;
            }
            copies.push_back({output_.end_ + length, run_of(i).header});
            check.expect(copies.back(), run_of(i).offset, std::move(pages));
            length += copies.back().header.size();
        }
        Status good;
        for (std::uint64_t at = 0; at < length && good; at += output_.piece_) {
            const std::uint64_t piece = std::min(output_.piece_, length - at), to = output_.end_ + at;
            if (Status s = copy_bytes(**from, head.offset + at, file(), to, piece); !s) return s.error();
            good = check.arrived(view(to + piece));
            if (at + piece == length || (at + piece) % kStretch < output_.piece_) begin_writeback(to + piece);
            tell_progress(at + piece);
        }
        if (!good && good.error().code == ErrorCode::kIo) return good.error();
        for (const RunInfo& run : std::span(copies).first(check.sound())) {
            output_.runs_.push_back(run);
            output_.end_ += run.header.size();
            bytes_done_ += run.header.size();
        }
        if (check.sound() == end - begin) return check.sound();
        const std::size_t wrong = begin + check.sound();
        if (Status s = blame(**from, wrong, good); !s) return s.error();
        bytes_done_ += run_of(wrong).header.size();
        return check.sound();
    }

    // The copy of a step's run is not as it should be: because the run is damaged, or because it was spoiled on the way?
    Status blame(const ByteSource& from, std::size_t step, const Status& copied) {
        const SelectedRun& run = run_of(step);
        const Status original = verify_run(from, {run.offset, run.header}, run_set_.job(), output_.level_);
        if (!original && !is_unreadable(original.error())) return original.error().at(from.name());
        if (!original) {
            damaged_.push_back(damaged_run(run_set_.files()[run.file], run, original.error()));
            return {};
        }
        return Error{ErrorCode::kCorrupt,
                     fmt::format("{}: run at byte {}: {}, although the copied bytes are sound", output_.out_.path().string(),
                                 output_.end_, copied ? "differs when read back" : copied.error().message)};
    }

    // Makes one run of a group. False if some of its runs are damaged: they join damaged_.
    Result<bool> compact(const CompactGroup& group) {
        if (output_.level_ == VerifyLevel::kFull) {
            const Result<bool> sound = check_group(group);
            if (!sound || !*sound) return sound;
        }
        const std::uint64_t memory = output_.memory_ - std::min(output_.memory_, run_set_.list_memory());
        Result<RunHeader> header = RunHeader{};
        output_.threads_.run([&] {
            header =
                compact_runs(run_set_, group, memory, file(), output_.end_, [this](std::uint64_t bytes) { tell_progress(bytes); });
        });
        if (!header && !is_unreadable(header.error())) return header.error();
        if (!header) {
            const Result<bool> sound = check_group(group);
            return sound && *sound ? Result<bool>(header.error()) : sound;
        }
        const RunInfo run{output_.end_, *header};
        begin_writeback(run.offset + header->size());
        output_.runs_.push_back(run);
        output_.end_ += header->size();
        for (std::size_t i = group.first; i < group.end; ++i) bytes_done_ += run_set_.runs()[i].header.size();
        if (Status s = check_new(run); !s) return s.error().at(output_.out_.path().string());
        return true;
    }

    // Reads a run that was made here, as it stands in the output.
    Status check_new(const RunInfo& run) {
        const FileView written = view(output_.end_);
        if (output_.level_ != VerifyLevel::kStored) return verify_run(written, run, run_set_.job(), output_.level_);
        Result<RunIndex> index = read_run_index(written, run, run_set_.job());
        if (!index) return index.error();
        CopyCheck check(run_set_.job(), output_.level_, output_.threads_);
        check.expect(run, run.offset, std::make_shared<const std::vector<PageInfo>>(std::move(index->pages)));
        return check.arrived(written);
    }

    // Reads every record of a group's runs. False if some are damaged: they join damaged_.
    Result<bool> check_group(const CompactGroup& group) {
        bool sound = true;
        for (std::size_t i = group.first; i < group.end; ++i) {
            const SelectedRun& run = run_set_.runs()[i];
            const Result<std::shared_ptr<const ByteSource>> from = input(run.file);
            if (!from) return from.error();
            const Status good = verify_run(**from, {run.offset, run.header}, run_set_.job(), VerifyLevel::kFull);
            if (good) continue;
            if (!is_unreadable(good.error())) return good.error().at((*from)->name());
            damaged_.push_back(damaged_run(run_set_.files()[run.file], run, good.error()));
            sound = false;
        }
        return sound;
    }

    Output& output_;
    const RunSet& run_set_;
    std::vector<Step>& plan_;
    std::size_t done_;  // steps at the front of the plan that are in the output
    std::vector<DamagedRun> damaged_;
    RecentCache<ByteSource> inputs_{kOpenInputs};
    std::uint64_t handed_over_ = 0;                   // byte up to which the disk was asked to write
    std::uint64_t bytes_done_ = 0, bytes_ahead_ = 0;  // bytes of the inputs
};

Status Output::begin(const Job& job) {
    const Result<Bytes> header = encode_file_header({job, ""});
    if (!header) return header.error();
    end_ = header_end_ = header->size();
    return out_.file().write_all(0, *header);
}

Result<std::vector<DamagedRun>> Output::append(const RunSet& run_set, std::vector<Step>& plan) {
    return Appending(*this, run_set, plan).append();
}

void Output::keep(std::size_t count) {
    runs_.resize(count);
    end_ = runs_.empty() ? header_end_ : runs_.back().offset + runs_.back().header.size();
}

Status Output::end(const std::string& provenance) {
    const Result<std::uint64_t> size = put_footer(runs_, provenance, end_, [this](ByteSpan piece) {
        const Status written = out_.file().write_all(end_, piece);
        end_ += piece.size();
        return written;
    });
    if (!size) return size.error();
    if (Status s = out_.file().truncate(end_); !s) return s;  // nothing of what was left out stays behind it
    return out_.publish();
}

}  // namespace latent::merge
