// sampledb/read/run_set.h: the files that a tool was given, seen as one set of selected runs. docs/format.md, "Selection".
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"
#include "sampledb/read/selection.h"

namespace latent::sampledb {

// A run that a reader of a run set found damaged.
struct DamagedRun {
    std::filesystem::path file;
    std::uint64_t offset = 0;  // where its first byte is
    std::string reason;        // "run at byte 8192: page 3: checksum mismatch; samples 65536:131072 lost"
};

struct RunSetOptions {
    std::vector<std::filesystem::path> inputs;   // files, folders (all that they hold), or NAME.latent not yet published
    bool skip_duplicates = false;                // files named one by one may cover a sample twice: the repeat is dropped
    bool keep_going = false;                     // what is wrong with a file named one by one costs that file, as in a folder
    std::optional<JobId> job;                    // keep this job, leave others out
    std::optional<SampleRange> samples;          // only these sample numbers
    VerifyLevel verify = VerifyLevel::kHeaders;  // runs that fail are left out; kFull and kOrdered read every byte once more
    std::vector<DamagedRun> damaged;             // left out as well
    bool announced_reads = false;                // pages are announced by `will_read`: nothing else is read ahead
    // --memory of the tool, in bytes: the list of runs may take three quarters of it (or 256 KiB), indexes held at once an eighth;
    // the rest of these is read again when needed.
    std::uint64_t memory = std::uint64_t{1} << 30;
};

// Bytes that a list of runs takes while some are chosen. `intervals`: those beyond the first of each run.
std::uint64_t list_memory_of(std::uint64_t runs, std::uint64_t intervals);
// Whole MiB, in bytes, of the least RunSetOptions::memory that has room for a list of that size.
std::uint64_t memory_with_list(std::uint64_t list_memory);
// Whether `memory`, as in RunSetOptions, has. Errors: kOutOfRange, naming what is needed.
Status check_list_memory(std::uint64_t runs, std::uint64_t intervals, std::uint64_t memory);

struct LeftOut {
    std::string place;        // "b.latent: run 3" or a file name
    std::string reason;       // one clause: "checksum mismatch, samples 65536:131072 lost"
    std::uint64_t count = 1;  // how many are left out
};
// Adds to a list that stays short, like that of a file's damage.
void leave_out(std::vector<LeftOut>& list, LeftOut item);

struct RunSetReport {
    std::vector<LeftOut> left_out;   // not empty: exit 3
    std::vector<std::string> notes;  // normal, but worth a line: unfinished tail, superseded runs
    std::uint64_t superseded_runs = 0, repeated_runs = 0;
};

// Thread-safe for reading once open. At most 256 files, and no more than the system allows, are open at a time; files are
// opened again when needed.
class RunSet {
 public:
    // Errors, naming the files: kIo, kNotFound and kForeign (of files named one by one), kMismatch (another job; a sample that
    // finished files named one by one hold twice), kOutOfRange (more runs or intervals than `memory` is enough for).
    static Result<std::unique_ptr<RunSet>> open(const RunSetOptions& options);
    virtual ~RunSet() = default;

    virtual const Job& job() const = 0;
    virtual const std::vector<std::filesystem::path>& files() const = 0;
    virtual const std::vector<SelectedRun>& runs() const = 0;  // ascending by first sample
    virtual const Coverage& coverage() const = 0;              // what the selected runs cover, cut to `samples`
    virtual const RunSetReport& report() const = 0;

    // Pixels of the picture that the samples were rendered for, the largest if files differ; none if no file says.
    virtual std::optional<Resolution> resolution() const { return std::nullopt; }

    // Bytes that the list of runs takes, of their intervals too.
    virtual std::uint64_t list_memory() const { return 0; }

    // N, by which the light image is divided: light paths per sample x samples selected.
    std::uint64_t light_paths() const { return coverage().size() * job().light_paths_per_sample; }

    // The pages of run `run` (index into runs()): camera pages, then light pages, each ascending by the Z prefixes of their
    // records.
    virtual Result<std::shared_ptr<const std::vector<PageInfo>>> pages(std::size_t run) const = 0;

    // Decodes a page into `page`, checksums verified. Errors: kCorrupt, kTruncated, kIo, with file, run and page named.
    // `cut` runs are already filtered to the sample range.
    virtual Status read_page(std::size_t run, const PageInfo& info, const ColumnSet& columns, PageDecoder& decoder,
                             Page& page) const = 0;

    // Pages first .. last of a run (their infos, ascending by offset) are read soon: they may be on their way.
    virtual void will_read(std::size_t run, const PageInfo& first, const PageInfo& last) const = 0;

    // Bytes read so far, from disk or from the system's cache.
    virtual std::uint64_t bytes_read() const = 0;
};

// Gives `take` the JSON objects in which the first of the files tells its origin (provenance.h): all parts of a job say the same of
// their scene. Errors: of reading.
Status for_each_origin(const RunSet& run_set, const std::function<void(std::string_view)>& take);

}  // namespace latent::sampledb
