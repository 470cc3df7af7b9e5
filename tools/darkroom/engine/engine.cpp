#include "tools/darkroom/engine/engine.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "sampledb/data/unreadable.h"
#include "sampledb/read/input_files.h"
#include "tools/convert/convert.h"
#include "tools/darkroom/engine/light_mix.h"
#include "tools/darkroom/engine/seen_picture.h"
#include "tools/develop/lens/focus.h"
#include "tools/develop/lens/lens_columns.h"
#include "tools/develop/lens/recorded_lens.h"
#include "tools/develop/lens/shutter.h"
#include "tools/develop/picture/unnamed_picture.h"

namespace latent::darkroom {

using image::Rect;

namespace {

// Shares of --memory: pictures are kept while one is developed and another printed.
std::uint64_t memory_to_keep(const EngineOptions& options) { return options.memory / 8 * 3; }
std::uint64_t memory_to_develop(const EngineOptions& options) { return options.memory / 8 * 3; }
std::uint64_t memory_to_print(const EngineOptions& options) { return options.memory / 4; }

sampledb::RunSetOptions selection_of(const EngineOptions& options, sampledb::VerifyLevel verify) {
    sampledb::RunSetOptions selection;
    selection.inputs = options.inputs;
    selection.skip_duplicates = options.skip_duplicates;
    selection.verify = verify;
    selection.memory = memory_to_develop(options);
    selection.announced_reads = true;
    return selection;
}

// Their names, sizes and times, and those of attempts at them.
std::string state_of_files(const std::vector<std::filesystem::path>& inputs) {
    std::string state;
    const auto files = sampledb::list_input_files(inputs);
    if (!files) return state;
    for (const sampledb::InputFile& file : *files) {
        std::error_code none;
        const std::uint64_t size = std::filesystem::file_size(file.path, none);
        const auto time = std::filesystem::last_write_time(file.path, none).time_since_epoch().count();
        state += fmt::format("{} {} {}\n", file.path.string(), size, time);
    }
    return state;
}

constexpr std::size_t kSmall = std::size_t{kBlock} * kBlock;  // pixels that are developed at once

convert::CodeValues part_of(const convert::CodeValues& all, const Rect& part) {
    const auto channels = static_cast<std::size_t>(all.channels), row = channels * static_cast<std::size_t>(part.width());
    convert::CodeValues codes{part.width(), part.height(), all.channels, {}, all.srgb, all.icc};
    codes.codes.reserve(row * static_cast<std::size_t>(part.height()));
    for (int y = part.y0; y < part.y1; ++y) {
        const auto from =
            all.codes.begin() + static_cast<std::ptrdiff_t>(channels) * (static_cast<std::ptrdiff_t>(y) * all.width + part.x0);
        codes.codes.insert(codes.codes.end(), from, from + static_cast<std::ptrdiff_t>(row));
    }
    return codes;
}

std::vector<develop::LightGroup> light_groups_in(const sampledb::RunSet& runs) {
    return develop::light_groups_of(runs).value_or(std::vector<develop::LightGroup>{});
}

}  // namespace

Engine::Engine(EngineOptions options, std::unique_ptr<sampledb::RunSet> runs, std::string files)
    : options_(std::move(options)), cache_(memory_to_keep(options_)) {
    opened_.light_groups = light_groups_in(*runs);
    opened_.runs = std::move(runs);
    opened_.files = std::move(files);
}

Result<std::unique_ptr<Engine>> Engine::open(EngineOptions options) {
    std::string files = state_of_files(options.inputs);
    Result<std::unique_ptr<sampledb::RunSet>> runs = sampledb::RunSet::open(selection_of(options, sampledb::VerifyLevel::kHeaders));
    if (!runs) return runs.error();
    if ((*runs)->coverage().empty()) return Error{ErrorCode::kOutOfRange, "the files hold no samples"};
    return std::unique_ptr<Engine>(new Engine(std::move(options), std::move(*runs), std::move(files)));
}

std::shared_ptr<const sampledb::RunSet> Engine::runs() const { return opened().runs; }

Engine::Opened Engine::opened() const {
    const std::scoped_lock lock(mutex_);
    return opened_;
}

void Engine::use(std::unique_ptr<sampledb::RunSet> runs) {
    std::vector<develop::LightGroup> groups = light_groups_in(*runs);
    const std::scoped_lock lock(mutex_);
    if (runs->coverage() != opened_.runs->coverage()) ++opened_.generation;
    opened_.light_groups = std::move(groups);
    opened_.runs = std::move(runs);
}

bool Engine::look_again() {
    const std::scoped_lock looking(looking_);
    const Opened before = opened();
    std::string files = state_of_files(options_.inputs);
    if (files == before.files) return false;
    {
        const std::scoped_lock lock(mutex_);
        opened_.files = std::move(files);
    }
    Result<std::unique_ptr<sampledb::RunSet>> runs =
        sampledb::RunSet::open(selection_of(options_, sampledb::VerifyLevel::kHeaders));
    if (!runs || (*runs)->job().id != before.runs->job().id || !(*runs)->coverage().contains(before.runs->coverage())) return false;
    use(std::move(*runs));  // even of the same samples: files may have new names
    return opened().generation != before.generation;
}

std::optional<double> Engine::f_number() const {
    const std::shared_ptr<const sampledb::RunSet> all = runs();
    if (!develop::lens_columns(all->job())) return std::nullopt;
    const Result<develop::RecordedLens> lens = develop::recorded_lens(*all, "--aperture");
    return lens ? std::optional(lens->f_number()) : std::nullopt;
}

bool Engine::knows_shutter() const { return develop::place_of_fractions(runs()->job(), "shutter").has_value(); }

bool Engine::knows_depth() const { return develop::place_of(runs()->job(), "depth").has_value(); }

Result<double> Engine::distance(const develop::Size& size, int x, int y) const {
    const std::shared_ptr<const sampledb::RunSet> all = runs();
    const Result<develop::RecordedLens> lens = develop::recorded_lens(*all, "--focus");
    if (!lens) return lens.error();
    return develop::distance_at(*all, *lens, {static_cast<double>(x), static_cast<double>(y)}, size.width, size.height);
}

Result<develop::Size> Engine::size_of_width(std::uint32_t width) const {
    return develop::parse_size_on_film(std::to_string(width), runs()->job());
}

Result<Recipe> Engine::resolve(const Recipe& recipe, const ViewOptions& options) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    const develop::PictureOptions& picture = decisions->picture;
    const Result<develop::Size> of_print =
        picture.size.empty() ? default_size() : develop::parse_size_on_film(picture.size, runs()->job());
    if (!of_print) return of_print.error();
    if (picture.crop && develop::intersection(*picture.crop, pixels_of(whole(*of_print))) != *picture.crop)
        return usage_error(fmt::format("--crop: is not inside the picture of {} x {} pixels", of_print->width, of_print->height));
    Recipe resolved = recipe;
    convert::CodeValues codes;
    const Result<develop::Size> size = size_of_width(std::min(std::uint32_t{kBlock}, default_size().width));
    if (!size) return size.error();
    const bool chooses = decisions->print.chooses_exposure();
    // Developing and printing a pixel tells what is wrong with the rest.
    const Rect metered = chooses ? whole(*size) : Rect{0, 0, 1, 1};
    const Result<convert::ConvertReport> report = print(*decisions, *size, metered, metered, codes, options);
    if (!report) return report.error();
    if (!chooses) return resolved;
    Recipe& section = resolved["convert"];
    if (section.is_null()) section = Recipe::object();
    section.erase("auto");
    section.erase("key");
    section["sensitivity"] = report->auto_sigma.value_or(1);
    return resolved;
}

Result<convert::CodeValues> Engine::view(const Recipe& recipe, const develop::Size& size, const Rect& area,
                                         const ViewOptions& options) {
    Result<Decisions> decisions = decide(recipe);
    if (!decisions) return decisions.error();
    if (Status s = check_view(*decisions); !s) return s.error();
    if (area.empty() || !whole(size).contains(area))
        return usage_error(fmt::format("{},{},{},{}: is not inside the picture of {} x {} pixels", area.x0, area.y0, area.x1,
                                       area.y1, size.width, size.height));
    convert::CodeValues all;
    for (int y = area.y0, y_next = 0; y < area.y1; y = y_next) {
        for (int x = area.x0, x_next = 0; x < area.x1; x = x_next) {
            const Result<Rect> block = block_at(*decisions, size, x, y);
            if (!block) return block.error();
            const Rect part = image::intersect(*block, {x, y, area.x1, area.y1});
            x_next = part.x1, y_next = part.y1;
            convert::CodeValues codes;
            const Result<convert::ConvertReport> report = print(*decisions, size, *block, part, codes, options);
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

Result<Rect> Engine::block_at(const Decisions& decisions, const develop::Size& size, int x, int y) {
    const Rect all = whole(size);
    constexpr std::size_t kMostSpread = 16 * kSmall;
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

Status Engine::develop(const develop::PictureOptions& asked, const Stopped& stopped, develop::PictureSink& sink) {
    develop::PictureOptions options = asked;
    options.inputs = options_.inputs;
    options.memory = memory_to_develop(options_);
    options.threads = options_.threads;
    options.stopped = stopped;
    const Opened all = opened();
    Result<develop::PictureReport> report = develop::develop_picture(options, *all.runs, sink, {});
    if (!report && sampledb::is_unreadable(report.error())) {  // leaves out what is damaged, as latent-develop does
        Result<std::unique_ptr<sampledb::RunSet>> runs =
            sampledb::RunSet::open(selection_of(options_, sampledb::VerifyLevel::kOrdered));
        if (!runs) return runs.error();
        use(std::move(*runs));
        report = develop::develop_picture(options, *opened().runs, sink, {});
    }
    if (!report) return report.error();
    return {};
}

Result<Engine::Picture> Engine::kept_or_made(const std::string& name,
                                             const std::function<Status(KeptPicture&, const Stopped&)>& make,
                                             const Stopped& stopped) {
    const std::string key = fmt::format("{} {}", opened().generation, name);
    if (Picture kept = cache_.find(key)) return kept;
    const auto work = [this, key, make](const Stopped& given_up) -> Developing::Made {
        if (Picture kept = cache_.find(key)) return kept;
        auto picture = std::make_shared<KeptPicture>();
        if (Status s = make(*picture, given_up); !s) return s.error();
        cache_.keep(key, picture);
        return picture;
    };
    return developing_.wait_for(key, work, stopped);
}

Result<Engine::Picture> Engine::developed(const Decisions& decisions, const develop::Size& size, const Rect& block,
                                          const ViewOptions& options) {
    if (options.mixed && decisions.print.layer.empty() && !light_groups().empty())
        return mixed(decisions, size, block, options.stopped);
    const std::string key = fmt::format("{} {},{},{},{} {} {}", text_of(size), block.x0, block.y0, block.x1, block.y1,
                                        decisions.print.layer, decisions.of_light());
    const auto make = [this, picture = picture_of(decisions, size, block)](KeptPicture& made, const Stopped& stopped) -> Status {
        develop::UnnamedPicture file(File::create_in_memory);
        if (Status s = develop(picture, stopped, file); !s) return s;
        made.file = file.file();
        return {};
    };
    return kept_or_made(key, make, options.stopped);
}

Result<Engine::Picture> Engine::mixed(const Decisions& decisions, const develop::Size& size, const Rect& block,
                                      const Stopped& stopped) {
    std::vector<std::string> groups;
    for (const develop::LightGroup& group : light_groups()) groups.push_back(group.name);
    const Result<LightMix> mix = light_mix_of(decisions.recipe, groups);
    if (!mix) return mix.error();
    const Result<Decisions> of_layers = decide(mix->of_layers);
    if (!of_layers) return of_layers.error();
    develop::PictureOptions asked = picture_of(*of_layers, size, block);
    asked.layers.lights = true;
    const auto make = [this, asked](KeptPicture& made, const Stopped& given_up) { return develop(asked, given_up, made.linear); };
    const std::string place =
        fmt::format("{} {},{},{},{} {}", text_of(size), block.x0, block.y0, block.x1, block.y1, of_layers->of_light());
    const Result<Picture> layers = kept_or_made("lights " + place, make, stopped);
    if (!layers) return layers.error();
    const std::string key = fmt::format("{} mix {} {}", opened().generation, fmt::join(mix->factors, " "), place);
    if (Picture kept = cache_.find(key)) return kept;
    develop::UnnamedPicture sum(File::create_in_memory);
    if (Status s = add_up((*layers)->linear, groups, mix->factors, sum); !s) return s.error();
    auto picture = std::make_shared<KeptPicture>();
    picture->file = sum.file();
    cache_.keep(key, picture);
    return picture;
}

Result<convert::ConvertReport> Engine::print(const Decisions& decisions, const develop::Size& size, const Rect& block,
                                             const Rect& area, convert::CodeValues& codes, const ViewOptions& view) {
    const Result<Picture> picture = developed(decisions, size, block, view);
    if (!picture) return picture.error();
    convert::ConvertOptions options = decisions.print;
    options.input = options_.inputs.front();
    options.picture = (*picture)->file;
    options.codes = std::make_shared<convert::CodeValues>();
    options.stops.resize(1);
    const bool keeps = decisions.spreads_light() && block.pixels() <= kSmall;  // a part would cost as much as all of it
    options.crop = keeps ? block : area;
    options.paper_width_mm = 0;
    options.memory = memory_to_print(options_);
    options.threads = options_.threads;
    const std::string how = fmt::format("{} {}", options.show_clipped, decisions.recipe.dump(-1, ' ', true));
    const std::scoped_lock printing(printing_);
    if (is_true(view.stopped)) return given_up();
    if (!keeps || last_print_.of.lock() != *picture || last_print_.how != how) {
        Result<convert::ConvertReport> report = convert::convert(options, {});
        if (!report) return report.error();
        if (!keeps) {
            codes = std::move(*options.codes);
            return report;
        }
        last_print_ = {*picture, how, std::move(*options.codes), *std::move(report)};
    }
    assert(block.x0 == 0 && block.y0 == 0);
    codes = part_of(last_print_.codes, area);
    return last_print_.report;
}

}  // namespace latent::darkroom
