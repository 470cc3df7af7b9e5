// tools/develop/forecast.h: the time, memory and disk space that a picture will take, before it is developed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"
#include "tools/develop/preview.h"

namespace latent::develop {

struct Forecast {
    std::string output;
    std::uint32_t width = 0, height = 0;
    std::optional<double> seconds;                      // none: the picture does not fit, so nobody waits for it
    std::uint64_t file_bytes = 0, temporary_bytes = 0;  // at most, without compression; about
    std::uint64_t memory = 0, memory_for_all = 0;       // the limit; what would hold all records at once
    std::optional<std::uint64_t> free_bytes;            // in the folder of the output, if the system says

    bool fits() const { return !free_bytes || file_bytes + temporary_bytes <= *free_bytes; }
};
std::string to_text(const Forecast& forecast);
std::string to_json(const Forecast& forecast);

// For `output`, which gets the place of another file if it replaces one.
std::optional<std::uint64_t> free_space(const std::filesystem::path& output, bool replace);
// Errors: kNoSpace, saying what to do.
Status check_space(const std::filesystem::path& output, bool replace, std::uint64_t bytes);

// Seconds that a file of `bytes` takes to reach the disk at `folder`, found out by writing a file without a name for about a
// second. 0 if none can be written.
double seconds_to_write(std::uint64_t bytes, const std::filesystem::path& folder);

// Seconds that all `runs` will take, found out by developing one of them, then more in about `seconds`. Errors: those of `trial`.
Result<double> seconds_for(std::size_t runs, double seconds, const Trial& trial);

}  // namespace latent::develop
