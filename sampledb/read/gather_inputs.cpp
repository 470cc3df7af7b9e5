#include "sampledb/read/gather_inputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>

#include "sampledb/read/input_files.h"
#include "sampledb/read/part_name.h"

namespace latent::sampledb {

namespace fs = std::filesystem;

namespace {

// Which files are of the job, one after another, and what is wrong with the others.
class InputReader {
 public:
    InputReader(const GatherOptions& options, RecentCache<FileSource>& sources) : options_(options), sources_(sources) {
        for (const DamagedRun& run : options.damaged) damaged_.emplace(std::pair(run.file.string(), run.offset), run.reason);
    }

    Result<GatheredInputs> read() {
        const Result<std::vector<InputFile>> inputs = list_input_files(options_.inputs);
        if (!inputs) return inputs.error();
        if (Status s = read_inputs(*inputs); !s) return s.error();
        if (Status s = check_jobs(); !s) return s.error();
        if (Status s = check_repeats(); !s) return s.error();
        return std::move(found_);
    }

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

    const GatherOptions& options_;
    RecentCache<FileSource>& sources_;
    GatheredInputs found_;
    std::map<JobId, std::string> jobs_;  // job -> a file of it
    std::map<JobId, std::string> jobs_not_taken_;
    std::vector<Named> named_;
    std::map<std::pair<std::string, std::uint64_t>, std::string> damaged_;  // file, offset -> why
};

Status InputReader::read_inputs(const std::vector<InputFile>& inputs) {
    for (const InputFile& input : inputs) {
        Result<FoundFile> file = open_file(input.path, options_.verify);
        if (Status s = file ? take_file(input, std::move(*file)) : refuse_or_leave_out(input, file.error()); !s) return s;
    }
    if (!found_.files.empty()) return {};
    if (!jobs_not_taken_.empty()) {
        std::string found;
        for (const auto& [id, file] : jobs_not_taken_)
            found += fmt::format("{}{} ({})", found.empty() ? "" : ", ", to_hex(id), file);
        return Error{ErrorCode::kMismatch, fmt::format("no file is of job {}; found: {}", to_hex(*options_.job), found)};
    }
    if (!found_.report.left_out.empty()) {
        return Error{ErrorCode::kForeign, fmt::format("{}: {}; nothing is left to read", found_.report.left_out[0].place,
                                                      found_.report.left_out[0].reason)};
    }
    return Error{ErrorCode::kNotFound, "no Latent file to read"};
}

// A file that cannot be read at all. Damage costs a file; a file that should not be there at all costs the command, if the user
// named it. A read that the system refuses says nothing about the samples: it costs the command, which may fare better next time.
// What the user may not read is as foreign.
Status InputReader::refuse_or_leave_out(const InputFile& input, const Error& error) {
    const bool forbidden = ::access(input.path.c_str(), R_OK) != 0 && errno == EACCES;
    if (error.code == ErrorCode::kIo && !forbidden) return error;
    const bool damaged = error.code == ErrorCode::kTruncated || error.code == ErrorCode::kCorrupt;
    std::error_code ignored;
    const bool just_begun =
        is_attempt(input.path) && (error.code == ErrorCode::kTruncated || fs::file_size(input.path, ignored) == 0);
    const std::string name = input.path.string();
    if (just_begun) {
        found_.report.notes.push_back(name + ": holds no run yet");
    } else if (input.named && !damaged) {
        return error;
    } else {
        std::string reason = error.message;
        if (reason.starts_with(name + ": ")) reason.erase(0, name.size() + 2);
        if (fs::is_directory(input.path, ignored)) reason = "a folder inside a folder is not searched";
        found_.report.left_out.push_back({name, reason});
    }
    return {};
}

Status InputReader::take_file(const InputFile& input, FoundFile opened) {
    const std::string name = input.path.string();
    FileContents& file = opened.contents;
    const JobId id = file.header.job.id;
    if (options_.job && id != *options_.job) {
        jobs_not_taken_.emplace(id, name);
        found_.report.notes.push_back(fmt::format("{}: is of job {}, not taken", name, to_hex(id)));
        return {};
    }
    jobs_.emplace(id, name);
    if (jobs_.size() > 1) return {};  // refused once all jobs are known
    if (found_.files.empty()) {
        found_.job = std::move(file.header.job);
    } else if (const Status same = same_job(found_.job, file.header.job); !same) {
        const Error error{ErrorCode::kMismatch,
                          fmt::format("{}: not of the job of {}: {}", name, found_.files[0].string(), same.error().message)};
        if (input.named) return error;
        found_.report.left_out.push_back({name, error.message.substr(name.size() + 2)});
        return {};
    }
    report_state(input, file);
    const std::uint32_t number = static_cast<std::uint32_t>(found_.files.size());
    found_.files.push_back(input.path);
    sources_.insert(number, opened.source, 1);  // stays open: an attempt may lose its name any time
    Coverage held;
    for (const RunInfo& run : file.runs) {
        if (const auto damaged = damaged_.find({name, run.offset}); damaged != damaged_.end()) {
            found_.report.left_out.push_back({name, damaged->second});
            continue;
        }
        Result<Coverage> coverage = run_coverage(*opened.source, run, found_.job);
        if (!coverage && coverage.error().code == ErrorCode::kIo) return coverage.error().at(name);
        if (!coverage) {
            found_.report.left_out.push_back({fmt::format("{}: run at byte {}", name, run.offset), coverage.error().message});
            continue;
        }
        held.add(*coverage);
        found_.candidates.push_back({number, run, std::move(*coverage)});
    }
    if (input.named && !is_attempt(input.path)) named_.push_back({name, std::move(held)});
    return {};
}

void InputReader::report_state(const InputFile& input, const FileContents& file) {
    const std::string name = input.path.string();
    for (const Damage& damage : file.damage) {
        if (damage.loss) {
            found_.report.left_out.push_back({name, damage.reason});
        } else {
            found_.report.notes.push_back(name + ": " + damage.reason);
        }
    }
    if (file.finished) return;
    if (is_attempt(input.path)) {
        if (file.unfinished_tail > 0) {
            found_.report.notes.push_back(
                fmt::format("{}: unfinished; {} bytes behind its last run are not read", name, file.unfinished_tail));
        }
    } else if (const auto end = damage_at_end(input.path, file)) {
        found_.report.left_out.push_back({name, end->reason});
    }
}

Status InputReader::check_jobs() const {
    if (jobs_.size() < 2) return {};
    const auto [a, a_file] = *jobs_.begin();
    const auto [b, b_file] = *std::next(jobs_.begin());
    return Error{ErrorCode::kMismatch, fmt::format("{} and {} are of different jobs ({} and {}): choose one with --job", a_file,
                                                   b_file, to_hex(a), to_hex(b))};
}

// Finished files that the user named must not hold a sample twice.
Status InputReader::check_repeats() const {
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

}  // namespace

Result<GatheredInputs> gather_inputs(const GatherOptions& options, RecentCache<FileSource>& sources) {
    return InputReader(options, sources).read();
}

}  // namespace latent::sampledb
