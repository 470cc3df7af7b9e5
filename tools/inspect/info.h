// tools/inspect/info.h: the contents of a file, without decoding it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/file_reader.h"

namespace latent::inspect {

// Bytes of one column, in all pages of the runs that count.
struct ColumnCost {
    std::string name;
    std::uint64_t stored = 0, decoded = 0;
};

struct ListedRun {
    sampledb::Coverage coverage;
    Hash128 content_hash;
};

struct FileInfo {
    std::filesystem::path path;
    std::uint64_t size = 0;
    sampledb::FileContents contents;
    sampledb::Coverage coverage;
    std::uint64_t runs = 0, superseded_runs = 0;  // runs that count, and those that others supersede
    std::uint64_t open_runs = 0;                  // among those that count: checkpoints, closing runs, runs that were cut at R
    std::uint64_t pages = 0, camera_records = 0, light_records = 0;  // in the runs that count
    std::uint64_t stored_bytes = 0;                                  // bytes of these
    std::vector<ListedRun> run_list;                                 // the runs that count, ascending by first sample
    std::vector<ColumnCost> columns;
    bool columns_estimated = false;  // from some of the pages: there are too many, or some are damaged

    // N: light paths behind the light image.
    std::uint64_t light_paths() const { return coverage.size() * contents.header.job.light_paths_per_sample; }
    // The part of stored_bytes that is in no column: headers, indexes, padding.
    std::uint64_t frame_bytes() const;
    // What of the file is not read; empty if all is well. Pages that were not looked at may be damaged too: `verify` reads them.
    std::vector<std::string> left_out() const;
    // What else to know: not finished, slow to develop.
    std::vector<std::string> remarks() const;
};

// Errors: those of opening the file and reading its header; kOutOfRange (more runs than fit `memory`, in bytes); kIo. Damage behind
// the header is left out, and listed.
Result<FileInfo> read_info(const std::filesystem::path& path, std::uint64_t memory = std::uint64_t{1} << 30);

std::string to_text(const FileInfo& info);
std::string to_json_text(const FileInfo& info);

}  // namespace latent::inspect
