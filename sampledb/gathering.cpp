#include "sampledb/gathering.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "sampledb/input_files.h"
#include "sampledb/page_filter.h"
#include "sampledb/part_name.h"
#include "sampledb/recent_cache.h"
#include "sampledb/selection.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostOpenFiles = 224;  // 256 with those that readers still hold and the tool's own

class OpenGathering final : public Gathering {
 public:
    explicit OpenGathering(const GatherOptions& options)
        : options_(options), indexes_(options.index_memory), sources_(kMostOpenFiles) {}

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
    struct Named {  // a file that the user named, and what it holds
        std::string path;
        Coverage coverage;
    };

    Status read_inputs(const std::vector<InputFile>& inputs);
    Status take_file(const InputFile& input, FoundFile file);
    Status refuse_or_leave_out(const InputFile& input, const Error& error);
    void report_state(const InputFile& input, const FileContents& file);
    Status check_jobs() const;
    Status check_repeats() const;
    void select();
    Result<std::shared_ptr<const FileSource>> source(std::size_t file) const;
    std::string place(const Candidate& c) const;
    std::string place(const SelectedRun& run) const;

    GatherOptions options_;
    Job job_;
    std::vector<fs::path> files_;
    std::vector<Candidate> candidates_;  // until the selection is made
    std::map<JobId, std::string> jobs_;  // job -> a file of it
    std::map<JobId, std::string> jobs_not_taken_;
    std::vector<Named> named_;
    std::vector<SelectedRun> runs_;
    Coverage coverage_;
    GatherReport report_;

    mutable std::mutex mutex_;
    mutable RecentCache<std::vector<PageInfo>> indexes_;
    mutable RecentCache<FileSource> sources_;
    mutable std::atomic<std::uint64_t> bytes_read_ = 0;
};

Status OpenGathering::gather() {
    const Result<std::vector<InputFile>> inputs = list_input_files(options_.inputs);
    if (!inputs) return inputs.error();
    if (Status s = read_inputs(*inputs); !s) return s;
    if (Status s = check_jobs(); !s) return s;
    if (Status s = check_repeats(); !s) return s;
    select();
    return {};
}

Status OpenGathering::read_inputs(const std::vector<InputFile>& inputs) {
    for (const InputFile& input : inputs) {
        Result<FoundFile> file = open_file(input.path, options_.verify);
        if (Status s = file ? take_file(input, std::move(*file)) : refuse_or_leave_out(input, file.error()); !s) return s;
    }
    if (!files_.empty()) return {};
    if (!jobs_not_taken_.empty()) {
        std::string found;
        for (const auto& [id, file] : jobs_not_taken_)
            found += fmt::format("{}{} ({})", found.empty() ? "" : ", ", to_hex(id), file);
        return Error{ErrorCode::kMismatch, fmt::format("no file is of job {}; found: {}", to_hex(*options_.job), found)};
    }
    if (!report_.left_out.empty()) {
        return Error{ErrorCode::kForeign,
                     fmt::format("{}: {}; nothing is left to read", report_.left_out[0].place, report_.left_out[0].reason)};
    }
    return Error{ErrorCode::kNotFound, "no Latent file to read"};
}

// A file that cannot be read at all. Damage costs a file; a file that should not be there at all costs the command, if the user
// named it.
Status OpenGathering::refuse_or_leave_out(const InputFile& input, const Error& error) {
    const bool damaged = error.code == ErrorCode::kTruncated || error.code == ErrorCode::kCorrupt;
    std::error_code ignored;
    const bool just_begun =
        is_attempt(input.path) && (error.code == ErrorCode::kTruncated || fs::file_size(input.path, ignored) == 0);
    const std::string name = input.path.string();
    if (just_begun) {
        report_.notes.push_back(name + ": holds no run yet");
    } else if (input.named && !damaged) {
        return error;
    } else {
        std::string reason = error.message;
        if (reason.starts_with(name + ": ")) reason.erase(0, name.size() + 2);
        report_.left_out.push_back({name, reason});
    }
    return {};
}

Status OpenGathering::take_file(const InputFile& input, FoundFile found) {
    const std::string name = input.path.string();
    FileContents& file = found.contents;
    const JobId id = file.header.job.id;
    if (options_.job && id != *options_.job) {
        jobs_not_taken_.emplace(id, name);
        report_.notes.push_back(fmt::format("{}: is of job {}, not taken", name, to_hex(id)));
        return {};
    }
    jobs_.emplace(id, name);
    if (jobs_.size() > 1) return {};  // refused once all jobs are known
    if (files_.empty()) {
        job_ = std::move(file.header.job);
    } else if (const Status same = same_job(job_, file.header.job); !same) {
        const Error error{ErrorCode::kMismatch,
                          fmt::format("{}: not of the job of {}: {}", name, files_[0].string(), same.error().message)};
        if (input.named) return error;
        report_.left_out.push_back({name, error.message.substr(name.size() + 2)});
        return {};
    }
    report_state(input, file);
    const std::uint32_t number = static_cast<std::uint32_t>(files_.size());
    files_.push_back(input.path);
    sources_.insert(number, found.source, 1);  // stays open: an attempt may lose its name any time
    Coverage held;
    for (const RunInfo& run : file.runs) {
        Result<Coverage> coverage = run_coverage(*found.source, run, job_);
        if (!coverage) {
            report_.left_out.push_back({fmt::format("{}: run at byte {}", name, run.offset), coverage.error().message});
            continue;
        }
        held.add(*coverage);
        candidates_.push_back({number, run, std::move(*coverage)});
    }
    if (input.named && !is_attempt(input.path)) named_.push_back({name, std::move(held)});
    return {};
}

void OpenGathering::report_state(const InputFile& input, const FileContents& file) {
    const std::string name = input.path.string();
    for (const Damage& damage : file.damage) report_.left_out.push_back({name, damage.reason});
    if (file.header_damaged) report_.notes.push_back(name + ": one copy of its header is damaged");
    if (file.finished) return;
    if (is_attempt(input.path)) {
        if (file.unfinished_tail > 0) {
            report_.notes.push_back(
                fmt::format("{}: unfinished; {} bytes behind its last run are not read", name, file.unfinished_tail));
        }
    } else if (const auto end = damage_at_end(input.path, file)) {
        report_.left_out.push_back({name + ": its end", end->reason});
    }
}

Status OpenGathering::check_jobs() const {
    if (jobs_.size() < 2) return {};
    const auto [a, a_file] = *jobs_.begin();
    const auto [b, b_file] = *std::next(jobs_.begin());
    return Error{ErrorCode::kMismatch, fmt::format("{} and {} are of different jobs ({} and {}): choose one with --job", a_file,
                                                   b_file, to_hex(a), to_hex(b))};
}

// Finished files that the user named must not hold a sample twice.
Status OpenGathering::check_repeats() const {
    if (options_.skip_duplicates) return {};
    struct Piece {
        SampleRange range;
        std::size_t file;
        auto operator<=>(const Piece&) const = default;
    };
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < named_.size(); ++i) {
        for (const SampleRange& range : named_[i].coverage.ranges()) pieces.push_back({range, i});
    }
    std::ranges::sort(pieces);
    for (std::size_t i = 1; i < pieces.size(); ++i) {
        const SampleRange& a = pieces[i - 1].range;
        const SampleRange& b = pieces[i].range;
        if (b.first >= a.end) continue;
        return Error{ErrorCode::kMismatch,
                     fmt::format("{} and {} both hold samples {}..{} (--skip-duplicates keeps one of them)",
                                 named_[pieces[i - 1].file].path, named_[pieces[i].file].path, b.first, std::min(a.end, b.end))};
    }
    return {};
}

void OpenGathering::select() {
    const Selection selection = select_runs(candidates_);
    report_.superseded_runs = selection.superseded.size();
    report_.repeated_runs = selection.repeated.size();
    for (const std::size_t i : selection.differing) {
        report_.left_out.push_back(
            {place(candidates_[i]), "differs from the same samples in another file; the one with the smaller hash is kept"});
    }
    for (const std::size_t i : selection.overlapping) {
        Coverage lost = candidates_[i].coverage;
        lost.remove(selection.coverage);
        report_.left_out.push_back({place(candidates_[i]), "overlaps runs that hold more; samples " + to_string(lost) + " lost"});
    }
    for (const std::size_t i : selection.chosen) {
        Candidate& c = candidates_[i];
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
    candidates_ = {};
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
