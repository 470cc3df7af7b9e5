#include "sampledb/read/checked_inputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <map>
#include <tuple>

#include "base/url.h"
#include "sampledb/data/unreadable.h"
#include "sampledb/read/input_files.h"
#include "sampledb/read/part_name.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMinForLists = std::uint64_t{1} << 18;  // a tool that needs more for other things says so itself

// The clause that follows the name of a file.
std::string reason_of(const Error& error, const fs::path& file) {
    const std::string place = shown_name(file) + ": ";
    return error.message.starts_with(place) ? error.message.substr(place.size()) : error.message;
}

bool is_called_a_part(const fs::path& path) { return path.extension() == ".latent" || is_attempt(path); }

// Which files are of the job, one after another, and what is wrong with the others.
class InputReader {
 public:
    InputReader(const RunSetOptions& options, RecentCache<ByteSource>& sources) : options_(options), sources_(sources) {
        for (const DamagedRun& run : options.damaged) damaged_.emplace(std::pair(run.file.string(), run.offset), run.reason);
    }

    Result<CheckedInputs> read() {
        for (const fs::path& input : options_.inputs) {
            const Result<std::vector<InputFile>> files = list_input_files({input});
            if (!files && !options_.keep_going) return files.error();
            if (!files) {
                leave_out(found_.report.left_out, {shown_name(input), reason_of(files.error(), input)});
            } else if (Status s = read_inputs(*files); !s) {
                return s.error();
            }
        }
        if (found_.files.empty()) return nothing_found();
        if (Status s = check_jobs(); !s) return s.error();
        if (Status s = check_repeats(); !s) return s.error();
        return std::move(found_);
    }

 private:
    Status read_inputs(const std::vector<InputFile>& inputs);
    Error nothing_found() const;
    bool may_refuse(const InputFile& input) const { return input.named && !options_.keep_going; }
    Status take_file(const InputFile& input, FoundFile file);
    Status take_runs(const std::string& name, const ByteSource& source, FileContents& file);
    Status count_memory(const FileContents& file);
    Status refuse_or_leave_out(const InputFile& input, const Error& error);
    void report_state(const InputFile& input, const FileContents& file);
    Status check_jobs() const;
    Status check_repeats() const;

    const RunSetOptions& options_;
    RecentCache<ByteSource>& sources_;
    CheckedInputs found_;
    std::map<JobId, std::pair<std::string, Job>> jobs_;  // a file of each
    std::map<JobId, std::string> jobs_not_taken_;
    std::map<std::pair<std::string, std::uint64_t>, std::string> damaged_;  // file, offset -> why
    std::vector<bool> must_not_repeat_;                                     // which of the files
    std::uint64_t runs_ = 0, intervals_ = 0;                                // intervals beyond the first of each run
};

Status InputReader::read_inputs(const std::vector<InputFile>& inputs) {
    for (const InputFile& input : inputs) {
        Result<FoundFile> file = open_file(input.path, options_.verify);
        if (Status s = file ? take_file(input, std::move(*file)) : refuse_or_leave_out(input, file.error()); !s) return s;
    }
    return {};
}

Error InputReader::nothing_found() const {
    if (!jobs_not_taken_.empty()) {
        std::string found;
        for (const auto& [id, file] : jobs_not_taken_)
            found += fmt::format("{}{} ({})", found.empty() ? "" : ", ", to_hex(id), file);
        return Error{ErrorCode::kMismatch, fmt::format("no file belongs to job {}; found {}", to_hex(*options_.job), found)};
    }
    if (!found_.report.left_out.empty()) {
        return Error{ErrorCode::kForeign, fmt::format("{}: {}; nothing is left to read", found_.report.left_out[0].place,
                                                      found_.report.left_out[0].reason)};
    }
    return Error{ErrorCode::kNotFound, "no Latent files found"};
}

// A file that cannot be read at all. Damage costs a file; a file that should not be there at all costs the command, if the user
// named it. A read that the system refuses says nothing about the samples: it costs the command, which may fare better next time.
// What the user may not read is as foreign. What lies in a folder and is no sample file even by its name, such as a log, is no
// loss.
Status InputReader::refuse_or_leave_out(const InputFile& input, const Error& error) {
    const bool forbidden = ::access(input.path.c_str(), R_OK) != 0 && errno == EACCES;
    if (error.code == ErrorCode::kIo && !forbidden && !options_.keep_going) return error;
    const bool damaged = is_damage(error);
    std::error_code ignored;
    const bool just_begun =
        is_attempt(input.path) && (error.code == ErrorCode::kTruncated || fs::file_size(input.path, ignored) == 0);
    const std::string name = shown_name(input.path);
    const std::string reason =
        fs::is_directory(input.path, ignored) ? "a folder inside a folder is not searched" : reason_of(error, input.path);
    if (just_begun) {
        found_.report.notes.push_back(name + ": holds no run yet");
    } else if (may_refuse(input) && !damaged) {
        return error;
    } else if (!input.named && error.code == ErrorCode::kForeign && !is_called_a_part(input.path)) {
        found_.report.notes.push_back(fmt::format("{}: {}, skipped", name, reason));
    } else {
        leave_out(found_.report.left_out, {name, reason});
    }
    return {};
}

Status InputReader::take_file(const InputFile& input, FoundFile opened) {
    const std::string name = shown_name(input.path);
    FileContents& file = opened.contents;
    const JobId id = file.header.job.id;
    if (options_.job && id != *options_.job) {
        jobs_not_taken_.emplace(id, name);
        found_.report.notes.push_back(fmt::format("{}: belongs to job {}, skipped", name, to_hex(id)));
        return {};
    }
    jobs_.try_emplace(id, name, file.header.job);
    if (jobs_.size() > 1) return {};  // refused once all jobs are known
    if (found_.files.empty()) {
        found_.job = std::move(file.header.job);
    } else if (const Status same = same_job(found_.job, file.header.job); !same) {
        const Error error{ErrorCode::kMismatch, fmt::format("{}: does not belong to the job of {}: {}", name,
                                                            shown_name(found_.files[0]), same.error().message)};
        if (may_refuse(input)) return error;
        leave_out(found_.report.left_out, {name, reason_of(error, input.path)});
        return {};
    }
    report_state(input, file);
    for_each_origin(file, [&](std::string_view origin) {
        const std::optional<Resolution> pixels = resolution_in(origin);
        const auto size = [](const Resolution& r) { return std::tuple(std::uint64_t{r.width} * r.height, r.width); };
        if (pixels && (!found_.resolution || size(*found_.resolution) < size(*pixels))) found_.resolution = pixels;
    });
    const std::uint32_t number = static_cast<std::uint32_t>(found_.files.size());
    found_.files.push_back(input.path);
    if (options_.announced_reads) opened.source->expect_scattered_reads();
    sources_.insert(number, opened.source, 1);  // stays open: an attempt may lose its name any time
    must_not_repeat_.push_back(may_refuse(input) && !is_attempt(input.path));
    return take_runs(name, *opened.source, file);
}

Status InputReader::take_runs(const std::string& name, const ByteSource& source, FileContents& file) {
    if (Status s = count_memory(file); !s) return s;
    std::vector<SelectedRun>& runs = found_.runs;
    const std::size_t count = runs.size() + file.runs.size();
    if (count > runs.capacity()) runs.reserve(runs.empty() ? count : std::max(count, runs.capacity() + runs.capacity() / 4));
    const auto number = static_cast<std::uint32_t>(found_.files.size() - 1);
    for (const RunInfo& run : file.runs) {
        if (const auto damaged = damaged_.find({found_.files.back().string(), run.offset}); damaged != damaged_.end()) {
            leave_out(found_.report.left_out, {name, damaged->second});
            continue;
        }
        Result<Coverage> coverage = run_coverage(source, run, found_.job);
        if (!coverage && coverage.error().code == ErrorCode::kIo) return coverage.error().at(name);
        if (coverage) {
            runs.push_back({number, false, run.offset, run.header, std::move(*coverage)});
        } else {
            leave_out(found_.report.left_out, {fmt::format("{}: run at byte {}", name, run.offset), coverage.error().message});
        }
    }
    return {};
}

// Before the list of runs grows.
Status InputReader::count_memory(const FileContents& file) {
    runs_ += file.runs.size();
    for (const RunInfo& run : file.runs) intervals_ += run.header.interval_count - 1;
    found_.list_memory = list_memory_of(runs_, intervals_);
    return check_list_memory(runs_, intervals_, options_.memory);
}

void InputReader::report_state(const InputFile& input, const FileContents& file) {
    const std::string name = shown_name(input.path);
    for (const Damage& damage : file.damage) {
        if (damage.loss) {
            leave_out(found_.report.left_out, {name, damage.reason});
        } else {
            found_.report.notes.push_back(name + ": " + damage.reason);
        }
    }
    if (file.finished) return;
    if (is_attempt(input.path)) {
        if (file.unfinished_tail > 0) {
            found_.report.notes.push_back(
                fmt::format("{}: unfinished; {} bytes after its last run were ignored", name, file.unfinished_tail));
        }
    } else if (const auto end = damage_at_end(input.path, file)) {
        leave_out(found_.report.left_out, {name, end->reason});
    }
}

Status InputReader::check_jobs() const {
    if (jobs_.size() < 2) return {};
    const auto& [a_file, a] = jobs_.begin()->second;
    const auto& [b_file, b] = std::next(jobs_.begin())->second;
    const std::string_view field = differing_field(a, b);
    return Error{ErrorCode::kMismatch,
                 fmt::format("{} and {} belong to different jobs ({} and {}{}); choose one with --job", a_file, b_file,
                             to_hex(a.id), to_hex(b.id), field.empty() ? "" : fmt::format("; {} differs", field))};
}

// Finished files that the user named must not hold a sample twice.
Status InputReader::check_repeats() const {
    if (options_.skip_duplicates) return {};
    // Intervals in ascending order, each the next of some run.
    struct Next {
        SampleRange range;
        std::uint32_t run, interval;
        bool operator>(const Next& other) const { return range > other.range; }
    };
    std::vector<Next> ahead;
    ahead.reserve(found_.runs.size());
    for (std::uint32_t i = 0; i < found_.runs.size(); ++i) {
        if (must_not_repeat_[found_.runs[i].file]) ahead.push_back({found_.runs[i].coverage.ranges().front(), i, 0});
    }
    std::ranges::make_heap(ahead, std::greater{});
    std::uint64_t reached = 0;
    std::uint32_t holder = 0;  // the file that reaches so far
    while (!ahead.empty()) {
        std::ranges::pop_heap(ahead, std::greater{});
        Next& next = ahead.back();
        const SelectedRun& run = found_.runs[next.run];
        if (next.range.first < reached && run.file != holder) {
            const auto [a, b] = std::minmax(holder, run.file);
            return Error{ErrorCode::kMismatch, fmt::format("{} and {} both hold samples {}:{}; --skip-duplicates uses one of them",
                                                           shown_name(found_.files[a]), shown_name(found_.files[b]),
                                                           next.range.first, std::min(reached, next.range.end))};
        }
        if (next.range.end > reached) reached = next.range.end, holder = run.file;
        if (++next.interval < run.coverage.ranges().size()) {
            next.range = run.coverage.ranges()[next.interval];
            std::ranges::push_heap(ahead, std::greater{});
        } else {
            ahead.pop_back();
        }
    }
    return {};
}

}  // namespace

std::uint64_t list_memory_of(std::uint64_t runs, std::uint64_t intervals) {
    constexpr std::uint64_t kRun = sizeof(SelectedRun) + 48;      // and numbers that stand for it while runs are chosen
    constexpr std::uint64_t kInterval = 2 * sizeof(SampleRange);  // in its run, in the union of all
    return runs * kRun + intervals * kInterval;
}

Status check_list_memory(std::uint64_t runs, std::uint64_t intervals, std::uint64_t memory) {
    const std::uint64_t needed = list_memory_of(runs, intervals);
    if (needed <= std::max(memory / 4 * 3, kMinForLists)) return {};
    return Error{ErrorCode::kOutOfRange, fmt::format("--memory: too small; {} runs with {} intervals of samples need at least {}M",
                                                     runs, runs + intervals, memory_with_list(needed) >> 20)};
}

std::uint64_t memory_with_list(std::uint64_t list_memory) {
    return list_memory <= kMinForLists ? 0 : ((list_memory + 2) / 3 * 4 + (1 << 20)) >> 20 << 20;
}

Result<CheckedInputs> checked_inputs(const RunSetOptions& options, RecentCache<ByteSource>& sources) {
    return InputReader(options, sources).read();
}

}  // namespace latent::sampledb
