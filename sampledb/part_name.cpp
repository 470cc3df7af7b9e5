#include "sampledb/part_name.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>

#include "sampledb/run_codec.h"

namespace latent::sampledb {

namespace {

namespace fs = std::filesystem;

struct OpenedFile {
    std::shared_ptr<const FileSource> source;
    FileContents contents;
};

Result<OpenedFile> open_file(const fs::path& path) {
    Result<FileSource> source = FileSource::open(path);
    if (!source) return source.error();
    Result<FileContents> contents = read_file(*source);
    if (!contents) return contents.error();
    return OpenedFile{std::make_shared<const FileSource>(std::move(*source)), std::move(*contents)};
}

Error of_another_job(const fs::path& path, const Job& job, const Error& difference) {
    return {ErrorCode::kMismatch,
            fmt::format("{}: holds another job than {}: {}; choose another name for the output, or start over with --force",
                        path.string(), to_hex(job.id), difference.message)};
}

bool lies_in_one_interval(SampleRange samples, std::uint64_t run_samples) {
    return !samples.empty() && samples.first / run_samples == (samples.end - 1) / run_samples;
}

// The smaller content hash decides between two runs of the same samples, as in every selection.
bool preferred(const StoredRun& a, const StoredRun& b) { return a.run.header.content_hash < b.run.header.content_hash; }

}  // namespace

std::vector<fs::path> attempts_of(const fs::path& name) {
    std::vector<fs::path> attempts;
    const std::string prefix = name.filename().string() + ".part.";
    std::error_code error;
    for (fs::directory_iterator entry(folder_of(name), error), end; !error && entry != end; entry.increment(error)) {
        if (entry->path().filename().string().rfind(prefix, 0) == 0) attempts.push_back(entry->path());
    }
    std::sort(attempts.begin(), attempts.end());
    return attempts;
}

Result<CommittedRuns> find_committed(const fs::path& name, const Job& job, SampleRange range) {
    std::map<SampleRange, StoredRun> canonical, loose;
    for (const fs::path& path : attempts_of(name)) {
        const Result<OpenedFile> file = open_file(path);
        if (!file) continue;  // torn before its first run, or damaged beyond reading: what it held is rendered again
        if (Status s = same_job(file->contents.header.job, job); !s) return of_another_job(path, job, s.error());
        for (const RunInfo& run : file->contents.runs) {
            const StoredRun stored{file->source, run};
            const SampleRange samples = stored.samples();
            if (!lies_in_one_interval(samples, job.run_samples) || samples.end <= range.first || samples.first >= range.end)
                continue;
            const bool whole = samples.end % job.run_samples == 0 && run.header.interval_count == 1 && samples.end <= range.end;
            auto [at, is_new] = (whole ? canonical : loose).try_emplace(samples, stored);
            if (!is_new && preferred(stored, at->second)) at->second = stored;
        }
    }
    CommittedRuns found;
    Coverage covered;
    for (auto& [samples, stored] : canonical) {
        if (!covered.intersects(samples)) found.canonical.push_back(stored), covered.add(samples);
    }
    for (auto& [samples, stored] : loose) {
        if (!covered.contains(samples)) found.loose.push_back(stored);
    }
    return found;
}

Result<Coverage> coverage_of(const ByteSource& source, const FileContents& contents) {
    Coverage covered;
    for (const RunInfo& run : contents.runs) {
        if (run.header.interval_count == 1) {
            covered.add(run.header.samples);
            continue;
        }
        const Result<RunIndex> index = read_run_index(source, run, contents.header.job);
        if (!index) return index.error();
        covered.add(index->coverage);
    }
    return covered;
}

Result<bool> is_published(const fs::path& name, const Job& job, SampleRange range) {
    const Result<OpenedFile> file = open_file(name);
    if (!file && file.error().code == ErrorCode::kNotFound) return false;
    if (!file) return file.error();
    if (Status s = same_job(file->contents.header.job, job); !s) return of_another_job(name, job, s.error());
    const Result<Coverage> covered = coverage_of(*file->source, file->contents);
    if (!covered) return covered.error();
    if (range.empty() || covered->contains(range)) return true;
    return Error{
        ErrorCode::kMismatch,
        fmt::format("{}: is finished and holds samples {}, not all of {}; write the other samples to another name and merge, "
                    "or start over with --force",
                    name.string(), to_string(*covered), to_string(Coverage(range)))};
}

void remove_superfluous_attempts(const fs::path& name, const Job& job, const Coverage& covered) {
    for (const fs::path& path : attempts_of(name)) {
        const Result<OpenedFile> file = open_file(path);
        bool superfluous;
        if (file) {
            const Result<Coverage> held = coverage_of(*file->source, file->contents);
            superfluous = same_job(file->contents.header.job, job) && held && covered.contains(*held);
        } else {
            std::error_code ignored;  // empty, or it ends inside its header: it holds nothing
            superfluous = file.error().code == ErrorCode::kTruncated || fs::file_size(path, ignored) == 0;
        }
        if (superfluous) ::unlink(path.c_str());
    }
}

Status remove_everything(const fs::path& name) {
    std::vector<fs::path> paths = attempts_of(name);
    paths.push_back(name);
    for (const fs::path& path : paths) {
        if (::unlink(path.c_str()) != 0 && errno != ENOENT) return error_from_errno(errno, path.string(), "cannot remove");
    }
    return sync_folder(folder_of(name));
}

}  // namespace latent::sampledb
