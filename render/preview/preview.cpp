#include "render/preview/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "base/json.h"
#include "base/printable.h"
#include "base/size.h"
#include "base/temporary_path.h"
#include "render/program/report.h"
#include "tools/convert/convert.h"
#include "tools/develop/picture/picture.h"

namespace latent::render {
namespace {

constexpr double kMaxPixels = 1024, kUsefulPixels = 320, kMinPixels = 160;  // along the longer side
constexpr double kCleanPerPixel = 4;                                        // samples; below kUsefulPixels, one is enough

constexpr double kGlance = 1e-6;  // seconds: min_samples and no more

// The width of the picture; the height follows from the film. Noisy is better than tiny.
double width_for(const RenderJob& job, std::uint64_t samples) {
    const double shape = static_cast<double>(job.job.aspect_height) / job.job.aspect_width, longer = std::max(1.0, shape);
    const double at_one = std::sqrt(static_cast<double>(samples) / shape), clean = at_one / std::sqrt(kCleanPerPixel);
    const double width = std::min({static_cast<double>(job.resolution.width), kMaxPixels / longer,
                                   std::max(clean, std::min(at_one, kUsefulPixels / longer))});
    return std::max(std::floor(width), 1.0);
}

// One for each pixel of the smallest picture.
std::uint64_t min_samples(const RenderJob& job) {
    const double width = job.job.aspect_width, height = job.job.aspect_height,
                 scale = std::min(kMinPixels / std::max(width, height), job.resolution.width / width);
    return static_cast<std::uint64_t>(
        std::min(std::ceil(scale * width) * std::ceil(scale * height), static_cast<double>(job.range.size())));
}

}  // namespace

std::filesystem::path preview_path(const RenderOptions& options) {
    return std::filesystem::path(options.output).replace_extension(".preview.png");
}

Result<Preview> preview(const RenderJob& job, const RenderOptions& options, double seconds, bool denoise,
                        const std::atomic<bool>& stop) {
    const TrialPlace place{folder_of(options.output), "preview", "choose another folder with -o", "", min_samples(job)};
    // Pictures are decoded when they are first seen. The time begins when that is done.
    const bool is_cold = has_pictures(job.scene.description);
    Result<Trial> trial = render_trial(job, options, is_cold ? kGlance : seconds, place, stop);
    if (!trial) return trial.error();
    if (is_cold && !stop) {
        Result<Trial> warm = render_trial(job, options, seconds, place, stop);
        if (warm) trial = std::move(warm);
    }
    const Result<Forecast> expected = forecast(job, options, *trial);
    if (!expected) return expected.error();

    develop::PictureOptions picture;
    picture.inputs = {trial->file};
    picture.output = trial->folder.path() / "preview.exr";
    picture.size = fmt::format("{:.0f}", width_for(job, trial->samples));
    picture.dim_fireflies = true;
    picture.denoise = denoise ? 1 : 0;
    picture.threads = options.threads;
    const Result<develop::PictureReport> developed = develop::develop_picture(picture, {});
    if (!developed) return place.explained(developed.error());

    convert::ConvertOptions print;
    print.input = picture.output;
    print.outputs = {preview_path(options)};
    print.threads = options.threads;
    print.replace = true;
    const Result<convert::ConvertReport> printed = convert::convert(print, {});
    if (!printed) return printed.error();
    const bool is_black = !printed->auto_sigma;
    return Preview{preview_path(options), printed->width, printed->height, printed->sigma, is_black, denoise, *expected};
}

std::string to_text(const Preview& preview, const RenderJob& job, bool json) {
    const double per_pixel = static_cast<double>(preview.forecast.measured_samples) / preview.width / preview.height;
    if (json) {
        nlohmann::ordered_json out = nlohmann::ordered_json::parse(to_text(preview.forecast, job, true));
        out["preview"] = {{"file", printable(preview.picture.string())},
                          {"width", preview.width},
                          {"height", preview.height},
                          {"samples_per_pixel", per_pixel},
                          {"sensitivity", preview.sensitivity},
                          {"black", preview.is_black},
                          {"denoised", preview.is_denoised}};
        return json_text(out) + "\n";
    }
    const std::string print = preview.is_black
                                  ? "all black: check where the camera looks, and whether it is in a closed shape that no light "
                                    "gets into"
                                  : fmt::format("printed with -s {:.4g}", preview.sensitivity);
    return fmt::format("{}: {} x {} pixels, {}{}, {}\n{}", preview.picture.string(), preview.width, preview.height,
                       format_samples_per_pixel(per_pixel), preview.is_denoised ? ", denoised" : "", print,
                       to_text(preview.forecast, job, false));
}

}  // namespace latent::render
