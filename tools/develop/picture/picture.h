// tools/develop/picture/picture.h: files of records become one picture: what latent-develop does between its command line and the
// engine.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/read/run_set.h"
#include "tools/develop/channels/observer_choice.h"
#include "tools/develop/engine/develop.h"
#include "tools/develop/forecast/forecast.h"
#include "tools/develop/lens/focus.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

struct PictureOptions {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;    // the EXR; "": none, and temporary files go where the system has room for them
    std::filesystem::path for_oidn;  // prefix of files that are written instead: oidn_picture.h
    std::string size;                // "4096x2731", "4096" (height from the film), "" (default_size)
    std::optional<PixelRect> crop;
    std::string filter = Filter::standard().name();
    ObserverOptions observer;
    std::vector<std::string> lights;  // "lamp=2.5": light_setting.h
    LensChoice lens;
    std::optional<Focus> focus;
    std::uint32_t frames = 1;    // pictures that divide the exposure among them: see frames_of
    std::string image = "both";  // or camera, light
    SpectralBins spectral_bins;  // none: XYZ
    Layers layers;
    bool dim_fireflies = false;
    double denoise = 0;  // share of the denoised picture (0..1]; 0: none
    bool ratio = false;  // the ratio estimator
    bool mipmap = false, zip = false, replace = false, skip_duplicates = false;
    bool ignore_space = false;  // begin even if the file is not expected to fit on the disk
    std::optional<sampledb::SampleRange> samples;
    double fraction = 1;        // share of these: a preview from some of the runs
    double budget_seconds = 0;  // or as many as can be developed in that time; 0: all
    std::optional<sampledb::JobId> job;
    std::uint64_t memory = std::uint64_t{1} << 30;
    int threads = 0;
    std::string simd = "best";
    std::string recipe;  // base/recipe.h, that the picture keeps; "": none
    Stopped stopped;     // ends it with kStopped

    bool is_preview() const { return fraction < 1 || budget_seconds > 0; }
};

// What remains of all samples.
struct LensCost {
    double light = 1;               // fraction of the light that passes
    double samples = 1;             // as many, of equal weight, would be as noisy
    std::optional<double> focus{};  // distance, if it was changed
    double noise() const { return 1 / std::sqrt(samples); }
};

struct PictureReport {
    std::string output;
    std::uint32_t width = 0, height = 0;
    bool size_chosen = false;  // by --size
    PixelRect crop;
    std::string filter, observer;
    std::vector<std::string> lights;  // as they were mixed
    bool dims_fireflies = false;
    std::optional<LensCost> lens;  // if only a part of the lens or of the exposure is used
    std::optional<color::CameraFit> camera_fit;
    double filter_factor = 1;  // that of the filter in front of the lens
    sampledb::JobId job;
    sampledb::Coverage coverage, missing;  // samples in the picture; those that were asked for by number, but are in no file
    std::uint64_t available = 0;           // samples that could be in it; a preview leaves some out
    std::size_t files = 0, runs = 0;
    std::uint64_t bytes_stored = 0;  // size of the selected runs on disk
    std::uint64_t bytes_read = 0;
    std::uint64_t file_bytes = 0, memory_for_all = 0;  // as expected before: forecast.h
    double seconds = 0;
    DevelopCounts counts;
    sampledb::RunSetReport run_set;
    std::vector<std::string> warnings;

    double samples_per_pixel() const { return static_cast<double>(coverage.size()) / (static_cast<double>(width) * height); }
    // Something damaged, foreign, missing or not finite was left out.
    bool has_losses() const {
        return !run_set.left_out.empty() || !missing.empty() || counts.camera_not_finite + counts.light_not_finite > 0;
    }
};

struct Size {
    std::uint32_t width, height;
};
// The size that the samples were rendered for, in the film's shape; if the files do not say, that with at least 16 of all samples
// per pixel. A preview, of fewer samples, is no larger than what has one of these per pixel.
Size default_size(const sampledb::RunSet& all, std::optional<std::uint64_t> preview_samples = std::nullopt);
// "WxH" or "W". Errors: kUsage, if the shape is off the film's by more than half a pixel, naming a size that fits.
Result<Size> parse_size_on_film(const std::string& text, const sampledb::Job& job);

// Errors: of the arguments (kUsage), no samples (kOutOfRange), of opening the files, reading and writing. A run that turns out to
// be damaged is left out, and the picture developed anew without it.
Result<PictureReport> develop_picture(const PictureOptions& options, const Progress& progress);
// The same, to `sink`.
Result<PictureReport> develop_picture(const PictureOptions& options, PictureSink& sink, const Progress& progress);

// The same, of runs that are open; what chooses among them was chosen then. Errors: as above, and kCorrupt or kTruncated of a run
// that is damaged.
Result<PictureReport> develop_picture(const PictureOptions& options, const sampledb::RunSet& open, PictureSink& sink,
                                      const Progress& progress);

// A command for each frame: "night.0001.exr", ... are what `options.output` "night.exr" becomes. One frame keeps its name.
std::vector<PictureOptions> frames_of(const PictureOptions& options);

// What that will take, from developing a few runs for about two seconds into nothing. Errors as above.
Result<Forecast> forecast_picture(const PictureOptions& options);

}  // namespace latent::develop
