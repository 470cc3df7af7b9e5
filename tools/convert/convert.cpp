#include "tools/convert/convert.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <memory>
#include <set>

#include "base/first_error.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/temporary_path.h"
#include "color/adaptation.h"
#include "color/auto_exposure.h"
#include "tools/convert/bands.h"
#include "tools/convert/display.h"
#include "tools/convert/luminances.h"
#include "tools/convert/sink.h"
#include "tools/convert/source.h"

namespace latent::convert {

using image::Rect;

namespace {

// After each band.
void tell(const Progress& progress, std::size_t done, std::size_t all, const char* what) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(all), what);
}

// A block of the file's pixels, in the planes of one thread.
struct Block {
    Rect area;
    std::array<float*, 3> planes;

    std::span<float> row(std::size_t c, int y) const {
        const std::size_t width = static_cast<std::size_t>(area.width());
        return {planes[c] + static_cast<std::size_t>(y - area.y0) * width, width};
    }
};

// What luminance is, and which of it can be printed.
struct Metering {
    std::array<double, 3> y_row;
    color::PrintableRange range;
};

// What one thread works in.
struct Workbench {
    image::ExrReader::Scratch scratch;
    std::vector<float> planes, luminances;
    color::PrintReport report;
    Luminances seen;

    void see(const Metering& metering, const Block& block, int y) {
        luminances.resize(static_cast<std::size_t>(block.area.width()));
        seen.counts +=
            color::luminance_row(metering.y_row, metering.range, block.row(0, y), block.row(1, y), block.row(2, y), luminances);
        seen.histogram.add(luminances);
    }
};
using Workbenches = tbb::enumerable_thread_specific<Workbench>;

// Reads the blocks of a band side by side and hands each to `use`.
template <class Use>
void for_each_block(const Source& source, const std::vector<Rect>& blocks, Workbenches& benches, FirstError& error,
                    const Use& use) {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        if (error) return;
        Workbench& bench = benches.local();
        const Rect& area = blocks[i];
        bench.planes.resize(3 * area.pixels());
        float* first = bench.planes.data();
        const Block block{area, {first, first + area.pixels(), first + 2 * area.pixels()}};
        if (Status s = source.reader.read(area, block.planes, static_cast<std::size_t>(area.width()), bench.scratch); !s)
            return error.set(s.error());
        use(block, bench);
    });
}

// sigma for the picture, from the luminances under the display's white.
Result<double> find_sigma(const Source& source, const BandPlan& plan, const color::Matrix3& adapted_xyz, const Progress& progress) {
    Workbenches benches;
    FirstError error;
    for (std::size_t i = 0; i < plan.band_ends.size() && !error; ++i) {
        for_each_block(source, plan.blocks(plan.band(i)), benches, error, [&](const Block& block, Workbench& bench) {
            for (int y = block.area.y0; y < block.area.y1; ++y) bench.see({adapted_xyz.m[1], {}}, block, y);
        });
        tell(progress, i + 1, plan.band_ends.size(), "measuring the light");
    }
    if (error) return error.status().error();
    color::LuminanceHistogram all;
    for (const Workbench& bench : benches) all += bench.seen.histogram;
    return color::auto_sigma(all);
}

// Bands go through printing and encoding one after another; where memory allows, one is printed while the one before is encoded.
Status print_all(const Source& source, const BandPlan& plan, const color::Print& print, const Metering& metering,
                 const std::vector<std::unique_ptr<Sink>>& sinks, const Progress& progress, ConvertReport& report) {
    Workbenches benches;
    FirstError error;
    std::size_t next = 0, done = 0;
    using Bands = std::vector<Band>;
    const auto print_band = [&](tbb::flow_control& flow) -> std::shared_ptr<Bands> {
        if (next == plan.band_ends.size() || error) {
            flow.stop();
            return nullptr;
        }
        const Rect area = plan.band(next++);
        auto bands = std::make_shared<Bands>();
        for (const auto& sink : sinks) bands->push_back(sink->new_band(area));
        for_each_block(source, plan.blocks(area), benches, error, [&](const Block& block, Workbench& bench) {
            for (int y = block.area.y0; y < block.area.y1; ++y) {
                bench.see(metering, block, y);
                print.row(block.row(0, y), block.row(1, y), block.row(2, y), block.row(0, y), block.row(1, y), block.row(2, y),
                          bench.report);
            }
            const PrintedBlock printed{
                block.area, {block.planes[0], block.planes[1], block.planes[2]}, static_cast<std::size_t>(block.area.width())};
            for (std::size_t i = 0; i < sinks.size(); ++i) sinks[i]->take((*bands)[i], printed);
        });
        return bands;
    };
    const auto encode_band = [&](const std::shared_ptr<Bands>& bands) {
        for (std::size_t i = 0; i < sinks.size() && !error; ++i) error.keep(sinks[i]->write((*bands)[i]));
        tell(progress, ++done, plan.band_ends.size(), "");
    };
    tbb::parallel_pipeline(plan.overlapped ? 2 : 1,
                           tbb::make_filter<void, std::shared_ptr<Bands>>(tbb::filter_mode::serial_in_order, print_band) &
                               tbb::make_filter<std::shared_ptr<Bands>, void>(tbb::filter_mode::serial_in_order, encode_band));
    Luminances seen;
    for (const Workbench& bench : benches) {
        report.print += bench.report;
        seen += bench.seen;
    }
    for (std::size_t i = 0; i < kPercentiles.size(); ++i)
        report.luminance[i] = seen.histogram.percentile(kPercentiles[i] / 100.0, seen.counts.dark);
    report.black = seen.counts.black;
    report.burnt = seen.counts.burnt;
    return error.status();
}

Status check_outputs(const std::vector<std::filesystem::path>& outputs) {
    std::set<std::filesystem::path> places;
    for (const std::filesystem::path& path : outputs) {
        std::error_code ignored;
        if (!places.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored)).second)
            return Error{ErrorCode::kUsage, fmt::format("--output {}: given twice", path.string())};
    }
    return {};
}

Result<ConvertReport> convert_in_arena(const ConvertOptions& options, const Progress& progress) {
    if (Status s = check_outputs(options.outputs); !s) return s.error();
    Result<Source> source = open_source(options);
    if (!source) return source.error();
    const Result<Display> display = display_from(options.profile, options.luminance_row);
    if (!display) return display.error();
    const Result<color::Tone> tone = color::tone_by_name(options.tone);
    if (!tone) return tone.error();
    const Result<color::Gamut> gamut = color::gamut_by_name(options.gamut);
    if (!gamut) return gamut.error();
    const Result<color::Cones> cones = color::cones_by_name(options.adapt);
    if (!cones) return cones.error();
    const Result<color::Chromaticity> white = options.white ? chromaticity_of(*options.white, *source) : source->white;
    if (!white) return white.error();
    const Result<color::Matrix3> adaptation = color::adaptation_matrix(*white, display->white, *cones);
    if (!adaptation && options.white) return Error{ErrorCode::kUsage, adaptation.error().message}.at("--white");
    if (!adaptation) return adaptation.error().at(options.input.string());
    color::PrintSettings settings{options.sensitivity, *tone, *gamut, *adaptation * source->xyz_from_file};

    const image::ExrImage& image = source->reader.image();
    if (options.auto_exposure) {
        const Result<BandPlan> plan = plan_bands(image, source->area, {}, options.memory, options.threads);
        if (!plan) return plan.error();
        const Result<double> sigma = find_sigma(*source, *plan, settings.adaptation, progress);
        if (!sigma) return sigma.error().at(options.input.string());
        settings.sigma = *sigma;
    }
    settings.sigma = color::pushed_sigma(settings.sigma, options.stops);
    const Result<color::Print> print = color::Print::create(display->space, settings);
    if (!print) return print.error();

    std::vector<std::unique_ptr<Sink>> sinks;
    const PrintedPicture picture{source->area, image.display_window, settings.sigma, *white};
    MemoryNeed need;
    for (const std::filesystem::path& path : options.outputs) {
        Result<std::unique_ptr<Sink>> sink = open_sink(path, picture, *display, options);
        if (!sink) return sink.error();
        need.bytes_per_row += (*sink)->bytes_per_row();
        need.bytes_held += (*sink)->bytes_held();
        sinks.push_back(std::move(*sink));
    }
    const Result<BandPlan> plan = plan_bands(image, source->area, need, options.memory, options.threads);
    if (!plan) return plan.error().at(options.input.string());
    ConvertReport report;
    report.width = source->area.width();
    report.height = source->area.height();
    report.sigma = settings.sigma;
    report.profile = display->space.name;
    report.gamut = options.gamut;
    report.tone = options.tone;
    report.white = *white;
    report.adapt = options.adapt;
    const Metering metering{settings.adaptation.m[1], printable_range(display->space.transfer, *tone, settings.sigma)};
    if (Status s = print_all(*source, *plan, *print, metering, sinks, progress, report); !s) return s.error();
    for (const auto& sink : sinks) {
        if (Status s = sink->finish(); !s) return s.error();
    }
    const auto held = hold_signals();  // all get their names, or none
    for (std::size_t i = 0; i < sinks.size(); ++i) {
        if (Status s = sinks[i]->publish(); !s) {
            const std::string done = fmt::format("{}", fmt::join(report.outputs, ", "));
            return Error{s.error().code, s.error().message + (done.empty() ? "" : "; complete and in place: " + done)};
        }
        report.outputs.push_back(options.outputs[i].string());
    }
    return report;
}

}  // namespace

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
