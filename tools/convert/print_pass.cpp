#include "tools/convert/print_pass.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <cmath>

#include "base/first_error.h"
#include "color/luminance_row.h"

namespace latent::convert {

using image::Rect;

namespace {

// After each band.
void tell(const Progress& progress, std::size_t done, std::size_t all, const char* what) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(all), what);
}

// A block of pixels, in the planes of one thread.
struct Block {
    Rect area;
    std::array<float*, 3> planes;

    Block(const Rect& a, std::vector<float>& memory) : area(a) {
        memory.resize(3 * area.pixels());
        for (std::size_t c = 0; c < 3; ++c) planes[c] = memory.data() + c * area.pixels();
    }
    std::span<float> row(std::size_t c, int y) const {
        const std::size_t width = static_cast<std::size_t>(area.width());
        return {planes[c] + static_cast<std::size_t>(y - area.y0) * width, width};
    }
};

// What came of an exposure in one thread.
struct Outcome {
    color::PrintReport print;
    HueShifts hue_shifts;
};

// What one thread works in.
struct Workbench {
    image::ExrReader::Scratch scratch;
    std::vector<float> planes, printed;
    std::vector<float> film_print;  // X, Y, Z of a row
    std::vector<float> noise;       // the grain's, in planes of a block
    film::GrainField::Scratch grain;
    std::vector<float> luminances;  // one row's, in the scene or as printed
    std::vector<std::uint8_t> lacking;
    color::LuminanceHistogram histogram;
    std::vector<Outcome> outcomes;
};
using Workbenches = tbb::enumerable_thread_specific<Workbench>;

Status read_block(const Rows& rows, const Block& block) {
    for (int y = block.area.y0; y < block.area.y1; ++y) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (Status s = rows.read(c, block.area.x0, y, block.row(c, y)); !s) return s;
        }
    }
    return {};
}

// Reads the blocks of a band side by side, of the source or of what has become of its light, and hands each to `use`.
template <class Use>
void for_each_block(const Source& source, const Rows* light, const std::vector<Rect>& blocks, Workbenches& benches,
                    FirstError& error, const Use& use) {
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        if (error) return;
        Workbench& bench = benches.local();
        const Block block(blocks[i], bench.planes);
        const auto width = static_cast<std::size_t>(block.area.width());
        const Status read =
            light != nullptr ? read_block(*light, block) : source.read(block.area, block.planes, width, bench.scratch);
        if (!read) return error.set(read.error());
        use(block, bench);
    });
}

// Exposures that are not finite: to a film, NaN is no light, and infinity is the most.
void count_not_finite(const std::array<std::span<const float>, 3>& exposures, color::PrintReport& report) {
    float sum = 0;  // NaN if there is one
    for (const std::span<const float> layer : exposures) {
        for (const float x : layer) sum += x * 0;
    }
    if (sum == 0) return;
    for (std::size_t i = 0; i < exposures[0].size(); ++i) {
        const auto any = [&](const auto& is) { return is(exposures[0][i]) || is(exposures[1][i]) || is(exposures[2][i]); };
        if (any([](float x) { return std::isnan(x); }))
            ++report.nan;
        else if (any([](float x) { return std::isinf(x); }))
            ++report.infinite;
    }
}

void measure_block(const Block& block, const std::array<double, 3>& y_row, Workbench& bench) {
    bench.luminances.resize(static_cast<std::size_t>(block.area.width()));
    for (int y = block.area.y0; y < block.area.y1; ++y) {
        color::luminance_row(y_row, block.row(0, y), block.row(1, y), block.row(2, y), bench.luminances);
        bench.histogram.add(bench.luminances);
    }
}

void print_row(const Exposure& exposure, const PassSettings& settings, const Block& from, const Block& to, int y, Workbench& bench,
               Outcome& outcome) {
    const std::size_t width = static_cast<std::size_t>(from.area.width());
    std::array<std::span<const float>, 3> xyz{from.row(0, y), from.row(1, y), from.row(2, y)};
    if (exposure.film) {
        bench.film_print.resize(3 * width);
        const std::span<float> rows(bench.film_print);
        const std::array<std::span<float>, 3> seen{rows.first(width), rows.subspan(width, width), rows.last(width)};
        film::GrainRow grain{};
        if (settings.emulsion) {
            const std::size_t row = static_cast<std::size_t>(y - from.area.y0) * width, plane = from.area.pixels();
            grain = {{&bench.noise[row], &bench.noise[plane + row], &bench.noise[2 * plane + row]},
                     &settings.emulsion->granularity};
        }
        count_not_finite(xyz, outcome.print);
        exposure.film->row(static_cast<float>(exposure.sigma), xyz, seen, settings.emulsion ? &grain : nullptr);
        xyz = {seen[0], seen[1], seen[2]};
    }
    const std::uint64_t out_of_gamut = outcome.print.out_of_gamut;
    exposure.print.row(xyz[0], xyz[1], xyz[2], to.row(0, y), to.row(1, y), to.row(2, y), outcome.print, bench.luminances);
    if (settings.gamut) {
        bench.lacking.resize(bench.luminances.size());
        outcome.print.out_of_gamut =
            out_of_gamut + settings.gamut->find_lacking({to.row(0, y), to.row(1, y), to.row(2, y)}, bench.lacking);
    }
    const InspectedRow row{xyz[0],       xyz[1],       xyz[2],        bench.luminances, to.row(0, y),
                           to.row(1, y), to.row(2, y), bench.lacking, from.area.x0,     y};
    if (settings.gamut_report) find_hue_shifts(exposure.print, settings.space, row, outcome.hue_shifts);
    if (settings.proof) settings.proof->apply({to.row(0, y), to.row(1, y), to.row(2, y)}, {});
    if (settings.show_clipped) mark_clipped(exposure.print, settings.shown_space, row);
}

// Black and white has one layer of grain, and looks at no other.
void fill_grain(const Emulsion& emulsion, const PassSettings& settings, const Rect& area, Workbench& bench) {
    const std::size_t plane = area.pixels();
    bench.noise.resize(3 * plane);
    emulsion.grain.fill(area.x0 - settings.frame_x0, area.y0 - settings.frame_y0, area.width(), area.height(),
                        {bench.noise.data(), bench.noise.data() + plane, bench.noise.data() + 2 * plane}, bench.grain);
}

}  // namespace

std::size_t emulsion_bytes(const PassSettings& settings, int width, int height) {
    if (!settings.emulsion) return 0;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return 3 * sizeof(float) * pixels + settings.emulsion->grain.scratch_bytes(width, height);
}

bool needs_second_block(const std::vector<Exposure>& exposures, const PassSettings& settings) {
    return exposures.size() > 1 || settings.show_clipped || settings.gamut_report;
}

Result<color::LuminanceHistogram> measure(const Source& source, const BandPlan& plan, const std::array<double, 3>& y_row,
                                          const Progress& progress) {
    Workbenches benches;
    FirstError error;
    for (std::size_t i = 0; i < plan.band_ends.size() && !error; ++i) {
        for_each_block(source, nullptr, plan.blocks(plan.band(i)), benches, error,
                       [&](const Block& block, Workbench& bench) { measure_block(block, y_row, bench); });
        tell(progress, i + 1, plan.band_ends.size(), "measuring the light");
    }
    if (error) return error.status().error();
    color::LuminanceHistogram all;
    for (const Workbench& bench : benches) all += bench.histogram;
    return all;
}

Result<PassReport> print_all(const Source& source, const BandPlan& plan, const std::vector<Exposure>& exposures,
                             const PassSettings& settings, const Progress& progress) {
    Workbenches benches;
    FirstError error;
    std::size_t next = 0, done = 0;
    using Bands = std::vector<std::vector<Band>>;  // for each exposure, one for each output
    const bool apart = needs_second_block(exposures, settings);
    const auto print_band = [&](tbb::flow_control& flow) -> std::shared_ptr<Bands> {
        if (next == plan.band_ends.size() || error) {
            flow.stop();
            return nullptr;
        }
        const Rect area = plan.band(next++);
        if (settings.light) error.keep(settings.light->make(area.y1));
        auto bands = std::make_shared<Bands>(exposures.size());
        for (std::size_t e = 0; e < exposures.size(); ++e) {
            for (const auto& sink : exposures[e].sinks) (*bands)[e].push_back(sink->new_band(area));
        }
        for_each_block(source, settings.light.get(), plan.blocks(area), benches, error, [&](const Block& block, Workbench& bench) {
            bench.outcomes.resize(exposures.size());
            measure_block(block, settings.y_row, bench);
            for (int y = block.area.y0; y < block.area.y1; ++y)
                settings.dodging.apply(block.area.x0, y, {block.row(0, y), block.row(1, y), block.row(2, y)});
            if (settings.emulsion) fill_grain(*settings.emulsion, settings, block.area, bench);
            const Block to = apart ? Block(block.area, bench.printed) : block;
            for (std::size_t e = 0; e < exposures.size(); ++e) {
                for (int y = block.area.y0; y < block.area.y1; ++y)
                    print_row(exposures[e], settings, block, to, y, bench, bench.outcomes[e]);
                const PrintedBlock printed{
                    block.area, {to.planes[0], to.planes[1], to.planes[2]}, static_cast<std::size_t>(block.area.width())};
                for (std::size_t i = 0; i < exposures[e].sinks.size(); ++i) exposures[e].sinks[i]->take((*bands)[e][i], printed);
            }
        });
        return bands;
    };
    const auto encode_band = [&](const std::shared_ptr<Bands>& bands) {
        for (std::size_t e = 0; e < exposures.size(); ++e) {
            for (std::size_t i = 0; i < exposures[e].sinks.size() && !error; ++i)
                error.keep(exposures[e].sinks[i]->write((*bands)[e][i]));
        }
        tell(progress, ++done, plan.band_ends.size(), "");
    };
    tbb::parallel_pipeline(plan.overlapped ? 2 : 1,
                           tbb::make_filter<void, std::shared_ptr<Bands>>(tbb::filter_mode::serial_in_order, print_band) &
                               tbb::make_filter<std::shared_ptr<Bands>, void>(tbb::filter_mode::serial_in_order, encode_band));
    if (error) return error.status().error();
    PassReport report;
    report.exposures.resize(exposures.size());
    for (const Workbench& bench : benches) {
        report.luminance += bench.histogram;
        for (std::size_t e = 0; e < bench.outcomes.size(); ++e) {
            const Outcome& outcome = bench.outcomes[e];
            ExposureReport& to = report.exposures[e];
            to.print += outcome.print;
            to.hue_shifts += outcome.hue_shifts;
        }
    }
    return report;
}

}  // namespace latent::convert
