// tools/inspect/recover.h: the readable runs of a damaged file, copied to a new one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/data/coverage.h"
#include "sampledb/read/file_reader.h"

namespace latent::inspect {

struct RecoverReport {
    std::filesystem::path input, output;
    std::uint64_t runs = 0, bytes = 0;  // written
    sampledb::Coverage kept;
    sampledb::Coverage lost;  // as far as headers and footer still tell
    std::vector<sampledb::Damage> damage;
    std::uint64_t unfinished_tail = 0;  // what an interrupted write left: no loss of anything committed
    bool lost_anything() const { return std::ranges::any_of(damage, &sampledb::Damage::loss); }
};

// Reads every byte of `input`, copies each run that is sound to `output` as it is, and verifies the result.
// Errors: those of reading the header, kCorrupt (no run is sound, though there were more bytes), kExists (`output` is there; or is
// `input`, by whatever name, even if it may be replaced), kIo, kNoSpace; then there is no output.
Result<RecoverReport> recover(const std::filesystem::path& input, const std::filesystem::path& output, bool replace,
                              const Progress& progress = {});

std::string to_text(const RecoverReport& report);
std::string to_json_text(const RecoverReport& report);

}  // namespace latent::inspect
