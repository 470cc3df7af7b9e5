#include "tools/convert/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "base/parallel.h"
#include "base/parse.h"
#include "base/recipe.h"
#include "base/stopwatch.h"
#include "base/temporary_path.h"
#include "color/adaptation.h"
#include "tools/convert/bands.h"
#include "tools/convert/darkroom.h"
#include "tools/convert/display.h"
#include "tools/convert/icc.h"
#include "tools/convert/looks.h"
#include "tools/convert/luminances.h"
#include "tools/convert/print_pass.h"
#include "tools/convert/sink.h"
#include "tools/convert/source.h"
#include "tools/convert/spread_light.h"

namespace latent::convert {

namespace {

// "print.png" and -1: "print-1.png".
std::filesystem::path with_stops(const std::filesystem::path& path, double stops) {
    return path.parent_path() / fmt::format("{}{:+g}{}", path.stem().string(), stops, path.extension().string());
}

struct ToneChoice {
    color::Tone tone;
    color::ToneCurve curve;
};
Result<ToneChoice> tone_of(const ConvertOptions& options) {
    if (options.paper_decides_tone()) return ToneChoice{color::Tone::kCurve, *color::ToneCurve::make("linear", 1, 0)};
    if (options.tone == "none") {
        if (options.contrast == 1 && options.black == 0) return ToneChoice{color::Tone::kNone, {}};
        return usage_error("--contrast and --black need a tone curve, but --tone is none");
    }
    const Result<color::ToneCurve> curve = color::ToneCurve::make(options.tone, options.contrast, options.black);
    if (!curve) return usage_error(curve.error().message).at("--tone");
    return ToneChoice{curve->is_film() ? color::Tone::kFilm : color::Tone::kCurve, *curve};
}

Status check_outputs(const ConvertOptions& options, std::vector<std::string>& notes) {
    if (Status s = check_types(options, notes); !s) return s;
    const std::vector<std::filesystem::path>& outputs = options.outputs;
    std::set<std::filesystem::path> places;
    for (const std::filesystem::path& path : outputs) {
        std::error_code ignored;
        if (!places.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored)).second)
            return usage_error(fmt::format("--output {}: given twice", path.string()));
    }
    const auto is_deep_zoom = [](const std::filesystem::path& path) { return path.extension() == ".dzi"; };
    if (!options.compare.empty() && std::ranges::none_of(outputs, is_deep_zoom))
        return usage_error("--compare: needs an output that ends in .dzi");
    return {};
}

constexpr double kGreyCard = 0.18;

// What these luminances suggest; none without light. Of a film, they are exposures of the layer that sees green.
std::optional<double> suggested_sigma(const ConvertOptions& options, const ToneChoice& tone, const Source& source, bool on_film,
                                      const color::LuminanceHistogram& luminances) {
    const double key = options.key.value_or(kGreyCard);
    const Result<double> sigma = color::auto_sigma(luminances, on_film ? key / kGreyCard * grey_exposure(source)
                                                               : tone.tone == color::Tone::kNone ? key
                                                                                                 : tone.curve.exposure_of(key));
    return sigma ? std::optional(*sigma) : std::nullopt;
}

// The same, of the whole picture: a crop of a print is a part of that print.
Result<std::optional<double>> choose_sigma(const ConvertOptions& options, const ToneChoice& tone, const Source& source,
                                           bool on_film, const Progress& progress) {
    const image::ExrImage& image = source.reader.image();
    const Result<BandPlan> plan = plan_bands(image, image.data_window, {}, options.memory, options.threads);
    if (!plan) return plan.error().at(options.input.string());
    const Result<color::LuminanceHistogram> seen = measure(source, *plan, source.xyz_from_file.m[1], progress);
    if (!seen) return seen.error();
    return suggested_sigma(options, tone, source, on_film, *seen);
}

// The sensitivity for a print from film, which has its exposure: a grey card is shown as bright as it is.
double print_sigma_of(const color::PrintSettings& settings) {
    return settings.tone == color::Tone::kNone ? 1 : settings.curve.exposure_of(kGreyCard) / kGreyCard;
}

// What the print says of itself: what was decided before, and for it alone.
Result<std::string> recipe_of_print(const std::string& of_picture, const ConvertOptions& options, double stops) {
    if (options.recipe.empty()) return "";
    Recipe recipe = *parse_recipe(options.recipe);
    if (const Result<Recipe> before = parse_recipe(of_picture); before && before->contains("develop"))
        recipe["develop"] = (*before)["develop"];
    Recipe& print = recipe["convert"];
    const auto whole = static_cast<int>(stops);
    print["stops"] = whole == stops ? Recipe(whole) : Recipe(stops);
    if (stops == 0) print.erase("stops");
    return recipe_text(recipe);
}

Result<std::vector<Exposure>> exposures_of(const ConvertOptions& options, const Display& display, color::PrintSettings settings,
                                           const PrintedPicture& picture, const std::shared_ptr<const film::Process>& film) {
    std::vector<Exposure> exposures;
    for (const double stops : options.stops) {
        const double sigma = color::pushed_sigma(picture.sigma, stops);
        settings.sigma = film ? print_sigma_of(settings) : sigma;
        settings.range = printable_range(display.space.transfer, settings.tone, settings.curve, settings.sigma);
        const Result<color::Print> print = color::Print::create(display.print_space(), settings);
        if (!print) return print.error();
        Exposure exposure{.stops = stops, .sigma = sigma, .print = *print, .film = film, .paths = {}, .sinks = {}};
        PrintedPicture exposed = picture;
        exposed.sigma = sigma;
        const Result<std::string> recipe = recipe_of_print(picture.recipe, options, stops);
        if (!recipe) return recipe.error();
        exposed.recipe = *recipe;
        for (const std::filesystem::path& path : options.outputs) {
            exposure.paths.push_back(options.stops.size() == 1 ? path : with_stops(path, stops));
            Result<std::unique_ptr<Sink>> sink = open_sink(exposure.paths.back(), exposed, display, options);
            if (!sink) return sink.error();
            exposure.sinks.push_back(std::move(*sink));
        }
        if (options.codes && exposures.empty()) {
            Result<std::unique_ptr<Sink>> sink = code_sink(*options.codes, exposed, display, options);
            if (!sink) return sink.error();
            exposure.sinks.push_back(std::move(*sink));  // after those of `paths`
        }
        exposures.push_back(std::move(exposure));
    }
    return exposures;
}

// All outputs get their names, or none.
Status publish(const std::vector<Exposure>& exposures, std::vector<ExposureReport>& reports) {
    const auto held = hold_signals();
    std::string done;
    for (std::size_t e = 0; e < exposures.size(); ++e) {
        reports[e].stops = exposures[e].stops;
        reports[e].sigma = exposures[e].sigma;
        for (std::size_t i = 0; i < exposures[e].paths.size(); ++i) {
            if (Status s = exposures[e].sinks[i]->publish(); !s)
                return Error{s.error().code, s.error().message + (done.empty() ? "" : "; complete and in place: " + done)};
            reports[e].outputs.push_back(exposures[e].paths[i].string());
            done += (done.empty() ? "" : ", ") + reports[e].outputs.back();
        }
    }
    return {};
}

Result<int> dpi_of(const ConvertOptions& options, int width) {
    if (options.paper_width_mm == 0) return options.dpi;
    constexpr double kMillimetresPerInch = 25.4, kMax = 65535;
    const double dpi = std::round(width * kMillimetresPerInch / options.paper_width_mm);
    if (dpi >= 1 && dpi <= kMax) return static_cast<int>(dpi);
    return usage_error(fmt::format("--paper-width: {} pixels on {} mm are {:.0f} per inch; 1 to {:.0f} are possible", width,
                                   options.paper_width_mm, dpi, kMax));
}

constexpr int kCoarseDpi = 100;  // pixels of such a print can be seen at reading distance

std::string coarse_print(int width, double paper_width_mm, int dpi) {
    constexpr double kFineDpi = 150;
    return fmt::format(
        "--paper-width {}: {} pixels make only {} per inch, which looks coarse from nearby; a picture {:.0f} pixels "
        "wide has {:.0f} (latent-develop --size)",
        paper_width_mm, width, dpi, std::ceil(paper_width_mm / 25.4 * kFineDpi / 100) * 100, kFineDpi);
}

// Where the light of a pixel goes. A film sees what the lens has spread.
Result<Spread> spread_for(const ConvertOptions& options, const Source& source) {
    const Result<FilmBlur> blur = blur_for(options, source);
    if (!blur) return blur.error();
    const double frame_mm = options.darkroom.frame(), um = pixel_um(source, frame_mm);
    constexpr int kMax = image::Convolver::kMaxRadius;
    Spread spread;
    if (blur->half) spread.near = sharpness_kernel(*blur->half, um, kMax / 2);
    if (options.glare) {
        const int left = kMax - (spread.near ? spread.near->radius() : 0);
        Result<image::Kernel> lens = glare_kernel(*options.glare, source, frame_mm, left);
        if (!lens) return lens.error().at("--glare");
        spread.near = spread.near ? image::in_turn(*lens, *spread.near) : *std::move(lens);
    }
    if (blur->returns_light()) {
        spread.cell = returned_cell(um);
        spread.far = returned_kernel(blur->returned, um * spread.cell, kMax);
    }
    return spread;
}

Result<ConvertReport> convert_in_arena(ConvertOptions options, const Progress& progress) {
    ConvertReport report;
    if (Status s = check_outputs(options, report.notes); !s) return s.error();
    Result<Source> source = open_source(options);
    if (!source) return source.error();
    const std::string& of_picture = source->reader.image().recipe;
    if (const Result<Recipe> recipe = parse_recipe(of_picture); !of_picture.empty() && !recipe)
        report.warnings.push_back(fmt::format("{}: its recipe is left out: {}", options.input.string(), recipe.error().message));
    const Result<int> dpi = dpi_of(options, source->area.width());
    if (!dpi) return dpi.error();
    options.dpi = *dpi;
    if (options.paper_width_mm > 0) {
        report.dpi = *dpi;
        if (*dpi < kCoarseDpi) report.warnings.push_back(coarse_print(source->area.width(), options.paper_width_mm, *dpi));
    }
    Result<Display> display = display_from(options.profile, options.luminance_row, options.rendering);
    if (!display) return display.error();
    if (display->grey) options.grey = true;
    if (options.grey && !display->grey) {
        if (display->has_tables() || !display->space.check_luminance_row())
            return usage_error("--gray: needs a profile with primaries, such as srgb, or a profile of grey");
        display->icc = grey_icc_of(display->space);
        display->cicp.reset();
    }
    if (!options.proof.empty()) {
        if (Status s = add_proof(options.proof, options.rendering, *display); !s) return s.error();
    }
    if (!options.darkroom.look.empty()) {
        const auto& exposed = source->reader.image().film;
        const std::string film = !exposed ? "" : options.darkroom.film.empty() ? exposed->name : options.darkroom.film;
        if (Status s = add_look(options.darkroom.look, options.input.string(), film, options.darkroom, report.notes); !s)
            return s.error().at("--look");
    }
    const Result<std::shared_ptr<const film::Process>> film = darkroom_for(options, *source);
    if (!film) return film.error();
    const Result<std::shared_ptr<const Emulsion>> emulsion = emulsion_for(options, *source);
    if (!emulsion) return emulsion.error();
    Result<Spread> spread = spread_for(options, *source);
    if (!spread) return spread.error();
    const Result<ToneChoice> tone = tone_of(options);
    if (options.paper_decides_tone()) options.tone = "paper";
    if (!tone) return tone.error();
    const Result<color::Gamut> gamut = color::gamut_by_name(options.gamut);
    if (!gamut) return gamut.error();
    if (tone->tone == color::Tone::kNone) options.gamut = "none";  // nothing is mapped, whatever was chosen
    const Result<color::Cones> cones = color::cones_by_name(options.adapt);
    if (!cones) return cones.error();
    const Result<color::Chromaticity> white = *film           ? (*film)->white()
                                              : options.white ? chromaticity_of(*options.white, *source)
                                                              : source->white;
    if (!white) return white.error();
    const Result<color::Matrix3> adaptation = color::adaptation_matrix(*white, display->print_white(), *cones);
    if (!adaptation && options.white) return usage_error(adaptation.error().message).at("--white");
    if (!adaptation) return adaptation.error().at(options.input.string());
    report.chose_exposure = options.chooses_exposure();
    if (report.chose_exposure) {
        const Result<std::optional<double>> sigma = choose_sigma(options, *tone, *source, *film != nullptr, progress);
        if (!sigma) return sigma.error();
        report.auto_sigma = *sigma;
        options.sensitivity = *sigma;
    }
    if (options.exposure) {
        if (!source->cd_m2)
            report.notes.push_back(
                fmt::format("--exposure: {} does not say how bright Y = 1 is; it is taken as 1 cd/m^2", options.input.string()));
        options.sensitivity = options.exposure->sensitivity(source->cd_m2.value_or(1));
    }
    const color::PrintSettings settings{options.sensitivity.value_or(1), tone->tone, *gamut, *adaptation * source->xyz_from_file,
                                        tone->curve};
    const image::ExrImage& image = source->reader.image();
    const Result<std::vector<Exposure>> exposures =
        exposures_of(options, *display, settings,
                     {source->area, image.display_window, settings.sigma, *white, source->observer,
                      *film ? (*film)->description() : "", image.recipe},
                     *film);
    if (!exposures) return exposures.error();
    PassSettings pass{source->xyz_from_file.m[1],
                      display->print_space(),
                      display->proof,
                      display->space,
                      display->gamut,
                      options.show_clipped,
                      options.gamut_report,
                      *emulsion,
                      image.display_window.x0,
                      image.display_window.y0,
                      Dodging(options.dodges, image.display_window)};
    MemoryNeed need;
    for (const Exposure& exposure : *exposures) {
        for (const auto& sink : exposure.sinks) {
            need.bytes_per_row += sink->bytes_per_row();
            need.bytes_held += sink->bytes_held();
        }
    }
    if (*emulsion) need.beside_block = [&pass](int width, int height) { return emulsion_bytes(pass, width, height); };
    image::ExrImage printed_from = image;
    if (*spread) {  // rows of a file without a name are printed
        need.bytes_held += spread_bytes(*spread, image, options.threads);
        printed_from.block_width = image.data_window.width(), printed_from.block_height = 1;
    }
    need.second_block = needs_second_block(*exposures, pass);
    const Result<BandPlan> plan = plan_bands(printed_from, source->area, need, options.memory, options.threads);
    if (!plan) return plan.error().at(options.input.string());
    if (*spread) {
        const std::filesystem::path folder =
            options.outputs.empty() ? std::filesystem::temp_directory_path() : folder_of(options.outputs.front());
        Result<std::unique_ptr<Rows>> rows = light_rows(*source, *std::move(spread), *plan, folder, options.threads);
        if (!rows) return rows.error();
        pass.light = *std::move(rows);
    }
    Result<PassReport> printed = print_all(*source, *plan, *exposures, pass, progress);
    if (!printed) return printed.error();
    for (const Exposure& exposure : *exposures) {
        for (const auto& sink : exposure.sinks) {
            if (Status s = sink->finish(); !s) return s.error();
        }
    }
    if (Status s = publish(*exposures, printed->exposures); !s) return s.error();
    static_cast<ExposureReport&>(report) = printed->exposures.front();
    report.others.assign(printed->exposures.begin() + 1, printed->exposures.end());
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
        report.luminance[i] = printed->luminance.percentile(kPercentiles[i] / 100.0);
    if (!report.chose_exposure && source->area == image.data_window)
        report.auto_sigma = suggested_sigma(options, *tone, *source, *film != nullptr, printed->luminance);
    report.width = source->area.width();
    report.height = source->area.height();
    report.profile = display->space.name;
    report.gamut = options.gamut;
    report.tone = options.tone;
    report.contrast = options.contrast;
    report.black_point = options.black;
    report.gamut_report = options.gamut_report;
    report.white = *white;
    report.adapt = options.adapt;
    report.shown = shown_by(options);
    report.proof = display->proof_name;
    if (display->gamut) report.rendering = options.rendering;
    report.observer = source->observer;
    report.dodged = options.dodges.size();
    if (options.vignette) report.vignette = options.vignette->text;
    if (options.glare) report.glare = options.glare->text;
    if (*film) report.film = (*film)->description();
    report.warnings.insert(report.warnings.end(), source->warnings.begin(), source->warnings.end());
    if (report.chose_exposure && !report.auto_sigma)
        report.warnings.push_back(fmt::format("{}: has no light, so the print is black", options.input.string()));
    return report;
}

}  // namespace

std::string shown_by(const ConvertOptions& options) {
    if (options.proof.empty()) return options.show_clipped ? "clipped" : "";
    return options.show_clipped ? "a proof, clipped" : "a proof";
}

Result<std::vector<double>> parse_stops(std::string_view text) {
    constexpr double kMax = 100;
    constexpr std::size_t kMaxPrints = 16;
    const auto numbers = parse_numbers(text);
    const auto refuse = [&](const char* why) { return usage_error(fmt::format("'{}': {} (try 1, or -1,0,1)", text, why)); };
    if (!numbers) return refuse("not numbers");
    if (std::ranges::any_of(*numbers, [](double v) { return !(std::abs(v) <= kMax); })) return refuse("stops must be -100 to 100");
    if (numbers->size() > kMaxPrints) return refuse("at most 16 prints can be made at once");
    if (std::set<double>(numbers->begin(), numbers->end()).size() < numbers->size()) return refuse("given twice");
    return *numbers;
}

Status check(const ConvertOptions& options) {
    std::vector<std::string> notes;
    if (Status s = check_outputs(options, notes); !s) return s;
    if (const auto display = display_from(options.profile, options.luminance_row, options.rendering); !display)
        return display.error();
    if (const auto tone = tone_of(options); !tone) return tone.error();
    for (const double stops : options.stops) {
        for (const std::filesystem::path& path : options.outputs) {
            const auto file = OutputFile::create(options.stops.size() == 1 ? path : with_stops(path, stops), options.replace);
            if (!file) return file.error();
        }
    }
    return {};
}

Result<ConvertReport> convert(const ConvertOptions& options, const Progress& progress) {
    const Stopwatch stopwatch;
    const Threads threads(options.threads);
    ConvertOptions resolved = options;
    resolved.threads = threads.count();
    Result<ConvertReport> report = Error{ErrorCode::kIo, "nothing was done"};
    threads.run([&] { report = convert_in_arena(resolved, progress); });
    if (report) report->seconds = stopwatch.seconds();
    return report;
}

}  // namespace latent::convert
