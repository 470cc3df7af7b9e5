#include "tools/darkroom/engine/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/darkroom/engine/engine.h"
#include "tools/darkroom/engine/seen_picture.h"

namespace latent::darkroom {

using image::Rect;

namespace {

// A pixel as its samples give it, before noise is removed, with variance and count.
develop::PictureOptions measured(const Decisions& decisions, const develop::Size& size, int x, int y) {
    develop::PictureOptions picture = picture_of(decisions, size, {x, y, x + 1, y + 1});
    picture.denoise = 0;
    picture.dim_fireflies = false;
    picture.layers = {};
    picture.layers.variance = picture.layers.count = true;
    return picture;
}

}  // namespace

Result<Histogram> Engine::histogram(const Recipe& recipe, const develop::Size& size, const ViewOptions& options) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    decisions->print.show_clipped = false;  // which leaves grey of the rest
    if (std::max(size.width, size.height) > kBlock)
        return usage_error(fmt::format("a histogram is of at most {} pixels a side", kBlock));
    convert::CodeValues codes;
    const Result<convert::ConvertReport> report = print(*decisions, size, whole(size), whole(size), codes, options);
    if (!report) return report.error();
    Histogram histogram{{}, report->print.pixels, report->print.burnt, report->print.black, report->print.out_of_gamut};
    const auto channels = static_cast<std::size_t>(codes.channels);
    for (std::size_t i = 0; i < codes.codes.size(); i += channels) {
        for (std::size_t c = 0; c < 3; ++c) ++histogram.counts[c][static_cast<std::size_t>(codes.codes[i + c % channels])];
    }
    return histogram;
}

Result<Probe> Engine::probe(const Recipe& recipe, const develop::Size& size, int x, int y, const Stopped& stopped) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    const Rect pixel{x, y, x + 1, y + 1};
    const Result<Rect> block = decisions->spreads_light() ? block_at(*decisions, size, x, y) : pixel;
    if (!block) return block.error();
    convert::CodeValues codes;
    const Result<convert::ConvertReport> printed = print(*decisions, size, *block, pixel, codes, {.stopped = stopped});
    if (!printed) return printed.error();
    const develop::PictureOptions picture = measured(*decisions, size, x, y);
    const auto make = [this, picture](KeptPicture& made, const Stopped& given_up) {
        return develop(picture, given_up, made.linear);
    };
    const std::string key = fmt::format("probe {} {},{} {}", text_of(size), x, y, decisions->of_light());
    const Result<Picture> made = kept_or_made(key, make, stopped);
    if (!made) return made.error();
    const develop::PixelArray& pixels = (*made)->linear;
    Probe probe;
    probe.observer = picture.observer.film.empty() ? picture.observer.name : picture.observer.film;
    const std::vector<std::string>& names = pixels.channels();
    for (std::size_t i = 0; i < names.size(); ++i) {
        constexpr std::string_view kColours[] = {"R", "G", "B"};
        const double value = pixels.pixels()[i];
        for (std::size_t c = 0; c < 3; ++c) {
            if (names[i] == kColours[c]) probe.values[c] = value;
            if (names[i] == fmt::format("variance.{}", kColours[c])) probe.standard_errors[c] = std::sqrt(std::max(0.0, value));
        }
        if (names[i] == "count") probe.samples = value;
    }
    for (std::size_t c = 0; c < 3; ++c)
        probe.codes[c] = static_cast<int>(codes.codes[c % static_cast<std::size_t>(codes.channels)]);
    return probe;
}

Result<ProbedSpectrum> Engine::spectrum(const Recipe& recipe, const develop::Size& size, int x, int y, int bins,
                                        const Stopped& stopped) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    develop::PictureOptions picture = measured(*decisions, size, x, y);
    picture.observer = {};
    picture.ratio = false;
    picture.spectral_bins.count = bins;
    const auto make = [this, picture](KeptPicture& made, const Stopped& given_up) {
        return develop(picture, given_up, made.linear);
    };
    const std::string key = fmt::format("spectrum {} {} {},{} {}", bins, text_of(size), x, y, decisions->of_light());
    const Result<Picture> made = kept_or_made(key, make, stopped);
    if (!made) return made.error();
    const std::vector<float>& pixel = (*made)->linear.pixels();  // bins, their variances, count
    const auto count = static_cast<std::size_t>(bins);
    ProbedSpectrum spectrum{picture.spectral_bins.from_nm, picture.spectral_bins.to_nm, {}, {}, pixel[2 * count]};
    for (std::size_t i = 0; i < count; ++i) {
        spectrum.values.push_back(pixel[i]);
        spectrum.standard_errors.push_back(std::sqrt(std::max(0.0F, pixel[count + i])));
    }
    return spectrum;
}

Result<develop::NoiseMap> Engine::noise(const Recipe& denoised, const develop::Size& size, const Stopped& stopped) {
    Recipe recipe = denoised;
    if (recipe.contains("develop")) recipe["develop"].erase("denoise");
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    if (std::max(size.width, size.height) > kBlock)
        return usage_error(fmt::format("a noise map is of at most {} pixels a side", kBlock));
    develop::PictureOptions picture = picture_of(*decisions, size, whole(size));
    picture.layers = {};
    picture.layers.halves = true;
    const auto make = [this, picture](KeptPicture& made, const Stopped& given_up) {
        return develop(picture, given_up, made.noise);
    };
    const Result<Picture> made = kept_or_made(fmt::format("noise {} {}", text_of(size), decisions->of_light()), make, stopped);
    if (!made) return made.error();
    return (*made)->noise;
}

}  // namespace latent::darkroom
