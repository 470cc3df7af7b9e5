#include "sampledb/read/part_name.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>

#include "base/json.h"
#include "base/size.h"
#include "sampledb/read/provenance.h"

namespace latent::sampledb {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPart = ".part.";

// " (latent-render 0.1.0, render epoch 4)", as far as a file tells: another version makes another job of the same scene.
std::string made_by(const FileContents& file) {
    const std::string provenance = quote_provenance(file.header.provenance_json, kHeaderProvenanceDepth).json;
    const auto program = nlohmann::json::parse(member_of(provenance, "program"), nullptr, false);
    const std::string_view epoch = member_of(provenance, "render_epoch");
    if (!program.is_string()) return "";
    return fmt::format(" ({}{})", program.get<std::string>(), epoch.empty() ? "" : fmt::format(", render epoch {}", epoch));
}

}  // namespace

bool is_attempt(const fs::path& path) { return path.filename().string().find(std::string(".latent") + kPart) != std::string::npos; }

fs::path new_attempt(const fs::path& name) { return name.string() + kPart + make_nonce(); }

Status check_length(const fs::path& name) {
    const std::size_t length = new_attempt(name).filename().string().size();
    if (length <= NAME_MAX) return {};
    return usage_error(fmt::format("{}: the name is too long by {}: until it is finished, the file is called NAME{}<nonce>",
                                   name.string(), counted(length - NAME_MAX, "byte"), kPart));
}

Status check_same_job(const FoundFile& file, const Job& job) {
    const Status same = same_job(file.contents.header.job, job);
    if (same) return same;
    return Error{ErrorCode::kMismatch, fmt::format("{}{}: holds {}; choose another name for the output, or start over with --force",
                                                   file.source->name(), made_by(file.contents), same.error().message)};
}

std::vector<fs::path> attempts_of(const fs::path& name) {
    std::vector<fs::path> attempts;
    const std::string prefix = name.filename().string() + kPart;
    std::error_code error;
    for (fs::directory_iterator entry(folder_of(name), error), end; !error && entry != end; entry.increment(error)) {
        if (entry->path().filename().string().rfind(prefix, 0) == 0) attempts.push_back(entry->path());
    }
    std::sort(attempts.begin(), attempts.end());
    return attempts;
}

Result<Coverage> coverage_of(const ByteSource& source, const FileContents& contents) {
    std::vector<SampleRange> covered;
    for (const RunInfo& run : contents.runs) {
        const Result<Coverage> held = run_coverage(source, run, contents.header.job);
        if (!held) return held.error();
        covered.insert(covered.end(), held->ranges().begin(), held->ranges().end());
    }
    return Coverage::of(std::move(covered));
}

Result<Published> look_at_published(const fs::path& name, const Job& job, SampleRange range) {
    const Result<FoundFile> file = open_file(name);
    if (!file && file.error().code == ErrorCode::kNotFound) return Published::kNot;
    if (!file) return file.error();
    if (Status s = check_same_job(*file, job); !s) return s.error();
    const Result<Coverage> covered = coverage_of(*file->source, file->contents);
    if (!covered) return covered.error().at(name.string());
    if (range.empty() || covered->contains(range)) return Published::kWhole;
    if (Coverage(range).contains(*covered)) return Published::kInPart;
    return Error{ErrorCode::kMismatch,
                 fmt::format("{}: finished, with samples {}, neither all of {} nor only those; write the other samples to another "
                             "file and merge, or start over with --force",
                             name.string(), to_string(*covered), to_string(Coverage(range)))};
}

Status make_attempt_of(const fs::path& name) {
    if (::rename(name.c_str(), new_attempt(name).c_str()) == 0 || errno == ENOENT) return {};
    return error_from_errno(errno, name.string(), "cannot rename");
}

void remove_superfluous_attempts(const fs::path& name, const Job& job, const Coverage& covered) {
    for (const fs::path& path : attempts_of(name)) {
        const Result<FoundFile> file = open_file(path);
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
