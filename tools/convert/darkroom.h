// tools/convert/darkroom.h: prints of photographic film: what is asked of the enlarger, and the process that it makes.
// docs/film.md.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "color/film/grain.h"
#include "color/film/process.h"
#include "tools/convert/film_kernel.h"

namespace latent::convert {

struct ConvertOptions;
struct Source;

// Light that comes back from the base of the film: none, a little, or much where the back does not absorb it.
enum class Halation : std::uint8_t { kNone, kBacked, kBare };

struct DarkroomOptions {
    std::string look;                              // a name in looks.h, for what is not given; "": none
    std::string paper;                             // "": a print of a picture that is not on film
    std::string film;                              // whose exposures the picture holds; "": as the picture says
    std::optional<std::array<double, 3>> filters;  // densities of Y, M, C; none: solved
    double print_stops = 0;
    std::string contrast_filter;
    bool couplers = true, balance = true;
    std::optional<bool> grain, mtf;    // none: no, or as the look says
    std::optional<Halation> halation;  // the same
    std::optional<double> frame_mm;    // longer side of the frame on the film
    std::uint64_t seed = 1;            // the grain's

    double frame() const { return frame_mm.value_or(36); }
};

// "none", "backed", "bare". Errors: kUsage.
Result<Halation> parse_halation(std::string_view text);
// "35mm", "6x6", "4x5in", or the length of the longer side in mm. Errors: kUsage.
Result<double> parse_format(std::string_view text);

// What has a size on the film.
struct Emulsion {
    film::GrainField grain;
    film::LayerTables granularity;  // by amount of dye
};
// Null if nothing of that was asked for. Errors: kUnsupported, if the film's granularity is not known.
Result<std::shared_ptr<const Emulsion>> emulsion_for(const ConvertOptions& options, const Source& source);

// How the film spreads light; not at all if that was not asked for. Errors: kUsage, kUnsupported.
Result<FilmBlur> blur_for(const ConvertOptions& options, const Source& source);

// "auto", or densities times 100 as on the dials of an enlarger, "54,46,0". Errors: kUsage.
Result<std::optional<std::array<double, 3>>> parse_filters(std::string_view text);

// The process that prints `source`; null if it is not on film. Errors: kUsage, if film and paper do not go together, or other
// options do not go with them.
Result<std::shared_ptr<const film::Process>> darkroom_for(const ConvertOptions& options, const Source& source);

// Exposure [lux s] of the grey card that a film picture was exposed for.
double grey_exposure(const Source& source);

}  // namespace latent::convert
