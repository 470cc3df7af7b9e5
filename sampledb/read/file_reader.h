// sampledb/read/file_reader.h: what one file holds: by its footer, or by walking from run to run. docs/format.md, "Reading".
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/data/page.h"
#include "sampledb/format/file_header.h"
#include "sampledb/format/run_index.h"
#include "sampledb/read/byte_source.h"
#include "sampledb/read/damage.h"

namespace latent::sampledb {

class PageDecoder;

// How closely a run is looked at before it is used.
enum class VerifyLevel : std::uint8_t {
    kHeaders,  // header only; from a footer: the footer's copy of it
    kQuick,    // header, index and one page
    kStored,   // every stored byte
    kFull,     // every stored byte; every column decoded and compared with its content hash; every record in its node and coverage
    kOrdered,  // kFull, and what readers rely on without checking: records in order, and in the halves of squares that find_parts
               // names
};

// A file as found. The runs are those that passed the level asked for; damage lists what did not, and what is wrong with the
// frames.
struct FileContents {
    FileHeader header;
    bool finished = false;              // ends with a footer whose checksums are right
    std::string footer_provenance;      // finished files
    std::vector<RunInfo> runs;          // ascending by offset
    std::vector<Damage> damage;         // copies of the header, holes between runs, the footer's list, runs that failed
    Coverage lost_by_list;              // samples of the runs that a footer lists and a walk did not find
    bool footer_begun = false;          // not finished, but a footer begins behind the last run: it was cut off or damaged
    std::uint64_t unfinished_tail = 0;  // bytes behind the last run of a file without footer: a write that was cut short
    std::uint64_t end = 0;              // where the next run would begin
};

// Reads a file's list of runs. `use_footer = false` walks from run to run even if there is a footer, and compares what both say; so
// does a footer whose list contradicts itself.
// Errors: kForeign (not a Latent file), kTruncated (ends inside its header), kUnsupported, kCorrupt (both headers), kIo.
Result<FileContents> read_file(const ByteSource& source, VerifyLevel level = VerifyLevel::kHeaders, bool use_footer = true);

// What a file says of its job and its origin: its header, its footer's provenance. Errors as above.
Result<FileContents> read_frames(const ByteSource& source);

// A file that could be opened, and what it holds.
struct FoundFile {
    std::shared_ptr<const ByteSource> source;
    FileContents contents;
};
// Errors: those of open_source and read_file, naming the file.
Result<FoundFile> open_file(const std::filesystem::path& path, VerifyLevel level = VerifyLevel::kHeaders, bool use_footer = true);

// Coverage and pages of a run (offsets absolute in the file). Errors: kCorrupt (the run's own header is damaged, or not
// the one in `run`), kIo.
Result<RunIndex> read_run_index(const ByteSource& source, const RunInfo& run, const Job& job);

// The same for an index of any length: `take` is given its pages one by one, before all of it is known to be sound; what it returns
// ends the reading. Returns the coverage. Errors as above, and those of `take`.
Result<Coverage> scan_run_index(const ByteSource& source, const RunInfo& run, const Job& job,
                                const RunIndexDecoder::TakePage& take);

// The samples that a run holds: its header tells, or its index if there are gaps. Errors as above.
Result<Coverage> run_coverage(const ByteSource& source, const RunInfo& run, const Job& job);

// Checks one run. Errors as above, naming page and place.
Status verify_run(const ByteSource& source, const RunInfo& run, const Job& job, VerifyLevel level);

// Decodes the columns asked for; stored checksum and derived columns verified. Errors: kCorrupt, kTruncated, kUnsupported, kIo.
Status read_page(const ByteSource& source, const PageInfo& info, const Job& job, const ColumnSet& columns, PageDecoder& decoder,
                 Page& page);

}  // namespace latent::sampledb
