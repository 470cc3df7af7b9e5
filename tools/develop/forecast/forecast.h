// tools/develop/forecast/forecast.h: the time, memory and disk space that a picture will take, before it is developed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/result.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/forecast/estimate.h"

namespace latent::develop {

struct Forecast {
    std::string output;          // the first one's
    std::uint32_t pictures = 1;  // more than one if an exposure is cut into frames; the seconds and file_bytes are those of all
    std::uint32_t width = 0, height = 0;  // the whole film's
    PixelRect crop;
    std::optional<double> seconds, cpu_seconds;         // none: the picture does not fit, so nobody waits for it
    std::uint64_t file_bytes = 0, temporary_bytes = 0;  // at most, without compression; about
    std::uint64_t memory = 0, memory_for_all = 0;       // the limit; what would hold all records at once
    std::optional<std::uint64_t> free_bytes;            // in the folder of the output, if the system says

    bool fits() const { return !free_bytes || file_bytes + temporary_bytes <= *free_bytes; }
};
std::string to_text(const Forecast& forecast);
std::string to_json(const Forecast& forecast);

// Errors: kNoSpace, saying what to do.
Status check_space(const std::filesystem::path& output, bool replace, std::uint64_t bytes);

// How long a file of `bytes` at `folder` makes its writer wait for the disk, found out by writing a file without a name for a fifth
// of a second, or somewhat longer if the disk is slow. 0 if none can be written.
double seconds_to_reach_disk(std::uint64_t bytes, const std::filesystem::path& folder);

// A picture that is developed to see what that costs: `crop` of a picture of that size, from the first `runs` in random order.
struct TrialPicture {
    std::uint32_t width = 0, height = 0;
    PixelRect crop;
    std::size_t runs = 0;
    int reach = 0;  // the filter's, in pixels
};
struct TrialOutcome {
    Cost cost;
    std::uint64_t decoded = 0;  // bytes of pages, on disk
    std::uint64_t segments = 0;
    std::uint64_t temporary_bytes = 0;  // on disk
};
using PictureTrial = std::function<Result<TrialOutcome>(const TrialPicture&)>;

// What `picture` will cost, from trials of about 1.2 seconds in all: one pixel of it for the cost of a byte of pages that is
// decoded, then pieces for that of drawing. `decoded`: bytes of pages that will be decoded for it, repeats included; `segments`:
// that these have. Errors: those of `trial`.
Result<TrialOutcome> extrapolate(const TrialPicture& picture, double decoded, double segments, const PictureTrial& trial);

}  // namespace latent::develop
