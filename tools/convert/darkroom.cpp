#include "tools/convert/darkroom.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parse.h"
#include "color/power_of_ten.h"
#include "tools/convert/options.h"
#include "tools/convert/source.h"

namespace latent::convert {
namespace {

// Options that only a picture not on film has; "": none was given.
std::string_view plain_option(const ConvertOptions& options) {
    if (options.exposure) return "--exposure";
    if (options.white) return "--white";
    if (options.paper_decides_tone() && options.tone != "film") return "--tone";
    if (options.paper_decides_tone() && options.contrast != 1) return "--contrast";
    if (options.paper_decides_tone() && options.black != 0) return "--black";
    return "";
}

Status check_plain(const ConvertOptions& options) {
    const DarkroomOptions& d = options.darkroom;
    const char* given = !d.film.empty()                                           ? "--film"
                        : d.filters                                               ? "--enlarger"
                        : d.print_stops != 0                                      ? "--print-exposure"
                        : !d.contrast_filter.empty()                              ? "--contrast-filter"
                        : !d.couplers                                             ? "--no-couplers"
                        : !d.balance                                              ? "--no-balance"
                        : d.grain.value_or(false)                                 ? "--grain"
                        : d.seed != DarkroomOptions{}.seed                        ? "--grain-seed"
                        : d.mtf.value_or(false)                                   ? "--mtf"
                        : d.halation.value_or(Halation::kNone) != Halation::kNone ? "--halation"
                                                                                  : nullptr;
    if (given != nullptr) return usage_error(fmt::format("{}: needs --paper; --list-papers shows all", given));
    return {};
}

// The picture holds exposures of a film.
Result<film::Material> exposed_film(const DarkroomOptions& asked, const Source& source) {
    const std::string& exposed = source.reader.image().film->name;
    Result<film::Material> film = film::find_material(asked.film.empty() ? exposed : asked.film, true);
    if (film && film->name != exposed)
        return usage_error(fmt::format(
            "the picture holds exposures of {}, not of {}; to change the film, develop the samples again", exposed, film->name));
    return film;
}

}  // namespace

Result<std::optional<std::array<double, 3>>> parse_filters(std::string_view text) {
    using Filters = std::optional<std::array<double, 3>>;
    if (text == "auto") return Filters{};
    const auto numbers = parse_numbers(text);
    constexpr double kMax = 500;
    if (numbers && numbers->size() == 3 && std::ranges::all_of(*numbers, [](double v) { return v >= 0 && v <= kMax; }))
        return Filters{{(*numbers)[0] / 100, (*numbers)[1] / 100, (*numbers)[2] / 100}};
    return is_not(text, "the filters of an enlarger (try auto, or yellow, magenta and cyan as in 54,46,0)");
}

Result<Halation> parse_halation(std::string_view text) {
    if (text == "none") return Halation::kNone;
    if (text == "backed") return Halation::kBacked;
    if (text == "bare") return Halation::kBare;
    return is_not(text, "a halation (none, backed, bare)");
}

Result<double> parse_format(std::string_view text) {
    struct Format {
        const char* name;
        double longer_mm;
    };
    for (const Format& format : {Format{"super8", 5.8},
                                 {"16mm", 10.3},
                                 {"super35", 24.9},
                                 {"35mm", 36},
                                 {"6x4.5", 56},
                                 {"6x6", 56},
                                 {"6x7", 70},
                                 {"6x9", 84},
                                 {"4x5in", 120},
                                 {"8x10in", 245}}) {
        if (text == format.name) return format.longer_mm;
    }
    const Result<double> mm = parse_number(text);
    if (mm && *mm >= 1 && *mm <= 1000) return mm;
    return is_not(text, "a format (try 35mm, 6x6, 6x7, 4x5in, super8, 16mm, or the longer side of the frame, 1 to 1000 mm)");
}

Result<std::shared_ptr<const Emulsion>> emulsion_for(const ConvertOptions& options, const Source& source) {
    const DarkroomOptions& asked = options.darkroom;
    if (!asked.grain.value_or(false)) {
        if (!asked.paper.empty() && asked.seed != DarkroomOptions{}.seed) return usage_error("--grain-seed: needs --grain");
        return std::shared_ptr<const Emulsion>{};
    }
    const Result<film::Material> film = exposed_film(asked, source);
    if (!film) return film.error();
    const auto granularity = film::granularity(*film, source.reader.image().film->push);
    if (!granularity) return granularity.error().at("--grain");
    return std::make_shared<const Emulsion>(Emulsion{
        film::GrainField(asked.seed, pixel_um(source, asked.frame()), film->colour ? 3 : 1), film::layer_by_layer(*granularity)});
}

Result<FilmBlur> blur_for(const ConvertOptions& options, const Source& source) {
    const DarkroomOptions& asked = options.darkroom;
    const Halation halation = asked.halation.value_or(Halation::kNone);
    const bool mtf = asked.mtf.value_or(false);
    if (!mtf && halation == Halation::kNone) return FilmBlur{};
    const Result<film::Material> film = exposed_film(asked, source);
    if (!film) return film.error();
    FilmBlur blur;
    if (halation != Halation::kNone) blur.returned = film::returned_share(*film, halation == Halation::kBare);
    if (mtf) {
        const Result<film::Triple> half = film::half_contrast(*film);
        if (!half) return half.error().at("--mtf");
        blur.half = *half;
    }
    return blur;
}

double grey_exposure(const Source& source) { return 10 / source.reader.image().film->exposure_index; }

Result<std::shared_ptr<const film::Process>> darkroom_for(const ConvertOptions& options, const Source& source) {
    const std::string input = options.input.string();
    const auto& exposed = source.reader.image().film;
    const DarkroomOptions& asked = options.darkroom;
    if (asked.paper.empty()) {
        if (!exposed) {
            if (Status s = check_plain(options); !s) return s.error();
            return std::shared_ptr<const film::Process>{};
        }
        const Result<film::Material> film = film::find_material(exposed->name, true);
        const char* paper = !film || !film->colour ? "polymax" : film->positive() ? "light-table" : "endura";
        return usage_error(
            fmt::format("{}: holds the exposures of a film, {}, and needs a paper: add --paper {}; --list-papers shows all", input,
                        exposed->name, paper));
    }
    if (!exposed)
        return usage_error(fmt::format(
            "--paper: {} holds no exposures of a film{}; develop its samples again: latent-develop FILE.latent --film portra-400 "
            "-o exposures.exr",
            input, source.reader.image().emitted_nm.empty() ? ", and spectra cannot be recovered from its colours" : ""));
    if (const std::string_view given = plain_option(options); !given.empty())
        return usage_error(
            fmt::format("{}: does not go with --paper, where the film and the paper decide; use --stops, --print-exposure "
                        "or --enlarger",
                        given));
    const Result<film::Material> film = exposed_film(asked, source);
    if (!film && asked.film.empty() && film.error().code == ErrorCode::kUsage)
        return Error{film.error().code, film.error().message + "; if it is your own film, add --film FOLDER/NAME"}.at(input);
    if (!film) return film.error().at("--film");
    const double grey = color::log10_of(grey_exposure(source));
    Result<film::Process> process = film::Process::make({.film = *film,
                                                         .push = exposed->push,
                                                         .grey = {grey, grey, grey},
                                                         .paper = asked.paper,
                                                         .couplers = asked.couplers,
                                                         .trim = asked.balance,
                                                         .pack = asked.filters,
                                                         .print_stops = asked.print_stops,
                                                         .contrast_filter = asked.contrast_filter});
    if (!process) return process.error().message.starts_with("--") ? process.error() : process.error().at("--paper");
    return std::make_shared<const film::Process>(*std::move(process));
}

}  // namespace latent::convert
