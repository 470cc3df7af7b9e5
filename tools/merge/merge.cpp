#include "tools/merge/merge.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/file.h"
#include "base/size.h"
#include "sampledb/format/footer.h"
#include "sampledb/read/recent_cache.h"
#include "tools/merge/compact.h"
#include "tools/merge/provenance.h"

namespace latent::merge {

using namespace sampledb;

namespace {

constexpr std::size_t kOpenInputs = 16;  // inputs that are kept open while runs are copied

// Grows the output run by run.
class Output {
 public:
    Output(OutputFile& out, const Gathering& gathering, const Progress& progress)
        : out_(out), gathering_(gathering), progress_(progress) {
        for (const SelectedRun& run : gathering.runs()) bytes_ahead_ += run.header.size();
    }

    Status begin() {
        const Result<Bytes> header = encode_file_header({gathering_.job(), ""});
        if (!header) return header.error();
        end_ = header->size();
        return out_.file().write_all(0, *header);
    }

    // Runs `first` .. `end`-1 of the gathering, as they are; neighbours of one file in one go.
    Status copy(std::size_t first, std::size_t end) {
        const std::vector<SelectedRun>& runs = gathering_.runs();
        for (std::size_t i = first; i < end;) {
            const SelectedRun& head = runs[i];
            std::uint64_t length = 0;
            for (; i < end && runs[i].file == head.file && runs[i].offset == head.offset + length && length < kLongestCopy; ++i) {
                runs_.push_back({end_ + length, runs[i].header});
                length += runs[i].header.size();
            }
            const Result<std::shared_ptr<const File>> input = open_input(head.file);
            if (!input) return input.error();
            if (Status s = out_.file().copy_from(**input, head.offset, end_, length); !s) return s;
            end_ += length;
            bytes_done_ += length;
            if (progress_) progress_(static_cast<double>(bytes_done_) / static_cast<double>(bytes_ahead_), format_size(end_));
        }
        return {};
    }

    Status compact(const CompactGroup& group) {
        const auto report = [&](std::uint64_t bytes) {
            if (progress_)
                progress_(static_cast<double>(bytes_done_ + bytes) / static_cast<double>(bytes_ahead_), format_size(end_));
        };
        const Result<RunHeader> header = compact_runs(gathering_, group, out_.file(), end_, report);
        if (!header) return header.error();
        for (std::size_t i = group.first; i < group.end; ++i) bytes_done_ += gathering_.runs()[i].header.size();
        runs_.push_back({end_, *header});
        end_ += header->size();
        return {};
    }

    // Reads the runs again; what is different now was spoiled on the way.
    Status verify(VerifyLevel level) {
        const FileView source(out_.file(), out_.path().string(), end_);
        for (const RunInfo& run : runs_) {
            if (Status s = verify_run(source, run, gathering_.job(), level); !s) return s.error().at(source.name());
        }
        return {};
    }

    Status end(const std::string& provenance) {
        const Result<Bytes> footer = encode_footer(runs_, provenance, end_);
        if (!footer) return footer.error().at(out_.path().string());
        if (Status s = out_.file().write_all(end_, *footer); !s) return s;
        end_ += footer->size();
        return out_.publish();
    }

    const std::vector<RunInfo>& runs() const { return runs_; }
    std::uint64_t size() const { return end_; }

 private:
    Result<std::shared_ptr<const File>> open_input(std::uint32_t file) {
        if (std::shared_ptr<const File> open = inputs_.find(file)) return open;
        Result<File> opened = File::open_read(gathering_.files()[file]);
        if (!opened) return opened.error();
        const auto input = std::make_shared<const File>(std::move(*opened));
        inputs_.insert(file, input, 1);
        return input;
    }

    static constexpr std::uint64_t kLongestCopy = std::uint64_t{1} << 30;  // so that the progress bar moves

    OutputFile& out_;
    const Gathering& gathering_;
    RecentCache<File> inputs_{kOpenInputs};
    const Progress& progress_;
    std::vector<RunInfo> runs_;
    std::uint64_t end_ = 0;
    std::uint64_t bytes_done_ = 0, bytes_ahead_ = 0;  // of the inputs
};

Status check_required(const MergeOptions& options, const Coverage& coverage) {
    if (!options.require || coverage.contains(*options.require)) return {};
    Coverage missing(*options.require);
    missing.remove(coverage);
    return Error{ErrorCode::kMismatch, fmt::format("samples {} are required but in no part", to_string(missing))};
}

// A part of an empty shard holds no run, and may be all there is; but not what is left of parts that were damaged.
Status check_anything_left(const Gathering& gathering) {
    const std::vector<LeftOut>& left_out = gathering.report().left_out;
    if (!gathering.runs().empty() || left_out.empty()) return {};
    return Error{ErrorCode::kCorrupt,
                 fmt::format("{}: {}; no run is left to merge", left_out.front().place, left_out.front().reason)};
}

}  // namespace

Result<MergeReport> merge(const MergeOptions& options, const Progress& progress) {
    Result<OutputFile> out = OutputFile::create(options.output, options.replace);
    if (!out) return out.error();
    GatherOptions gather;
    gather.inputs = options.inputs;
    gather.skip_duplicates = options.skip_duplicates;
    gather.job = options.job;
    gather.verify = options.verify;
    gather.index_memory = options.memory / 8;
    const Result<std::unique_ptr<Gathering>> opened = Gathering::open(gather);
    if (!opened) return opened.error();
    const Gathering& gathering = **opened;
    if (Status s = check_anything_left(gathering); !s) return s.error();
    if (Status s = check_required(options, gathering.coverage()); !s) return s.error();

    Output output(*out, gathering, progress);
    if (Status s = output.begin(); !s) return s.error();
    std::size_t next = 0;
    for (const CompactGroup& group : options.compact ? compact_groups(gathering, options.memory) : std::vector<CompactGroup>{}) {
        if (Status s = output.copy(next, group.first); !s) return s.error();
        if (Status s = output.compact(group); !s) return s.error();
        next = group.end;
    }
    if (Status s = output.copy(next, gathering.runs().size()); !s) return s.error();
    if (Status s = output.verify(options.verify); !s) return s.error();
    const Result<std::string> provenance = provenance_of(gathering);
    if (!provenance) return provenance.error();
    if (Status s = output.end(*provenance); !s) return s.error();

    MergeReport report;
    report.output = options.output.string();
    report.compacted = options.compact;
    report.job = gathering.job();
    report.coverage = gathering.coverage();
    report.runs_in = gathering.runs().size();
    report.runs_out = output.runs().size();
    report.bytes = output.size();
    report.gathering = gathering.report();
    std::vector<bool> used(gathering.files().size());
    for (const SelectedRun& run : gathering.runs()) {
        used[run.file] = true;
        report.camera_records += run.header.camera_records;
        report.light_records += run.header.light_records;
    }
    report.files = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
    return report;
}

}  // namespace latent::merge
