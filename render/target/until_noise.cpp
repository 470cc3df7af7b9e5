#include "render/target/until_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.h"
#include "base/memory.h"
#include "base/size.h"
#include "base/stopwatch.h"
#include "render/program/forecast.h"
#include "render/program/report.h"
#include "sampledb/data/grain.h"

namespace latent::render {

namespace {

constexpr double kFirstPerPixel = 16;  // samples of the first round
constexpr double kMaxGrowth = 4;       // from one round to the next: few samples say little about many
constexpr double kMargin = 1.02;       // on a forecast, so that it need not be made again because of chance

// The end of what is committed, by earlier rounds or by rounds that were interrupted.
std::uint64_t committed_end(const sampledb::SampleRange& all, const sampledb::Coverage& missing) {
    const bool is_end_there = missing.empty() || missing.ranges().back().end < all.end;
    return is_end_there ? all.end : missing.ranges().back().first;
}

}  // namespace

Result<UntilNoiseReport> render_until(RenderJob& job, RenderSettings settings, RenderOptions options, const NoiseTarget& target,
                                      bool ignore_space, const std::atomic<bool>& stop, const Progress& progress) {
    const sampledb::SampleRange all = job.range;
    const Result<sampledb::Coverage> missing = sampledb::PartWriter::find_missing(part_options(job, options), job.job);
    if (!missing) return missing.error();
    const double pixels = static_cast<double>(job.resolution.width) * job.resolution.height;
    const double max_seconds = options.max_seconds;
    const auto after = [&](double samples) { return all.first + static_cast<std::uint64_t>(std::min(samples, 0x1p62)); };
    std::uint64_t end = std::max(committed_end(all, *missing), after(std::ceil(kFirstPerPixel * pixels)));

    UntilNoiseReport report;
    while (true) {
        report.noise.reset();
        job.range.end = std::min((end + sampledb::kGrainSamples - 1) / sampledb::kGrainSamples * sampledb::kGrainSamples, all.end);
        settings.spp = static_cast<double>(job.range.size()) / pixels;
        options.provenance_json = provenance(job, settings, all.size() - missing->size());
        if (max_seconds > 0) options.max_seconds = std::max(max_seconds - report.render.seconds - report.measuring_seconds, 1e-3);
        if (!ignore_space) {
            if (Status s = check_space(job, options, stop); !s) return s.error();
        }
        Result<RenderReport> round = render(job, options, stop, progress);
        if (!round) return round.error();
        round->samples += report.render.samples;
        round->seconds += report.render.seconds;
        round->faults += report.render.faults;
        report.render = *std::move(round);
        if (!report.render.complete || stop) return report;

        options.force = false;  // from now on, what is there is ours
        const Stopwatch stopwatch;
        develop::PictureOptions picture;
        picture.inputs = {options.output};
        picture.size = target.width > 0 ? std::to_string(target.width) : "";
        picture.memory = default_memory();
        picture.threads = options.threads;
        const Result<develop::Noise> noise = develop::measure_noise(picture, 0, false, {});
        if (!noise) return noise.error();
        report.measuring_seconds += stopwatch.seconds();
        report.noise = noise->levels.front();
        const double median = report.noise->relative.median, samples = static_cast<double>(job.range.size());
        if (median <= target.relative) return report;
        if (std::isnan(median)) {
            report.shortfall = "--until-noise: no light reaches the picture: check where the camera looks and where the lights are";
            return report;
        }
        if (job.range.end == all.end) {
            report.shortfall = fmt::format("--max-spp: reached, and the noise is still {:#.3g} %", 100 * median);
            return report;
        }
        end = after(std::ceil(std::min(kMargin * noise->samples_for(target.relative), kMaxGrowth * samples)));
    }
}

std::string to_text(const UntilNoiseReport& report, const NoiseTarget& target, const RenderJob& job, bool json) {
    const std::string rendered = to_text(report.render, job, json);
    if (json) {
        nlohmann::ordered_json out = nlohmann::ordered_json::parse(rendered);
        out["noise"] = {{"target", target.relative},
                        {"reached", report.noise && report.shortfall.empty()},
                        {"measuring_seconds", report.measuring_seconds}};
        if (report.noise) {
            out["noise"]["median"] = report.noise->relative.median;
            out["noise"]["p95"] = report.noise->relative.p95;
            out["noise"]["samples_per_pixel"] = report.noise->samples_per_pixel;
        }
        return json_text(out) + "\n";
    }
    if (!report.noise) return rendered;
    return fmt::format("{}noise {:#.3g} %, of 5 % of the pixels more than {:#.3g} %, with {}; measured in {}\n", rendered,
                       100 * report.noise->relative.median, 100 * report.noise->relative.p95,
                       format_samples_per_pixel(report.noise->samples_per_pixel), format_duration(report.measuring_seconds));
}

}  // namespace latent::render
