#include "sampledb/read/gathering.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "sampledb/codec/page_filter.h"
#include "sampledb/read/gather_inputs.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

// 256 open files, or what the system allows (ulimit -n), less what readers still hold and the tool's own.
std::size_t most_open_files() {
    constexpr rlim_t kMost = 256, kOthers = 32, kFewest = 4;
    struct rlimit allowed;
    const rlim_t all = ::getrlimit(RLIMIT_NOFILE, &allowed) == 0 ? std::min(allowed.rlim_cur, kMost) : kMost;
    return std::max(all, kOthers + kFewest) - kOthers;
}

class OpenGathering final : public Gathering {
 public:
    explicit OpenGathering(const GatherOptions& options)
        : options_(options), indexes_(options.index_memory), sources_(most_open_files()) {}

    Status gather();

    const Job& job() const override { return job_; }
    const std::vector<fs::path>& files() const override { return files_; }
    const std::vector<SelectedRun>& runs() const override { return runs_; }
    const Coverage& coverage() const override { return coverage_; }
    const GatherReport& report() const override { return report_; }
    Result<std::shared_ptr<const std::vector<PageInfo>>> pages(std::size_t run) const override;
    Status read_page(std::size_t run, const PageInfo& info, const ColumnSet& columns, Page& page) const override;
    std::uint64_t bytes_read() const override { return bytes_read_; }

 private:
    void select(std::vector<Candidate> candidates);
    Result<std::shared_ptr<const FileSource>> source(std::size_t file) const;
    std::string place(const Candidate& c) const;
    std::string place(const SelectedRun& run) const;

    GatherOptions options_;
    Job job_;
    std::vector<fs::path> files_;
    std::vector<SelectedRun> runs_;
    Coverage coverage_;
    GatherReport report_;

    mutable std::mutex mutex_;
    mutable RecentCache<std::vector<PageInfo>> indexes_;
    mutable RecentCache<FileSource> sources_;
    mutable std::atomic<std::uint64_t> bytes_read_ = 0;
};

Status OpenGathering::gather() {
    Result<GatheredInputs> inputs = gather_inputs(options_, sources_);
    if (!inputs) return inputs.error();
    job_ = std::move(inputs->job);
    files_ = std::move(inputs->files);
    report_ = std::move(inputs->report);
    select(std::move(inputs->candidates));
    return {};
}

void OpenGathering::select(std::vector<Candidate> candidates) {
    const Selection selection = select_runs(candidates);
    report_.superseded_runs = selection.superseded.size();
    report_.repeated_runs = selection.repeated.size();
    for (const std::size_t i : selection.differing) {
        report_.left_out.push_back(
            {place(candidates[i]), "differs from the same samples in another file; the one with the smaller hash is kept"});
    }
    for (const std::size_t i : selection.overlapping) {
        Coverage lost = candidates[i].coverage;
        lost.remove(selection.coverage);
        report_.left_out.push_back({place(candidates[i]), "overlaps runs that hold more; samples " + to_string(lost) + " lost"});
    }
    for (const std::size_t i : selection.chosen) {
        Candidate& c = candidates[i];
        SelectedRun run{c.file, c.run.offset, c.run.header, std::move(c.coverage)};
        if (options_.samples) {
            Coverage within = run.coverage.intersection(Coverage(*options_.samples));
            if (within.empty()) continue;
            run.cut = within != run.coverage;
            run.coverage = std::move(within);
        }
        coverage_.add(run.coverage);
        runs_.push_back(std::move(run));
    }
}

std::string OpenGathering::place(const Candidate& c) const {
    return fmt::format("{}: samples {}", files_[c.file].string(), to_string(c.coverage));
}

std::string OpenGathering::place(const SelectedRun& run) const {
    return fmt::format("{}: samples {}..{}", files_[run.file].string(), run.header.samples.first, run.header.samples.end);
}

Result<std::shared_ptr<const FileSource>> OpenGathering::source(std::size_t file) const {
    const std::lock_guard lock(mutex_);
    if (std::shared_ptr<const FileSource> open = sources_.find(file)) return open;
    Result<FileSource> opened = FileSource::open(files_[file]);
    if (!opened) return opened.error();
    auto shared = std::make_shared<const FileSource>(std::move(*opened));
    sources_.insert(file, shared, 1);
    return std::shared_ptr<const FileSource>(shared);
}

Result<std::shared_ptr<const std::vector<PageInfo>>> OpenGathering::pages(std::size_t run) const {
    {
        const std::lock_guard lock(mutex_);
        if (std::shared_ptr<const std::vector<PageInfo>> held = indexes_.find(run)) return held;
    }
    const SelectedRun& selected = runs_[run];
    const Result<std::shared_ptr<const FileSource>> from = source(selected.file);
    if (!from) return from.error();
    Result<RunIndex> index = read_run_index(**from, {selected.offset, selected.header}, job_);
    if (!index) return index.error().at(place(selected));
    bytes_read_ += kRunHeaderSize + selected.header.index_size();
    const std::uint64_t cost = index->pages.size() * sizeof(PageInfo);
    auto pages = std::make_shared<const std::vector<PageInfo>>(std::move(index->pages));
    const std::lock_guard lock(mutex_);
    indexes_.insert(run, pages, cost);
    return std::shared_ptr<const std::vector<PageInfo>>(pages);
}

Status OpenGathering::read_page(std::size_t run, const PageInfo& info, const ColumnSet& columns, Page& page) const {
    const SelectedRun& selected = runs_[run];
    const Result<std::shared_ptr<const FileSource>> from = source(selected.file);
    if (!from) return from.error();
    ColumnSet needed = columns;
    needed.samples |= selected.cut;
    if (Status s = sampledb::read_page(**from, info, job_, needed, page); !s) return s.error().at(place(selected));
    bytes_read_ += info.stored_size;
    if (selected.cut) keep_samples(selected.coverage, page);
    return {};
}

}  // namespace

Result<std::unique_ptr<Gathering>> Gathering::open(const GatherOptions& options) {
    auto gathering = std::make_unique<OpenGathering>(options);
    if (Status s = gathering->gather(); !s) return s.error();
    return std::unique_ptr<Gathering>(std::move(gathering));
}

}  // namespace latent::sampledb
