#include "tools/develop/picture/picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/file.h"
#include "base/parallel.h"
#include "base/parse.h"
#include "base/stopwatch.h"
#include "color/rgb_space.h"
#include "tools/develop/channels/aov_columns.h"
#include "tools/develop/engine/subset.h"
#include "tools/develop/forecast/estimate.h"
#include "tools/develop/kernel/splat.h"
#include "tools/develop/lens/lens_columns.h"
#include "tools/develop/lens/recorded_lens.h"
#include "tools/develop/picture/denoised_picture.h"
#include "tools/develop/picture/exr_picture.h"
#include "tools/develop/picture/oidn_picture.h"

namespace latent::develop {

namespace {

Result<PixelRect> crop_of(const std::optional<PixelRect>& asked, const Size& size) {
    const PixelRect all{0, 0, size.width, size.height};
    if (!asked || intersection(*asked, all) == *asked) return asked.value_or(all);
    return usage_error(fmt::format("--crop {},{},{},{}: is not inside the picture of {} x {} pixels", asked->x0, asked->y0,
                                   asked->x1, asked->y1, size.width, size.height));
}

// Channels of an EXR [Fichet21]: S0.<wavelength>nm, with a decimal comma.
std::vector<std::string> spectral_channel_names(const SpectralBins& bins) {
    std::vector<std::string> names;
    for (int i = 0; i < bins.count; ++i) {
        std::string nm = fmt::format("{:.3f}", bins.from_nm + bins.width_nm() * (i + 0.5));
        std::ranges::replace(nm, '.', ',');
        names.push_back("S0." + nm + "nm");
    }
    return names;
}

std::string lens_text(const PictureOptions& options) {
    const std::string chosen = options.lens.text();
    if (!options.focus) return chosen;
    return fmt::format("{}{}focus {:.6g}", chosen, chosen.empty() ? "" : "; ", options.focus->distance);
}

image::ExrTileSpec exr_spec(const PictureOptions& options, const PictureReport& report, const PixelRect& crop,
                            const sampledb::Job& job, const ChosenObserver& chosen, const RowLayout& layout) {
    image::ExrTileSpec spec;
    spec.display_width = static_cast<int>(report.width);
    spec.display_height = static_cast<int>(report.height);
    spec.x0 = static_cast<int>(crop.x0), spec.y0 = static_cast<int>(crop.y0);
    spec.x1 = static_cast<int>(crop.x1), spec.y1 = static_cast<int>(crop.y1);
    spec.zip = options.zip;
    spec.mipmap = options.mipmap;
    spec.strings = {{"latentFilter", report.filter}, {"latentJob", to_hex(report.job)}};
    if (!options.lights.empty()) spec.strings.push_back({"latentLights", fmt::format("{}", fmt::join(options.lights, " "))});
    if (options.dim_fireflies) spec.strings.push_back({"latentFireflies", "dimmed"});
    if (options.denoise > 0) spec.strings.push_back({"latentDenoise", fmt::format("{:g}", options.denoise)});
    if (!options.lens.is_whole()) spec.strings.push_back({"latentLens", lens_text(options)});
    if (options.ratio) spec.strings.push_back({"latentEstimator", "ratio"});
    if (!options.recipe.empty()) spec.strings.push_back({"latentRecipe", options.recipe});
    if (options.spectral_bins.count > 0) {
        spec.channels = layout.names(spectral_channel_names(options.spectral_bins));
        spec.strings.push_back({"spectralLayoutVersion", "1.0"});
        spec.strings.push_back({"emissiveUnits", "W.m^-2.sr^-1.nm^-1"});
        return spec;
    }
    spec.channels = layout.names({"R", "G", "B"});
    spec.strings.push_back({"latentObserver", report.observer});
    if (chosen.primaries) {
        spec.chromaticities = color::chromaticities_of(*chosen.primaries);
        const color::Chromaticity neutral = chosen.observer.neutral();
        spec.adopted_neutral = {{static_cast<float>(neutral.x), static_cast<float>(neutral.y)}};
    }
    if (chosen.film) {
        spec.strings.push_back({"latentFilm", chosen.film->material.name});
        spec.strings.push_back({"latentExposureIndex", fmt::format("{:g}", chosen.film->exposure_index)});
        spec.strings.push_back({"latentPush", fmt::format("{:g}", chosen.film->push)});
        spec.strings.push_back({"latentUnits", "exposure of each layer in lux seconds"});
    }
    if (chosen.observer.is_cie1931()) {
        spec.white_luminance = static_cast<float>(job.light_unit_cd_m2);
        spec.strings.push_back({"colorInteropID", "lin_ciexyzd65_scene"});
    }
    return spec;
}

void advise(const PictureOptions& options, const PictureReport& report, std::vector<std::string>& warnings) {
    const DevelopCounts& counts = report.counts;
    if (counts.camera_records + counts.light_records == 0) {
        const std::string which = options.image == "both" ? "" : options.image + " ";
        warnings.push_back(fmt::format("no {}records reach the picture, so it is black", which));
    }
    if (options.layers.variance && counts.light_records > 0)
        warnings.push_back("the layer variance is that of the camera image; --halves shows the noise of both images");
    if (counts.decode_factor() > 1.1) {
        warnings.push_back(
            fmt::format("pages were decoded {:.2f} times on average, because --memory is too small to decode them once; "
                        "use more memory, or latent-merge --compact",
                        counts.decode_factor()));
    }
    constexpr double kSmallRead = 64 << 10;
    const double reads = static_cast<double>(report.runs) * static_cast<double>(counts.regions);
    if (report.runs > 256 && static_cast<double>(counts.page_bytes) / reads < kSmallRead) {
        warnings.push_back(
            fmt::format("{} small runs need many small reads; latent-merge --compact makes them few and large", report.runs));
    }
}

// There is no picture of no samples: says what the files hold instead, and what was left out of them.
Error nothing_to_develop(sampledb::RunSetOptions options) {
    const std::optional<sampledb::SampleRange> wanted = std::exchange(options.samples, std::nullopt);
    const auto all = sampledb::RunSet::open(options);
    if (!all) return all.error();
    std::string message = "the files hold no samples";
    if (const sampledb::Coverage& held = (*all)->coverage(); !held.empty())
        message = wanted ? fmt::format("--samples {}:{}: the files hold only {}", wanted->first, wanted->end, to_string(held))
                         : "the files have changed while they were read";
    for (const sampledb::LeftOut& item : (*all)->report().left_out)
        message += fmt::format("; left out: {}: {}", item.place, item.reason);
    return {ErrorCode::kOutOfRange, message};
}

// What is seen beside light, as far as the files know it.
void add_surface(const sampledb::Job& job, Layers& layers) {
    for (bool Layers::*layer : {&Layers::albedo, &Layers::normal, &Layers::depth}) {
        Layers alone;
        alone.*layer = true;
        if (AovColumns::find(job, alone)) layers.*layer = true;
    }
}

// About what holds all records at once, with their windows beside them.
std::uint64_t memory_for_all(const sampledb::RunSet& run_set, const Channels& channels) {
    constexpr std::uint64_t kBeside = 96 << 20;
    std::uint64_t records = 0;
    for (const sampledb::SelectedRun& run : run_set.runs()) records += run.header.camera_records + run.header.light_records;
    const std::uint64_t each = 2 * sizeof(std::uint32_t) + static_cast<std::uint64_t>(channels.stride()) * sizeof(float);
    return (records * each + kBeside) / 7 * 8;
}

// All that is known of a picture before it is developed.
struct Preparation {
    PictureReport report;
    Channels channels;
    Settings settings;
    image::ExrTileSpec spec;
    std::uint64_t waiting_for_mipmap = 0;  // bytes
};

// `run_set` is of all runs, which hold `available` samples, or of some. `default_size`: unless the options have one.
Result<Preparation> prepare(const PictureOptions& options, const sampledb::RunSetOptions& selection,
                            const sampledb::RunSet& run_set, std::uint64_t available, Size default_size) {
    const sampledb::Job& job = run_set.job();

    PictureReport report;
    report.output = options.output.string();
    report.job = job.id;
    report.coverage = run_set.coverage();
    if (report.coverage.empty()) return nothing_to_develop(selection);
    report.available = available;
    if (options.samples && !options.is_preview()) report.missing.add(*options.samples);
    report.missing.remove(report.coverage);
    report.files = run_set.files().size();
    report.runs = run_set.runs().size();
    report.run_set = run_set.report();
    const Result<Size> size = options.size.empty() ? default_size : parse_size_on_film(options.size, job);
    if (!size) return size.error();
    report.width = size->width;
    report.height = size->height;
    report.size_chosen = !options.size.empty();
    const Result<PixelRect> crop = crop_of(options.crop, *size);
    if (!crop) return crop.error();
    report.crop = *crop;
    const Result<Filter> filter = Filter::parse(options.filter);
    if (!filter) return filter.error();
    report.filter = filter->name();
    if (filter->warning()) report.warnings.push_back(*filter->warning());

    const Result<ChosenObserver> chosen = choose_observer(options.observer);
    if (!chosen) return chosen.error();
    const color::Observer& observer = chosen->observer;
    if (options.spectral_bins.count == 0) report.observer = observer.name();
    report.camera_fit = chosen->fit;
    report.lights = options.lights;
    report.dims_fireflies = options.dim_fireflies;
    report.filter_factor = chosen->filter_factor;
    const bool spectral = job.kind == sampledb::RecordKind::kSpectral;
    if (!spectral && !observer.is_cie1931())
        return usage_error(fmt::format("--{} {}: needs spectral records; these hold XYZ of cie1931",
                                       chosen->film ? "film" : "observer", observer.name()));
    Result<Channels> channels = options.spectral_bins.count > 0 ? Channels::spectral_bins(job, options.spectral_bins)
                                                                : Channels::xyz(job, spectral ? &observer : nullptr);
    if (!channels) return channels.error();
    Layers stored = options.layers;
    if (!options.for_oidn.empty()) add_surface(job, stored);
    Layers layers = stored;
    layers.samples = options.dim_fireflies;
    if (!(options.denoise >= 0 && options.denoise <= 1))
        return usage_error(fmt::format("--denoise={:g}: choose from 0, as it is, to 1, without noise", options.denoise));
    if (options.denoise > 0) {
        layers.halves = layers.weight = true;
        add_surface(job, layers);
    }
    if (Status s = channels->add_layers(job, layers); !s) return s.error();
    if (Status s = channels->weigh(job, options.lens); !s) return s.error();
    if (channels->lens()) report.lens = {channels->lens()->mean(), channels->lens()->kept()};
    if (options.focus && report.lens) report.lens->focus = options.focus->distance;
    if (options.ratio) {
        if (Status s = channels->use_ratio(); !s) return s.error();
    }
    if (layers.lights) {
        Result<std::vector<std::string>> names = names_of_lights(run_set);
        if (!names) return names.error().at("--layers lights");
        channels->show_lights(job, *std::move(names));
    }
    if (!options.lights.empty()) {
        const Result<std::vector<LightGroup>> groups = light_groups_of(run_set);
        if (!groups) return groups.error().at("--light");
        const Result<std::vector<GroupFactor>> factors = mix_lights(*groups, options.lights, report.warnings);
        if (!factors) return factors.error();
        if (Status s = channels->mix_lights(job, *factors); !s) return s.error();
    }

    std::uint64_t index_bytes = 0, largest_index = 0;
    for (const sampledb::SelectedRun& run : run_set.runs()) {
        const std::uint64_t bytes = run.header.page_count * sizeof(sampledb::PageInfo);
        index_bytes += bytes;
        largest_index = std::max(largest_index, bytes);
        report.bytes_stored += run.header.size();
    }
    const std::uint64_t waiting_for_mipmap = options.mipmap ? options.memory / 32 : 0;
    Settings settings;
    settings.width = size->width;
    settings.height = size->height;
    settings.crop = options.denoise > 0 ? within_reach(*crop, {0, 0, size->width, size->height}) : *crop;
    settings.filter = *filter;
    settings.camera = options.image != "light";
    settings.light = options.image != "camera";
    settings.dim_fireflies = options.dim_fireflies;
    settings.list_memory = run_set.list_memory() + largest_index;
    const std::uint64_t taken =
        run_set.list_memory() + waiting_for_mipmap + std::max(largest_index, std::min(options.memory / 8, index_bytes));
    settings.memory = options.memory - std::min(options.memory, taken);
    settings.stopped = options.stopped;
    settings.temporary_folder = options.output.empty() ? std::filesystem::temp_directory_path() : folder_of(options.output);

    RowLayout layout = channels->layout();
    layout.layers = stored;
    report.file_bytes = static_cast<std::uint64_t>(crop->width() * crop->height()) * static_cast<std::uint64_t>(layout.outputs()) *
                        sizeof(float) * (options.mipmap ? 4 : 3) / 3;
    report.memory_for_all = memory_for_all(run_set, *channels);
    image::ExrTileSpec spec = exr_spec(options, report, settings.crop, job, *chosen, channels->layout());
    return Preparation{std::move(report), *std::move(channels), std::move(settings), std::move(spec), waiting_for_mipmap};
}

// `publish` false: to see how long it takes.
Result<PictureReport> develop_prepared(const PictureOptions& options, const sampledb::RunSet& run_set,
                                       const Result<Preparation>& prepared, bool publish, PictureSink& sink,
                                       const Progress& progress) {
    if (!prepared) return prepared.error();
    PictureReport report = prepared->report;
    if (publish && !options.ignore_space && !options.output.empty()) {
        if (Status s = check_space(options.output, options.replace, report.file_bytes); !s) return s.error();
    }
    std::optional<DenoisedPicture> denoised;
    if (options.denoise > 0)
        denoised.emplace(sink, options.denoise, report.crop, options.layers, prepared->settings.temporary_folder);
    PictureSink& noisy = denoised ? *denoised : sink;
    if (Status s = noisy.begin(prepared->spec, prepared->waiting_for_mipmap); !s) return s.error();
    const Stopwatch stopwatch;
    const Threads threads(options.threads);
    Result<DevelopCounts> counts = DevelopCounts{};
    threads.run([&] { counts = develop(run_set, prepared->channels, prepared->settings, noisy, progress); });
    if (!counts) return counts.error();
    if (publish) {
        if (Status s = sink.finish(); !s) return s.error();
    }
    if (denoised) counts->temporary_bytes += denoised->bytes_on_disk();
    report.counts = *counts;
    report.bytes_read = run_set.bytes_read();
    report.seconds = stopwatch.seconds();
    advise(options, report, report.warnings);
    return report;
}

sampledb::RunSetOptions run_set_options(const PictureOptions& options, sampledb::VerifyLevel verify) {
    sampledb::RunSetOptions selection;
    selection.inputs = options.inputs;
    selection.skip_duplicates = options.skip_duplicates;
    selection.job = options.job;
    selection.samples = options.samples;
    selection.verify = verify;
    selection.memory = options.memory;
    selection.announced_reads = true;
    return selection;
}

// The first `count` of the runs in this order.
Subset first_of(const sampledb::RunSet& all, const std::vector<std::uint32_t>& order, std::size_t count) {
    return Subset(all, {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count)});
}

// A developed picture or a scene among the inputs, which is what people confuse with samples.
Error with_advice(Error error, const std::vector<std::filesystem::path>& inputs) {
    for (const std::filesystem::path& input : inputs) {
        if (error.code != ErrorCode::kForeign || !error.message.starts_with(input.string() + ":")) continue;
        const std::string extension = input.extension().string(), name = input.filename().string();
        if (extension == ".exr") {
            error.message += "; a picture is printed by latent-convert";
        } else if (extension == ".pbrt" || extension == ".gltf" || extension == ".glb" || extension == ".obj") {
            error.message += fmt::format("; render the scene first: latent-render {} -o {}.latent", name, input.stem().string());
        }
    }
    return error;
}

Size size_of_width(double width, double aspect) {
    const auto side = [](double pixels) {
        return static_cast<std::uint32_t>(std::clamp(std::round(pixels), 1.0, double{kMaxSide}));
    };
    return {side(width), side(width / aspect)};
}

// What a lens is said to be becomes what it is to the lens that was rendered.
Result<PictureOptions> seen_by_lens(const PictureOptions& asked, const sampledb::RunSet& all) {
    PictureOptions options = asked;
    Aperture& aperture = options.lens.aperture;
    if (options.lens.exposure_follows && aperture.is_whole() && options.lens.shutter.is_whole())
        return usage_error("--exposure-follows: follows --aperture, --shutter or --frames; give one of them");
    if (aperture.f_number > 0) {
        if (Status s = check_lens_columns(all.job(), "--aperture"); !s) return s.error();
        const Result<RecordedLens> lens = recorded_lens(all, "--aperture");
        if (!lens) return lens.error();
        constexpr double kRounding = 1.001;  // f-numbers are written with few digits
        aperture.radius = lens->f_number() / aperture.f_number;
        if (aperture.radius > kRounding)
            return usage_error(fmt::format("--aperture f:{:g}: the lens was rendered as f/{:.3g}; a wider one must be rendered",
                                           aperture.f_number, lens->f_number()));
        aperture.radius = std::min(aperture.radius, 1.0);
    }
    if (options.focus) {
        if (Status s = check_lens_columns(all.job(), "--focus", options.focus->pixel ? "depth,lens" : "lens"); !s) return s.error();
        const Result<RecordedLens> lens = recorded_lens(all, "--focus");
        if (!lens) return lens.error();
        if (options.focus->pixel) {
            const Result<Size> size = options.size.empty() ? default_size(all) : parse_size_on_film(options.size, all.job());
            if (!size) return size.error();
            const Result<double> distance = distance_at(all, *lens, *options.focus->pixel, size->width, size->height);
            if (!distance) return distance.error();
            options.focus->distance = *distance;
        }
        options.lens.film_shift = lens->film_shift(options.focus->distance);
    }
    return options;
}

// `running`: since the command began.
Result<PictureReport> develop_open(const PictureOptions& asked, const sampledb::RunSetOptions& selection,
                                   const sampledb::RunSet& all, const Stopwatch& running, PictureSink& sink,
                                   const Progress& progress) {
    const Result<PictureOptions> seen = seen_by_lens(asked, all);
    if (!seen) return seen.error();
    const PictureOptions& options = *seen;
    const std::uint64_t available = all.coverage().size();
    if (!options.is_preview())
        return develop_prepared(options, all, prepare(options, selection, all, available, default_size(all)), true, sink, progress);

    const std::vector<std::uint32_t> order = shuffled_runs(all);
    const auto develop_first = [&](std::size_t count, bool publish, const Progress& shown) {
        const Subset some = first_of(all, order, count);
        const auto prepared = prepare(options, selection, some, available, default_size(all, some.coverage().size()));
        return develop_prepared(options, some, prepared, publish, sink, shown);
    };
    Result<std::size_t> count = count_for(all, order, options.fraction);
    if (options.budget_seconds > 0) {
        const Trial trial = [&](double amount) -> Result<Tried> {
            const auto runs = static_cast<std::size_t>(amount);
            const CostMeter meter;
            const Result<PictureReport> tried = develop_first(runs, false, {});
            if (!tried) return tried.error();
            return Tried{static_cast<double>(runs), meter.so_far()};
        };
        count = runs_within(options.budget_seconds - running.seconds(), order.size(), trial);
        if (!count) return count.error();
    }
    return develop_first(*count, true, progress);
}

Result<PictureReport> develop_once(const PictureOptions& asked, sampledb::VerifyLevel verify, const Stopwatch& running,
                                   PictureSink& sink, const Progress& progress) {
    const sampledb::RunSetOptions selection = run_set_options(asked, verify);
    const auto opened = sampledb::RunSet::open(selection);
    if (!opened) return with_advice(opened.error(), selection.inputs);
    return develop_open(asked, selection, **opened, running, sink, progress);
}

// The largest size of the film's shape within `pixels`; `pixels` themselves where only rounding is between them.
Size on_film(const sampledb::Resolution& pixels, const sampledb::Job& job) {
    if (const Result<Size> same = parse_size_on_film(fmt::format("{}x{}", pixels.width, pixels.height), job)) return *same;
    const double aspect = static_cast<double>(job.aspect_width) / job.aspect_height;
    const double width = std::floor(std::min<double>(pixels.width, pixels.height * aspect));
    return size_of_width(width, aspect);
}

}  // namespace

Size default_size(const sampledb::RunSet& all, std::optional<std::uint64_t> preview_samples) {
    const sampledb::Job& job = all.job();
    const double aspect = static_cast<double>(job.aspect_width) / job.aspect_height;
    const auto with_samples = [&](std::uint64_t samples, double per_pixel) {
        return size_of_width(std::floor(std::sqrt(static_cast<double>(samples) / per_pixel * aspect)), aspect);
    };
    const Size whole = all.resolution() ? on_film(*all.resolution(), job) : with_samples(all.coverage().size(), 16);
    if (!preview_samples) return whole;
    const Size largest = with_samples(*preview_samples, 1);
    return largest.width < whole.width ? largest : whole;
}

Result<Size> parse_size_on_film(const std::string& text, const sampledb::Job& job) {
    auto pixels = parse_pair(text, 'x');
    const Result<std::uint64_t> width_alone = parse_count(text);
    if (width_alone) pixels = {*width_alone, 1};
    const auto possible = [](std::uint64_t side) { return side > 0 && side <= kMaxSide; };
    if (!pixels || !possible(pixels->first) || !possible(pixels->second))
        return usage_error(fmt::format("--size {}: give WIDTH or WIDTHxHEIGHT in pixels, at most {} each", text, kMaxSide));
    const double aspect = static_cast<double>(job.aspect_width) / job.aspect_height;
    const auto width = static_cast<std::uint32_t>(pixels->first);
    const double exact = width / aspect;
    const double height = width_alone ? std::max(1.0, std::round(exact)) : static_cast<double>(pixels->second);
    if (height > kMaxSide)
        return usage_error(fmt::format("--size {}: the height would be {:.0f} pixels; the maximum is {}", text, height, kMaxSide));
    if (std::abs(height - exact) > 0.5 && std::abs(width - height * aspect) > 0.5) {
        const bool too_flat = std::round(exact) < 1;  // less than a pixel high
        return usage_error(fmt::format("--size {}: the film's aspect is {}:{}; use {:.0f}x{:.0f}", text, job.aspect_width,
                                       job.aspect_height, too_flat ? std::round(height * aspect) : width,
                                       too_flat ? height : std::round(exact)));
    }
    return Size{width, static_cast<std::uint32_t>(height)};
}

std::vector<PictureOptions> frames_of(const PictureOptions& options) {
    std::vector<PictureOptions> frames(options.frames, options);
    for (std::uint32_t i = 0; i < options.frames && options.frames > 1; ++i) {
        PictureOptions& frame = frames[i];
        frame.frames = 1;
        frame.lens.shutter.frame = i, frame.lens.shutter.frames = options.frames;
        const std::filesystem::path& name = options.output;
        frame.output.replace_filename(fmt::format("{}.{:04}{}", name.stem().string(), i + 1, name.extension().string()));
    }
    return frames;
}

namespace {

// A picture that is never finished: how long its tiles take, which one thread writes at a time.
class TimedPicture final : public PictureSink {
 public:
    explicit TimedPicture(const std::filesystem::path& output) : picture_(output, true) {}
    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override {
        return picture_.begin(spec, waiting_memory);
    }
    Status write(int x, int y, std::span<const float> pixels) override {
        const CostMeter meter;
        Status status = picture_.write(x, y, pixels);
        writing_ += meter.so_far().cpu;
        return status;
    }
    Status finish() override { return {}; }
    double writing() const { return writing_; }  // seconds of CPU time

 private:
    ExrPicture picture_;
    double writing_ = 0;
};

Result<Forecast> forecast_one(const PictureOptions& given, std::uint32_t pictures) {
    const CostMeter preparing;
    if (Status s = set_simd_level(given.simd); !s) return s.error();
    const sampledb::RunSetOptions selection = run_set_options(given, sampledb::VerifyLevel::kHeaders);
    const auto opened = sampledb::RunSet::open(selection);
    if (!opened) return with_advice(opened.error(), selection.inputs);
    const Result<PictureOptions> seen = seen_by_lens(given, **opened);
    if (!seen) return seen.error();
    const PictureOptions& asked = *seen;
    const sampledb::RunSet& all = **opened;
    if (all.coverage().empty()) return nothing_to_develop(selection);
    const std::vector<std::uint32_t> order = shuffled_runs(all);
    const std::size_t runs = count_for(all, order, asked.fraction);
    const Subset wanted = first_of(all, order, runs);
    const std::optional<std::uint64_t> preview_samples =
        asked.is_preview() ? std::optional(wanted.coverage().size()) : std::nullopt;
    const Result<Preparation> whole = prepare(asked, selection, wanted, all.coverage().size(), default_size(all, preview_samples));
    if (!whole) return whole.error();

    Forecast forecast;
    forecast.output = asked.output.string();
    forecast.pictures = pictures;
    forecast.width = whole->report.width, forecast.height = whole->report.height;
    forecast.crop = whole->report.crop;
    forecast.file_bytes = pictures * whole->report.file_bytes;
    forecast.memory = asked.memory;
    forecast.memory_for_all = whole->report.memory_for_all;
    forecast.free_bytes = free_space(asked.output, asked.replace);
    if (!forecast.fits() && !asked.ignore_space) return forecast;
    Result<PlannedWork> work = PlannedWork{};
    Threads(asked.threads).run([&] { work = planned_work(wanted, whole->channels, whole->settings); });
    if (!work) return work.error();
    forecast.memory_for_all += static_cast<std::uint64_t>(work->segment_bytes);
    const Cost prepared = preparing.so_far();

    const PictureTrial trial = [&](const TrialPicture& picture) -> Result<TrialOutcome> {
        PictureOptions options = asked;
        options.size.clear();  // that of the trial need not have the film's shape to the pixel
        options.crop = picture.crop;
        options.threads = 1;  // several would wait for each other, more often than in long work
        TimedPicture sink(asked.output);
        const Subset some = first_of(all, order, picture.runs);
        const CostMeter meter;
        const Result<PictureReport> tried = develop_prepared(
            options, some, prepare(options, selection, some, all.coverage().size(), {picture.width, picture.height}), false, sink,
            {});
        if (!tried) return tried.error();
        Cost cost = meter.so_far();
        cost.serial = sink.writing();
        return TrialOutcome{cost, tried->counts.page_bytes_decoded, tried->counts.segments, tried->counts.temporary_bytes};
    };
    const TrialPicture picture{whole->report.width, whole->report.height, whole->report.crop, runs, whole->settings.filter.reach()};
    const Result<TrialOutcome> expected = extrapolate(picture, work->bytes, work->segments, trial);
    if (!expected) return expected.error();
    const Cost cost = prepared + expected->cost;
    const int threads = Threads::count_of(asked.threads);
    const double developing = seconds_with(cost, threads, processor_share(threads));
    forecast.seconds = pictures * developing + seconds_to_reach_disk(forecast.file_bytes, folder_of(asked.output));
    forecast.cpu_seconds = pictures * cost.cpu;
    forecast.temporary_bytes = expected->temporary_bytes;
    return forecast;
}

}  // namespace

Result<Forecast> forecast_picture(const PictureOptions& options) {
    return forecast_one(frames_of(options).front(), options.frames);  // one frame takes as long as another
}

Result<PictureReport> develop_picture(const PictureOptions& options, PictureSink& sink, const Progress& progress) {
    if (Status s = set_simd_level(options.simd); !s) return s.error();
    const Stopwatch running;
    Result<PictureReport> report = develop_once(options, sampledb::VerifyLevel::kHeaders, running, sink, progress);
    const bool damaged = !report && sampledb::is_unreadable(report.error());
    return damaged ? develop_once(options, sampledb::VerifyLevel::kOrdered, running, sink, progress) : report;
}

Result<PictureReport> develop_picture(const PictureOptions& options, const sampledb::RunSet& open, PictureSink& sink,
                                      const Progress& progress) {
    if (Status s = set_simd_level(options.simd); !s) return s.error();
    return develop_open(options, run_set_options(options, sampledb::VerifyLevel::kHeaders), open, {}, sink, progress);
}

Result<PictureReport> develop_picture(const PictureOptions& options, const Progress& progress) {
    if (!options.for_oidn.empty()) {
        OidnPicture pictures(options.for_oidn, options.replace);
        return develop_picture(options, pictures, progress);
    }
    ExrPicture picture(options.output, options.replace);
    return develop_picture(options, picture, progress);
}

}  // namespace latent::develop
