#include "tools/darkroom/engine/engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sampledb/data/unreadable.h"
#include "tools/convert/convert.h"
#include "tools/develop/channels/light_groups.h"
#include "tools/develop/lens/lens_columns.h"
#include "tools/develop/lens/recorded_lens.h"
#include "tools/develop/lens/shutter.h"
#include "tools/develop/picture/pixel_array.h"
#include "tools/develop/picture/unnamed_picture.h"

namespace latent::darkroom {

using image::Rect;

namespace {

constexpr int kBlock = 2048;

sampledb::RunSetOptions selection_of(const EngineOptions& options, sampledb::VerifyLevel verify) {
    sampledb::RunSetOptions selection;
    selection.inputs = options.inputs;
    selection.skip_duplicates = options.skip_duplicates;
    selection.verify = verify;
    selection.memory = options.memory / 2;
    selection.announced_reads = true;
    return selection;
}

develop::PixelRect pixels_of(const Rect& r) { return {r.x0, r.y0, r.x1, r.y1}; }

std::string text_of(const develop::Size& size) { return fmt::format("{}x{}", size.width, size.height); }

Rect whole(const develop::Size& size) { return {0, 0, static_cast<int>(size.width), static_cast<int>(size.height)}; }

// What is seen of them, at this size.
develop::PictureOptions picture_of(const Decisions& decisions, const develop::Size& size, const Rect& block) {
    develop::PictureOptions picture = decisions.picture;
    picture.size = text_of(size);
    picture.crop = pixels_of(block);
    picture.mipmap = picture.zip = false;
    if (decisions.print.layer.empty()) picture.layers = {};
    return picture;
}

}  // namespace

Engine::Engine(EngineOptions options, std::unique_ptr<sampledb::RunSet> runs)
    : options_(std::move(options)), runs_(std::move(runs)), cache_(options_.memory / 2) {}

Result<std::unique_ptr<Engine>> Engine::open(EngineOptions options) {
    Result<std::unique_ptr<sampledb::RunSet>> runs = sampledb::RunSet::open(selection_of(options, sampledb::VerifyLevel::kHeaders));
    if (!runs) return runs.error();
    if ((*runs)->coverage().empty()) return Error{ErrorCode::kOutOfRange, "the files hold no samples"};
    return std::unique_ptr<Engine>(new Engine(std::move(options), std::move(*runs)));
}

std::vector<std::string> Engine::light_groups() const {
    std::vector<std::string> names;
    const Result<std::vector<develop::LightGroup>> groups = develop::light_groups_of(*runs_);
    if (groups) std::ranges::transform(*groups, std::back_inserter(names), &develop::LightGroup::name);
    return names;
}

std::optional<double> Engine::f_number() const {
    if (!develop::lens_columns(runs_->job())) return std::nullopt;
    const Result<develop::RecordedLens> lens = develop::recorded_lens(*runs_, "--aperture");
    return lens ? std::optional(lens->f_number()) : std::nullopt;
}

bool Engine::knows_shutter() const { return develop::place_of_fractions(runs_->job(), "shutter").has_value(); }

Result<develop::Size> Engine::size_of_width(std::uint32_t width) const {
    return develop::parse_size_on_film(std::to_string(width), runs_->job());
}

Result<Recipe> Engine::resolve(const Recipe& recipe) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    const develop::PictureOptions& picture = decisions->picture;
    const Result<develop::Size> of_print =
        picture.size.empty() ? default_size() : develop::parse_size_on_film(picture.size, runs_->job());
    if (!of_print) return of_print.error();
    if (picture.crop && develop::intersection(*picture.crop, pixels_of(whole(*of_print))) != *picture.crop)
        return usage_error(fmt::format("--crop: is not inside the picture of {} x {} pixels", of_print->width, of_print->height));
    Recipe resolved = recipe;
    convert::CodeValues codes;
    const Result<develop::Size> size = size_of_width(std::min(std::uint32_t{kBlock}, default_size().width));
    if (!size) return size.error();
    const std::scoped_lock lock(mutex_);
    const bool chooses = decisions->print.chooses_exposure();
    // Developing and printing a pixel tells what is wrong with the rest.
    const Rect metered = chooses ? whole(*size) : Rect{0, 0, 1, 1};
    const Result<convert::ConvertReport> report = print(*decisions, *size, metered, metered, codes);
    if (!report) return report.error();
    if (!chooses) return resolved;
    Recipe& section = resolved["convert"];
    if (section.is_null()) section = Recipe::object();
    section.erase("auto");
    section.erase("key");
    section["sensitivity"] = report->auto_sigma.value_or(1);
    return resolved;
}

Result<convert::CodeValues> Engine::view(const Recipe& recipe, const develop::Size& size, const Rect& area) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    if (area.empty() || !whole(size).contains(area))
        return usage_error(fmt::format("{},{},{},{}: is not inside the picture of {} x {} pixels", area.x0, area.y0, area.x1,
                                       area.y1, size.width, size.height));
    const std::scoped_lock lock(mutex_);
    convert::CodeValues all;
    for (int y = area.y0, y_next = 0; y < area.y1; y = y_next) {
        for (int x = area.x0, x_next = 0; x < area.x1; x = x_next) {
            const Result<Rect> block = block_at(*decisions, size, x, y);
            if (!block) return block.error();
            const Rect part = image::intersect(*block, {x, y, area.x1, area.y1});
            x_next = part.x1, y_next = part.y1;
            convert::CodeValues codes;
            const Result<convert::ConvertReport> report = print(*decisions, size, *block, part, codes);
            if (!report) return report.error();
            if (part == area) return codes;
            const auto channels = static_cast<std::size_t>(codes.channels),
                       stride = channels * static_cast<std::size_t>(area.width());
            if (all.codes.empty()) {
                all = {area.width(),   area.height(),
                       codes.channels, std::vector<std::byte>(stride * static_cast<std::size_t>(area.height())),
                       codes.srgb,     codes.icc};
            }
            const std::size_t row = channels * static_cast<std::size_t>(part.width());
            for (int i = 0; i < part.height(); ++i)
                std::copy_n(codes.codes.data() + static_cast<std::size_t>(i) * row, row,
                            all.codes.data() + static_cast<std::size_t>(part.y0 - area.y0 + i) * stride +
                                channels * static_cast<std::size_t>(part.x0 - area.x0));
        }
    }
    return all;
}

Result<Histogram> Engine::histogram(const Recipe& recipe, const develop::Size& size) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    if (std::max(size.width, size.height) > kBlock)
        return usage_error(fmt::format("a histogram is of at most {} pixels a side", kBlock));
    const std::scoped_lock lock(mutex_);
    convert::CodeValues codes;
    const Result<convert::ConvertReport> report = print(*decisions, size, whole(size), whole(size), codes);
    if (!report) return report.error();
    Histogram histogram{{}, report->print.pixels, report->print.burnt, report->print.black, report->print.out_of_gamut};
    const auto channels = static_cast<std::size_t>(codes.channels);
    for (std::size_t i = 0; i < codes.codes.size(); i += channels) {
        for (std::size_t c = 0; c < 3; ++c) ++histogram.counts[c][static_cast<std::size_t>(codes.codes[i + c % channels])];
    }
    return histogram;
}

Result<Probe> Engine::probe(const Recipe& recipe, const develop::Size& size, int x, int y) {
    const Rect pixel{x, y, x + 1, y + 1};
    const Result<convert::CodeValues> codes = view(recipe, size, pixel);
    if (!codes) return codes.error();
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    develop::PictureOptions picture = picture_of(*decisions, size, pixel);
    picture.denoise = 0;
    picture.dim_fireflies = false;
    picture.layers = {};
    picture.layers.variance = picture.layers.count = true;
    develop::PixelArray pixels;
    const std::scoped_lock lock(mutex_);
    if (Status s = develop(picture, pixels); !s) return s.error();
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
        probe.codes[c] = static_cast<int>(codes->codes[c % static_cast<std::size_t>(codes->channels)]);
    return probe;
}

Result<Rect> Engine::block_at(const Decisions& decisions, const develop::Size& size, int x, int y) {
    const Rect all = whole(size);
    constexpr std::size_t kSmall = std::size_t{kBlock} * kBlock, kMostSpread = 16 * kSmall;
    if (all.pixels() <= kSmall) return all;
    if (decisions.spreads_light()) {
        if (all.pixels() <= kMostSpread) return all;
        return usage_error(
            "light spreads over the whole picture (glare, or a film that scatters it), which is too large here; zoom out, or print "
            "it");
    }
    const int x0 = x / kBlock * kBlock, y0 = y / kBlock * kBlock;
    return image::intersect(all, {x0, y0, x0 + kBlock, y0 + kBlock});
}

Status Engine::develop(const develop::PictureOptions& asked, develop::PictureSink& sink) {
    develop::PictureOptions options = asked;
    options.inputs = options_.inputs;
    options.memory = options_.memory / 2;
    options.threads = options_.threads;
    Result<develop::PictureReport> report = develop::develop_picture(options, *runs_, sink, {});
    if (!report && sampledb::is_unreadable(report.error())) {  // leaves out what is damaged, as latent-develop does
        Result<std::unique_ptr<sampledb::RunSet>> runs =
            sampledb::RunSet::open(selection_of(options_, sampledb::VerifyLevel::kOrdered));
        if (!runs) return runs.error();
        runs_ = std::move(*runs);
        report = develop::develop_picture(options, *runs_, sink, {});
    }
    if (!report) return report.error();
    return {};
}

Result<std::shared_ptr<const File>> Engine::developed(const Decisions& decisions, const develop::Size& size, const Rect& block) {
    const std::string key = fmt::format("{} {},{},{},{} {} {}", text_of(size), block.x0, block.y0, block.x1, block.y1,
                                        decisions.print.layer, decisions.of_light());
    if (std::shared_ptr<const File> kept = cache_.find(key)) return kept;
    develop::UnnamedPicture picture(File::create_in_memory);
    if (Status s = develop(picture_of(decisions, size, block), picture); !s) return s.error();
    cache_.keep(key, picture.file());
    return picture.file();
}

Result<convert::ConvertReport> Engine::print(const Decisions& decisions, const develop::Size& size, const Rect& block,
                                             const Rect& area, convert::CodeValues& codes) {
    const Result<std::shared_ptr<const File>> picture = developed(decisions, size, block);
    if (!picture) return picture.error();
    convert::ConvertOptions options = decisions.print;
    options.input = options_.inputs.front();
    options.picture = *picture;
    options.codes = std::make_shared<convert::CodeValues>();
    options.stops.resize(1);
    options.crop = area;
    options.paper_width_mm = 0;
    options.memory = options_.memory / 2;
    options.threads = options_.threads;
    Result<convert::ConvertReport> report = convert::convert(options, {});
    if (report) codes = std::move(*options.codes);
    return report;
}

}  // namespace latent::darkroom
