// tools/darkroom/engine/engine.h: runs that are held open, and any part of their print at any size. docs/latent_darkroom.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/recipe.h"
#include "base/result.h"
#include "sampledb/read/run_set.h"
#include "tools/convert/options.h"
#include "tools/darkroom/engine/decisions.h"
#include "tools/darkroom/engine/developing.h"
#include "tools/darkroom/engine/kept_picture.h"
#include "tools/darkroom/engine/measures.h"
#include "tools/darkroom/engine/picture_cache.h"
#include "tools/develop/channels/light_groups.h"
#include "tools/develop/noise/noise.h"
#include "tools/develop/picture/picture.h"

namespace latent::darkroom {

struct EngineOptions {
    std::vector<std::filesystem::path> inputs;
    bool skip_duplicates = false;
    std::uint64_t memory = std::uint64_t{1} << 30;
    int threads = 0;
};

struct ViewOptions {
    // Lights are mixed as a sum of pictures of each group, which is there at once when these are: the print, but for last digits,
    // and without the removal of noise.
    bool mixed = false;
    Stopped stopped{};  // gives up: kStopped
};

// For any number of threads. Pictures are developed one at a time, on all threads of the options.
class Engine {
 public:
    // Errors: of opening the files.
    static Result<std::unique_ptr<Engine>> open(EngineOptions options);

    // As of the last `look_again`.
    std::shared_ptr<const sampledb::RunSet> runs() const;
    // Whether the files hold more samples than before, which are in all pictures from now on. Costs little while they do not
    // change. While a part is being replaced, or cannot be read, all stays as it was: samples never become fewer.
    bool look_again();
    std::vector<develop::LightGroup> light_groups() const { return opened().light_groups; }  // none: the files keep none apart
    std::optional<double> f_number() const;  // the lens's, if its aperture can be chosen
    bool knows_shutter() const;              // whether the shutter can be chosen
    bool knows_depth() const;                // whether there is a `distance`
    // Along the camera's axis, of what a pixel shows, as --focus X,Y takes it; infinite for the sky. Errors: kUsage.
    Result<double> distance(const develop::Size& size, int x, int y) const;
    develop::Size default_size() const { return develop::default_size(*runs()); }
    Result<develop::Size> size_of_width(std::uint32_t width) const;

    // The recipe with its exposure as a number: "sensitivity", which is chosen from the whole picture where the recipe has none. It
    // is at most 2048 pixels wide for that, so the number of a print of another size could differ a little; with the number, it
    // cannot. Errors: kUsage, what is wrong with the recipe; of developing.
    Result<Recipe> resolve(const Recipe& recipe, const ViewOptions& options = {});

    // Pixels `area` of the picture `size`: as latent-print prints them with this recipe and that --size, without a crop, as 8-bit
    // PNG. The recipe is one that `resolve` returned: without a number, each part would choose its own exposure.
    Result<convert::CodeValues> view(const Recipe& recipe, const develop::Size& size, const image::Rect& area,
                                     const ViewOptions& options = {});
    // Counted over the whole picture.
    Result<Histogram> histogram(const Recipe& recipe, const develop::Size& size, const ViewOptions& options = {});
    Result<Probe> probe(const Recipe& recipe, const develop::Size& size, int x, int y, const Stopped& stopped = {});
    // Errors: kUsage of files that hold XYZ.
    Result<ProbedSpectrum> spectrum(const Recipe& recipe, const develop::Size& size, int x, int y, int bins,
                                    const Stopped& stopped = {});
    // How noisy the whole picture is before noise is removed, in areas of NoiseMap::kSide pixels: as `latent-inspect noise` says
    // it.
    Result<develop::NoiseMap> noise(const Recipe& recipe, const develop::Size& size, const Stopped& stopped = {});

 private:
    using Picture = std::shared_ptr<const KeptPicture>;
    struct Opened {
        std::shared_ptr<const sampledb::RunSet> runs;
        std::vector<develop::LightGroup> light_groups{};
        std::string files{};           // as they were when they were last looked at: names, sizes, times
        std::uint64_t generation = 0;  // another one whenever the samples change
    };

    // The print of a whole picture in which light spreads.
    struct WholePrint {
        std::weak_ptr<const KeptPicture> of{};
        std::string how{};
        convert::CodeValues codes{};
        convert::ConvertReport report{};
    };

    Engine(EngineOptions options, std::unique_ptr<sampledb::RunSet> runs, std::string files);

    // What is developed at once: all of a picture that is small or spreads light, else squares of kBlock.
    static Result<image::Rect> block_at(const Decisions& decisions, const develop::Size& size, int x, int y);
    Result<Picture> developed(const Decisions& decisions, const develop::Size& size, const image::Rect& block,
                              const ViewOptions& options);
    Result<Picture> mixed(const Decisions& decisions, const develop::Size& size, const image::Rect& block, const Stopped& stopped);
    // What is kept as `key`, or is developed now.
    Result<Picture> kept_or_made(const std::string& key, const std::function<Status(KeptPicture&, const Stopped&)>& make,
                                 const Stopped& stopped);
    // Pixels `area` of what is developed of `block`.
    Result<convert::ConvertReport> print(const Decisions& decisions, const develop::Size& size, const image::Rect& block,
                                         const image::Rect& area, convert::CodeValues& codes, const ViewOptions& options);
    Status develop(const develop::PictureOptions& options, const Stopped& stopped, develop::PictureSink& sink);
    Opened opened() const;
    void use(std::unique_ptr<sampledb::RunSet> runs);

    const EngineOptions options_;
    mutable std::mutex mutex_;  // guards opened_
    Opened opened_;
    std::mutex looking_;     // one at a time looks again
    std::mutex printing_;    // or prints
    WholePrint last_print_;  // under printing_
    PictureCache cache_;
    Developing developing_;  // ends first
};

}  // namespace latent::darkroom
