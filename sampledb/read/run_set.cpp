#include "sampledb/read/run_set.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "base/url.h"
#include "sampledb/codec/page_filter.h"
#include "sampledb/read/checked_inputs.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

// 256 open files, or what the system allows (ulimit -n), less what readers still hold and the tool's own.
std::size_t max_open_files() {
    constexpr rlim_t kMax = 256, kOthers = 32, kFewest = 4;
    struct rlimit allowed;
    const rlim_t all = ::getrlimit(RLIMIT_NOFILE, &allowed) == 0 ? std::min(allowed.rlim_cur, kMax) : kMax;
    return std::max(all, kOthers + kFewest) - kOthers;
}

constexpr std::uint64_t kIndexCost = 256;  // bytes to hold an index, without its pages
// Runs whose indexes are on their way from a server: so many, and more of small ones.
constexpr std::size_t kRunsAhead = 32;
constexpr std::uint64_t kBytesAhead = 4 << 20;

class OpenRunSet final : public RunSet {
 public:
    explicit OpenRunSet(const RunSetOptions& options)
        : options_(options), indexes_(options.memory / 8), sources_(max_open_files()) {}

    Status take_inputs();

    const Job& job() const override { return job_; }
    const std::vector<fs::path>& files() const override { return files_; }
    const std::vector<SelectedRun>& runs() const override { return runs_; }
    const Coverage& coverage() const override { return coverage_; }
    const RunSetReport& report() const override { return report_; }
    Result<std::shared_ptr<const std::vector<PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const PageInfo& info, const ColumnSet& columns, PageDecoder& decoder,
                     Page& page) const override;
    void will_read(std::size_t run, const PageInfo& first, const PageInfo& last) const override;
    std::uint64_t bytes_read() const override { return bytes_read_; }
    std::optional<Resolution> resolution() const override { return resolution_; }
    std::uint64_t list_memory() const override { return list_memory_; }

 private:
    void select(std::vector<SelectedRun> runs);
    void cut_to_samples();
    Result<std::shared_ptr<const ByteSource>> source(std::size_t file) const;
    void announce_indexes(std::size_t run) const;
    std::string place(const SelectedRun& run) const;

    RunSetOptions options_;
    Job job_;
    std::vector<fs::path> files_;
    std::vector<SelectedRun> runs_;
    Coverage coverage_;
    RunSetReport report_;
    std::optional<Resolution> resolution_;
    std::uint64_t list_memory_ = 0;

    mutable std::mutex mutex_;
    mutable RecentCache<std::vector<PageInfo>> indexes_;
    mutable RecentCache<ByteSource> sources_;
    mutable std::atomic<std::uint64_t> bytes_read_ = 0;
    mutable std::atomic<std::size_t> announced_ = 0;  // runs whose indexes were
};

Status OpenRunSet::take_inputs() {
    Result<CheckedInputs> inputs = checked_inputs(options_, sources_);
    if (!inputs) return inputs.error();
    job_ = std::move(inputs->job);
    files_ = std::move(inputs->files);
    report_ = std::move(inputs->report);
    resolution_ = inputs->resolution;
    list_memory_ = inputs->list_memory;
    select(std::move(inputs->runs));
    if (options_.samples) cut_to_samples();
    return {};
}

void OpenRunSet::select(std::vector<SelectedRun> runs) {
    Selection selection = select_runs(runs);
    report_.superseded_runs = selection.superseded.size();
    report_.repeated_runs = selection.repeated.size();
    const auto all_of = [&](std::size_t i) {
        return fmt::format("{}: samples {}", files_[runs[i].file].string(), to_string(runs[i].coverage));
    };
    for (const std::size_t i : selection.differing) {
        leave_out(report_.left_out,
                  {all_of(i), "differs from the same samples in another file; the one with the smaller hash is kept"});
    }
    for (const std::size_t i : selection.overlapping) {
        Coverage lost = runs[i].coverage;
        lost.remove(selection.coverage);
        leave_out(report_.left_out, {all_of(i), "overlaps runs with more samples; samples " + to_string(lost) + " lost"});
    }
    std::ranges::sort(selection.chosen);
    std::size_t kept = 0;  // chosen runs close up, in the memory where they are
    for (const std::size_t i : selection.chosen) {
        if (i != kept) runs[kept] = std::move(runs[i]);
        ++kept;
    }
    runs.resize(kept);
    std::ranges::sort(runs, {}, [](const SelectedRun& run) { return run.header.samples.first; });
    runs_ = std::move(runs);
    coverage_ = std::move(selection.coverage);
}

void OpenRunSet::cut_to_samples() {
    const Coverage samples(*options_.samples);
    std::erase_if(runs_, [&](SelectedRun& run) {
        Coverage within = run.coverage.intersection(samples);
        run.cut = within != run.coverage;
        run.coverage = std::move(within);
        return run.coverage.empty();
    });
    coverage_ = coverage_.intersection(samples);
}

std::string OpenRunSet::place(const SelectedRun& run) const {
    return fmt::format("{}: samples {}:{}", shown_name(files_[run.file]), run.header.samples.first, run.header.samples.end);
}

Result<std::shared_ptr<const ByteSource>> OpenRunSet::source(std::size_t file) const {
    const std::lock_guard lock(mutex_);
    if (std::shared_ptr<const ByteSource> open = sources_.find(file)) return open;
    Result<std::shared_ptr<const ByteSource>> opened = open_source(files_[file]);
    if (!opened) return opened.error();
    if (options_.announced_reads) (*opened)->expect_scattered_reads();
    sources_.insert(file, *opened, 1);
    return opened;
}

// Indexes are nearly always read run after run, and from afar each would be waited for.
void OpenRunSet::announce_indexes(std::size_t run) const {
    std::size_t end = std::min(run + 1 + kRunsAhead, runs_.size());
    for (std::uint64_t bytes = 0; end < runs_.size() && (bytes += runs_[end].header.size()) <= kBytesAhead;) ++end;
    for (std::size_t next = std::max(run, announced_.exchange(end)); next < end; ++next) {
        const SelectedRun& selected = runs_[next];
        const Result<std::shared_ptr<const ByteSource>> from = source(selected.file);
        if (!from || (*from)->file() != nullptr) continue;
        (*from)->will_read(selected.offset, kRunHeaderSize);
        (*from)->will_read(selected.offset + selected.header.index_offset(),
                           selected.header.size() - selected.header.index_offset());
    }
}

Result<std::shared_ptr<const std::vector<PageInfo>>> OpenRunSet::pages(std::size_t run) const {
    {
        const std::lock_guard lock(mutex_);
        if (std::shared_ptr<const std::vector<PageInfo>> held = indexes_.find(run)) return held;
    }
    const SelectedRun& selected = runs_[run];
    const Result<std::shared_ptr<const ByteSource>> from = source(selected.file);
    if (!from) return from.error();
    if ((*from)->file() == nullptr) announce_indexes(run);
    const std::uint64_t cost = kIndexCost + selected.header.page_count * sizeof(PageInfo);
    {
        const std::lock_guard lock(mutex_);
        indexes_.make_room(cost);
    }
    Result<RunIndex> index = read_run_index(**from, {selected.offset, selected.header}, job_);
    if (!index) return index.error().at(place(selected));
    bytes_read_ += kRunHeaderSize + selected.header.index_size();
    auto pages = std::make_shared<const std::vector<PageInfo>>(std::move(index->pages));
    const std::lock_guard lock(mutex_);
    indexes_.insert(run, pages, cost);
    return std::shared_ptr<const std::vector<PageInfo>>(pages);
}

Status OpenRunSet::read_page(std::size_t run, const PageInfo& info, const ColumnSet& columns, PageDecoder& decoder,
                             Page& page) const {
    const SelectedRun& selected = runs_[run];
    const Result<std::shared_ptr<const ByteSource>> from = source(selected.file);
    if (!from) return from.error();
    ColumnSet needed = columns;
    needed.samples |= selected.cut;
    if (Status s = sampledb::read_page(**from, info, job_, needed, decoder, page); !s) return s.error().at(place(selected));
    bytes_read_ += info.stored_size;
    if (selected.cut) keep_samples(selected.coverage, page);
    return {};
}

void OpenRunSet::will_read(std::size_t run, const PageInfo& first, const PageInfo& last) const {
    const auto from = source(runs_[run].file);
    if (from) (*from)->will_read(first.offset, last.offset + last.stored_size - first.offset);
}

}  // namespace

void leave_out(std::vector<LeftOut>& list, LeftOut item) {
    if (list.size() < kMaxDamage) return list.push_back(std::move(item));
    const std::uint64_t before = list.size() == kMaxDamage ? 0 : list.back().count;
    list.resize(kMaxDamage);
    list.push_back({"elsewhere", fmt::format("{} more like these", before + item.count), before + item.count});
}

Result<std::unique_ptr<RunSet>> RunSet::open(const RunSetOptions& options) {
    auto run_set = std::make_unique<OpenRunSet>(options);
    if (Status s = run_set->take_inputs(); !s) return s.error();
    return std::unique_ptr<RunSet>(std::move(run_set));
}

Status for_each_origin(const RunSet& run_set, const std::function<void(std::string_view)>& take) {
    if (run_set.runs().empty()) return {};
    const std::filesystem::path& path = run_set.files()[run_set.runs().front().file];
    const Result<std::shared_ptr<const ByteSource>> source = open_source(path);
    if (!source) return source.error();
    const Result<FileContents> frames = read_frames(**source);
    if (!frames) return frames.error().at(shown_name(path));
    for_each_origin(*frames, take);
    return {};
}

}  // namespace latent::sampledb
