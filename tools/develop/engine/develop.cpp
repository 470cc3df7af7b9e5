#include "tools/develop/engine/develop.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <functional>
#include <optional>
#include <utility>

#include "base/in_order.h"
#include "base/size.h"
#include "tools/develop/engine/fireflies.h"
#include "tools/develop/engine/pane.h"
#include "tools/develop/engine/positive.h"
#include "tools/develop/engine/record_batch.h"
#include "tools/develop/engine/regions.h"
#include "tools/develop/engine/spot.h"

namespace latent::develop {

namespace {

using sampledb::FilmNode;
using sampledb::PageInfo;
using sampledb::RecordClass;

constexpr std::size_t kPagesAtOnce = 1 << 14;                // references to pages of a region that streams
constexpr std::uint64_t kMaxSlab = std::uint64_t{64} << 30;  // rows and segments of a batch are counted in 32 bits
constexpr std::uint64_t kLargePage = 2 << 20;                // touching the slab costs a fault for each
constexpr std::uint64_t kThreadBytes = 2 << 20;              // a decoded page and what the decoder holds

// Where all records are in memory, panes are no larger than this. Smaller ones share more tiles and sums with their neighbours,
// which costs more than the caches could save; larger ones gain nothing, and the system must clear their memory first.
constexpr std::uint64_t kMaxPane = 128 << 20;

// Records that the headers promise of the selected samples: their share of the run's.
struct ExpectedRecords {
    double camera = 0, light = 0;
};

ExpectedRecords expected_records(const sampledb::RunSet& run_set) {
    ExpectedRecords expected;
    for (const sampledb::SelectedRun& run : run_set.runs()) {
        const double share = static_cast<double>(run.coverage.size()) / static_cast<double>(run.header.sample_count);
        expected.camera += share * static_cast<double>(run.header.camera_records);
        expected.light += share * static_cast<double>(run.header.light_records);
    }
    return expected;
}

// A node of the film, no smaller than a cell, that is developed in one go.
struct Region {
    FilmNode node;
    PixelRect cells;  // those of the node that are needed
};

class Engine {
 public:
    Engine(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings, TileSink& sink)
        : run_set_(run_set),
          channels_(channels),
          settings_(settings),
          grid_(settings.width, settings.height, settings.filter.reach()),
          loader_(run_set, grid_, channels, settings.stopped),
          expected_(expected_records(run_set)),
          classes_{.camera = settings.camera && expected_.camera > 0,
                   .light = settings.light && expected_.light > 0 && run_set.light_paths() > 0},
          with_positive_(classes_.camera && settings.filter.kernel().has_negative_lobes),
          pane_(grid_, settings.filter.kernel(), channels.layout().entries(), classes_, fireflies()) {
        counts_.light_paths = run_set.light_paths();
        const double pixels = static_cast<double>(settings.width) * settings.height;
        // Samples without a camera record thin the density out.
        const double camera_density =
            std::min(static_cast<double>(run_set.coverage().size()), expected_.camera) / pixels * mean_weight();
        normalisation_ = {channels.layout(),
                          classes_.camera,
                          classes_.light,
                          camera_density,
                          classes_.light ? pixels / static_cast<double>(counts_.light_paths) : 0.0,
                          half_scales(run_set)};
        needed_ = grid_.cells_reaching(settings.crop);
        share_memory(sink);
    }

    Result<PlannedWork> planned_work() const {
        const Result<Plan> plan = make_plan();
        if (!plan) return plan.error();
        if (Status s = check_room(*plan); !s) return s.error();
        return PlannedWork{static_cast<double>(plan->stored_bytes()) * plan->decode_factor(slab_bytes_), plan->segments(),
                           plan->segments() * static_cast<double>(Loader::segment_bytes())};
    }

    Result<DevelopCounts> run(const Progress& progress) {
        const Result<Plan> plan = make_plan();
        if (!plan) return plan.error();
        plan_ = &*plan;
        counts_.pages = plan->pages();
        counts_.page_bytes = plan->stored_bytes();
        if (Status s = check_room(*plan); !s) return s.error();
        slab_.reset(
            static_cast<std::byte*>(std::aligned_alloc(kLargePage, (slab_bytes_ + kLargePage - 1) / kLargePage * kLargePage)));
        if (!slab_)
            return Error{ErrorCode::kOutOfRange,
                         fmt::format("--memory {}: more than the system can provide", format_size(settings_.memory))};
        ::madvise(slab_.get(), slab_bytes_ / kLargePage * kLargePage, MADV_HUGEPAGE);  // a hint: any answer will do
        progress_ = &progress;
        if (Status s = develop_node({}, {slab_.get(), slab_bytes_}, 0); !s) return s.error();
        if (progress) progress(1, "");
        return finished_counts();
    }

 private:
    struct Free {
        void operator()(std::byte* memory) const { std::free(memory); }
    };
    // Decoded records of a node's own pages, while its children are developed.
    struct Held {
        FilmNode node;
        RecordBatch batch;
    };

    Result<Plan> make_plan() const {
        const std::uint64_t positive_bytes = with_positive_ ? PositiveWindows::bytes(grid_, channels_.stride()) : 0;
        return Plan::make(run_set_, grid_, needed_, classes_, loader_, {pane_.cell_bytes(), positive_bytes});
    }

    Status check_room(const Plan& plan) const {
        const std::uint64_t least = plan.min_room();
        if (slab_bytes_ >= least) return {};
        return Error{ErrorCode::kOutOfRange, fmt::format("--memory: too small; {}M is enough", enough_for(least) >> 20)};
    }

    // Mean weight of records.
    double mean_weight() const { return channels_.lens() ? channels_.lens()->mean() : 1; }

    std::optional<Fireflies> fireflies() const {
        if (!settings_.dim_fireflies) return std::nullopt;
        assert(channels_.layout().layers.samples);
        const double pixels = static_cast<double>(settings_.width) * settings_.height;
        return Fireflies(grid_, settings_.filter.reach(), channels_.layout(), classes_,
                         static_cast<double>(run_set_.coverage().size()) / pixels * mean_weight());
    }

    // N over the samples of each half.
    std::array<double, 2> half_scales(const sampledb::RunSet& run_set) const {
        std::array<double, 2> scales{};
        const auto all = static_cast<double>(run_set.coverage().size());
        for (int half = 0; half < 2 && channels_.layout().layers.halves; ++half) {
            const std::uint64_t count = count_in_half(run_set.coverage(), half);
            if (count > 0) scales[static_cast<std::size_t>(half)] = all / static_cast<double>(count);
        }
        return scales;
    }

    // The budget: waiting sums and tiles, and the threads' own buffers; the rest is one slab for records and windows.
    void share_memory(TileSink& sink) {
        const std::uint64_t threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
        const std::uint64_t waiting = settings_.memory / 16;
        const std::uint64_t tile_bytes =
            sizeof(float) * TileSink::kTile * TileSink::kTile * static_cast<std::uint64_t>(channels_.layout().outputs());
        own_bytes_ = threads * (kThreadBytes + loader_.thread_bytes() + kPiecesPerThread * tile_bytes);
        slab_bytes_ = settings_.memory > waiting + own_bytes_ ? (settings_.memory - waiting - own_bytes_) / 64 * 64 : 0;
        slab_bytes_ = std::min(slab_bytes_, kMaxSlab);
        assembly_ = std::make_unique<Assembly>(grid_, settings_.filter, settings_.crop, normalisation_, settings_.temporary_folder,
                                               waiting, sink);
    }

    // Whole MiB of --memory with which the slab has `slab` bytes: 15/16 of Settings::memory go to it and the threads, and that is
    // what the list of runs, other indexes (1/8 at most) and the levels of a mip map (1/32) leave.
    std::uint64_t enough_for(std::uint64_t slab) const {
        const std::uint64_t memory = ((slab + own_bytes_ + 64) * 16 / 15 + settings_.list_memory) * 32 / 27;
        return std::max((memory + (2 << 20)) >> 20 << 20, sampledb::memory_with_list(settings_.list_memory));
    }

    // Develops a node in `room`. `missed`: see Plan::way.
    Status develop_node(const FilmNode& node, std::span<std::byte> room, std::uint64_t missed) {
        const PixelRect cells = plan_->cells(node);
        if (cells.empty()) return {};
        switch (plan_->way(node, room.size(), missed)) {
            case Way::kResident:
                return develop_resident({node, cells}, room);
            case Way::kStreaming:
                return develop_streaming({node, cells}, room);
            case Way::kSplit:
                break;
        }
        const bool holds = plan_->holds(node, room.size(), missed);
        if (holds) {
            if (Status s = hold_own_pages({node, cells}, room); !s) return s;
        } else {
            missed += plan_->own(node);
        }
        for (int i = 0; i < 4; ++i) {
            if (Status s = develop_node(child(node, i), room, missed); !s) return s;
        }
        if (holds) held_.pop_back();
        return {};
    }

    // Decodes the node's own pages off the front of `room`.
    Status hold_own_pages(const Region& region, std::span<std::byte>& room) {
        std::vector<PageRef> pages;
        const auto own = [&](const PageInfo& page) {
            const PageReach reach = loader_.reach(page);
            return reach.node == region.node && !intersection(reach.cells, region.cells).empty();
        };
        if (Status s = append_pages(own, pages); !s) return s;
        std::span<const PageRef> rest = pages;
        Result<RecordBatch> batch = load(rest, region.cells, room);
        if (!batch) return batch.error();
        assert(rest.empty());
        held_.push_back({region.node, *batch});
        return {};
    }

    // Pages that reach into a region and are not in memory yet.
    auto reaching(const Region& region) const {
        return [this, region](const PageInfo& page) {
            const PageReach reach = loader_.reach(page);
            return !intersection(reach.cells, region.cells).empty() &&
                   std::ranges::find(held_, reach.node, &Held::node) == held_.end();
        };
    }
    // Camera pages that reach some cells of a region, given by their numbers in it, and are not in memory yet.
    auto reaching_some(const Region& region, std::span<const std::size_t> cells) const {
        return [this, region, cells, pages = reaching(region)](const PageInfo& page) {
            if (page.record_class != RecordClass::kCamera || !pages(page)) return false;
            const PixelRect reached = loader_.reach(page).cells;
            return std::ranges::any_of(cells, [&](std::size_t cell) {
                const std::int64_t x = region.cells.x0 + static_cast<std::int64_t>(cell) % region.cells.width();
                const std::int64_t y = region.cells.y0 + static_cast<std::int64_t>(cell) / region.cells.width();
                return !intersection(reached, {x, y, x + 1, y + 1}).empty();
            });
        };
    }

    // Appends the pages of a run, or of all, that are `wanted`, in their order.
    template <class Wanted>
    Status append_pages(std::size_t run, const Wanted& wanted, std::vector<PageRef>& found) const {
        const auto pages = run_set_.pages(run);
        if (!pages) return pages.error();
        for (std::uint32_t i = 0; i < (*pages)->size(); ++i) {  // a few nanoseconds each; a page itself takes some hundred thousand
            const PageInfo& page = (**pages)[i];
            if (classes_.has(page.record_class) && wanted(page))
                found.push_back({static_cast<std::uint32_t>(run), page_order(run, i), page});
        }
        return {};
    }
    template <class Wanted>
    Status append_pages(const Wanted& wanted, std::vector<PageRef>& found) const {
        for (std::size_t run = 0; run < run_set_.runs().size(); ++run) {
            if (Status s = append_pages(run, wanted, found); !s) return s;
        }
        return {};
    }
    // A batch and all that is held.
    std::vector<const RecordBatch*> with_held(const RecordBatch& batch) const {
        std::vector<const RecordBatch*> batches = {&batch};
        for (const Held& held : held_) batches.push_back(&held.batch);
        return batches;
    }

    // All records at once, the windows of a pane at a time.
    Status develop_resident(const Region& region, std::span<std::byte> room) {
        std::vector<PageRef> pages;
        if (Status s = append_pages(reaching(region), pages); !s) return s;
        std::span<const PageRef> rest = pages;
        const Result<RecordBatch> batch = load(rest, region.cells, room);
        if (!batch) return batch.error();
        assert(rest.empty());
        show(region, 0.5);
        if (Status s = develop_panes(region, region.node, with_held(*batch), room); !s) return s;
        return finish_region(region);
    }

    Status develop_panes(const Region& region, const FilmNode& node, std::span<const RecordBatch* const> batches,
                         std::span<std::byte> room) {
        const PixelRect cells = intersection(grid_.cells_of(node), region.cells);
        if (cells.empty()) return {};
        if (pane_.bytes(cells) > std::min<std::uint64_t>(room.size(), kMaxPane) && node.level < grid_.level()) {
            for (int i = 0; i < 4; ++i) {
                if (Status s = develop_panes(region, child(node, i), batches, room); !s) return s;
            }
            return {};
        }
        begin_pane(cells, room);
        if (Fireflies* fireflies = pane_.fireflies()) {
            fireflies->look_at(batches, {});
            fireflies->decide();
        }
        pane_.add_records(batches, {}, settings_.stopped);
        if (is_true(settings_.stopped)) return given_up();
        count_dimmed();
        return finish_pane(
            node, PositiveFromRecords(grid_, settings_.filter.kernel(), channels_.layout().entries(), pane_.fireflies(), batches));
    }

    Status develop_streaming(const Region& region, std::span<std::byte> room) {
        const Result<bool> done = stream(region, room);
        if (!done) return done.error();
        if (*done) return finish_region(region);
        const bool was_counting = std::exchange(counting_, false);
        for (int i = 0; i < 4; ++i) {
            const FilmNode part = child(region.node, i);
            const PixelRect cells = intersection(grid_.cells_of(part), region.cells);
            if (cells.empty()) continue;
            if (Status s = develop_streaming({part, cells}, room); !s) return s;
        }
        counting_ = was_counting;
        return {};
    }

    // The windows of all cells at once, the records a batch at a time. Cells that turn out to have pixels of few samples need their
    // records a second time; false if there is no room for their windows.
    Result<bool> stream(const Region& region, std::span<std::byte> room) {
        const int stride = channels_.stride();
        const auto take = [&room](std::uint64_t bytes) {
            const std::span<std::byte> taken = room.last(bytes);
            room = room.first(room.size() - bytes);
            return taken;
        };
        begin_pane(region.cells, take(pane_.bytes(region.cells)));
        const bool was_counting = counting_;
        if (Fireflies* fireflies = pane_.fireflies()) {  // a pass of its own: limits are known only after all records
            const auto look_at = [&](const RecordBatch& batch, const PageRange& range) {
                fireflies->look_at(with_held(batch), range);
            };
            if (Status s = pass(region, reaching(region), room, look_at); !s) return s.error();
            fireflies->decide();
            counting_ = false;
        }
        PositiveWindows positive(grid_, settings_.filter.kernel(), channels_.layout().entries(), pane_.fireflies(), region.cells);
        if (with_positive_) positive.open_border(take(PositiveWindows::border_bytes(grid_, stride, region.cells)));
        const auto add = [&](const RecordBatch& batch, const PageRange& range) {
            const std::vector<const RecordBatch*> batches = with_held(batch);
            pane_.add_records(batches, range, settings_.stopped);
            if (with_positive_) positive.add_records(batches, range);
        };
        if (Status s = pass(region, reaching(region), room, add); !s) return s.error();
        counting_ = was_counting;
        count_dimmed();
        const std::vector<std::size_t> few =
            with_positive_ ? assembly_->cells_of_few_samples(pane_.windows()) : std::vector<std::size_t>();
        if (!few.empty()) {
            const std::uint64_t bytes = positive.bytes_beside(few);
            if (bytes + plan_->min_batch() + Loader::index_bytes(region.cells) > room.size()) return false;
            positive.open(few, take(bytes));
            counting_ = false;
            const auto add_positive = [&](const RecordBatch& batch, const PageRange& range) {
                positive.add_records(with_held(batch), range);
            };
            if (Status s = pass(region, reaching_some(region, few), room, add_positive); !s) return s.error();
            counting_ = was_counting;
        }
        if (Status s = finish_pane(region.node, positive); !s) return s.error();
        return true;
    }

    // Loads the pages that are `wanted` a batch at a time, and has each batch added.
    template <class Wanted, class Add>
    Status pass(const Region& region, const Wanted& wanted, std::span<std::byte> room, const Add& add) {
        std::vector<PageRef> pages;
        PageRange range{0, 0};
        for (std::size_t run = 0; run < run_set_.runs().size();) {
            pages.clear();
            for (; run < run_set_.runs().size() && pages.size() < kPagesAtOnce; ++run) {
                if (Status s = append_pages(run, wanted, pages); !s) return s;
            }
            std::span<const PageRef> rest = pages;
            do {
                std::span<std::byte> records = room;
                const Result<RecordBatch> batch = load(rest, region.cells, records);
                if (!batch) return batch.error();
                range = {range.end, rest.empty() ? page_order(run, 0) : rest.front().order};
                add(*batch, range);
                if (is_true(settings_.stopped)) return given_up();
            } while (!rest.empty());
            show(region, static_cast<double>(run) / static_cast<double>(run_set_.runs().size()));
        }
        return {};
    }

    Result<RecordBatch> load(std::span<const PageRef>& pages, const PixelRect& cells, std::span<std::byte>& memory) {
        ++counts_.batches;
        return loader_.load(pages, cells, memory, counting_);
    }

    void show(const Region& region, double part) const {
        if (!*progress_) return;
        const auto area = [](const PixelRect& cells) { return static_cast<double>(cells.width() * cells.height()); };
        (*progress_)((cells_done_ + part * area(region.cells)) / area(needed_),
                     fmt::format("{} read", format_size(run_set_.bytes_read())));
    }
    Status finish_region(const Region& region) {
        ++counts_.regions;
        cells_done_ += static_cast<double>(region.cells.width() * region.cells.height());
        return {};
    }

    void begin_pane(const PixelRect& cells, std::span<std::byte> memory) {
        pane_.begin(cells, memory);
        ++counts_.panes;
    }
    void count_dimmed() {
        if (!counting_) return;
        counts_.camera_dimmed += pane_.dimmed(RecordClass::kCamera);
        counts_.light_dimmed += pane_.dimmed(RecordClass::kLight);
    }
    Status finish_pane(const FilmNode& node, const PositiveSums& positive) {
        const ZRange range = z_range(grid_, node);
        return assembly_->add(pane_.windows(), positive, range.begin, range.end);
    }

    DevelopCounts finished_counts() const {
        DevelopCounts counts = counts_;
        const DecodeCounts& decoded = loader_.counts();
        counts.pages_decoded = decoded.pages;
        counts.page_bytes_decoded = decoded.bytes;
        counts.segments = decoded.segments;
        counts.camera_records = decoded.camera_records;
        counts.light_records = decoded.light_records;
        counts.camera_not_finite = decoded.camera_not_finite;
        counts.light_not_finite = decoded.light_not_finite;
        counts.fallback_pixels = assembly_->counts().fallback;
        counts.empty_pixels = assembly_->counts().empty;
        counts.temporary_bytes = assembly_->bytes_on_disk();
        return counts;
    }

    const sampledb::RunSet& run_set_;
    const Channels& channels_;
    const Settings& settings_;
    FilmGrid grid_;
    Loader loader_;
    DevelopCounts counts_;
    const ExpectedRecords expected_;
    const Classes classes_;
    const bool with_positive_;  // pixels of few samples are weighed by another filter
    Pane pane_;
    Normalisation normalisation_;
    PixelRect needed_;  // cells
    const Plan* plan_ = nullptr;
    const Progress* progress_ = nullptr;
    double cells_done_ = 0;
    bool counting_ = true;  // records that are loaded are not known yet
    std::uint64_t slab_bytes_ = 0, own_bytes_ = 0;
    std::unique_ptr<std::byte, Free> slab_;
    std::vector<Held> held_;
    std::unique_ptr<Assembly> assembly_;
};

// What a crop needs of all records. Fireflies are found among those of whole cells, and a lens may move records into the crop.
std::optional<Spot> spot_of(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings) {
    const PixelRect& crop = settings.crop;
    const bool is_whole = crop == PixelRect{0, 0, settings.width, settings.height};
    if (is_whole || settings.dim_fireflies || (channels.lens() && channels.lens()->moves_records())) return std::nullopt;
    const int reach = settings.filter.reach();
    return std::optional<Spot>(std::in_place, run_set,
                               PositionRect{positions_reaching(crop.x0, crop.x1, settings.width, reach),
                                            positions_reaching(crop.y0, crop.y1, settings.height, reach)});
}

}  // namespace

Result<DevelopCounts> develop(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings, TileSink& sink,
                              const Progress& progress) {
    const std::optional<Spot> spot = spot_of(run_set, channels, settings);
    return Engine(spot ? *spot : run_set, channels, settings, sink).run(progress);
}

Result<PlannedWork> planned_work(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings) {
    class NoSink final : public TileSink {
        Status write(int, int, std::span<const float>) override { return {}; }
    } none;
    const std::optional<Spot> spot = spot_of(run_set, channels, settings);
    return Engine(spot ? *spot : run_set, channels, settings, none).planned_work();
}

}  // namespace latent::develop
