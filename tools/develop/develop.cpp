#include "tools/develop/develop.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <functional>

#include "base/size.h"
#include "tools/develop/batch.h"
#include "tools/develop/regions.h"

namespace latent::develop {

namespace {

using sampledb::FilmNode;
using sampledb::PageInfo;
using sampledb::RecordClass;

constexpr std::size_t kPagesAtOnce = 1 << 14;                 // references to pages of a region that streams
constexpr std::uint64_t kMostSlab = std::uint64_t{64} << 30;  // rows and segments of a batch are counted in 32 bits
constexpr std::uint64_t kThreadBytes = 2 << 20;               // a decoded page and what the decoder holds

// Records that the headers promise of the selected samples: their share of the run's.
struct ExpectedRecords {
    double camera = 0, light = 0;
};

ExpectedRecords expected_records(const sampledb::Gathering& gathering) {
    ExpectedRecords expected;
    for (const sampledb::SelectedRun& run : gathering.runs()) {
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
    Engine(const sampledb::Gathering& gathering, const Channels& channels, const Settings& settings, TileSink& sink)
        : gathering_(gathering),
          channels_(channels),
          settings_(settings),
          grid_(settings.width, settings.height, settings.filter.reach()),
          loader_(gathering, grid_, channels) {
        const ExpectedRecords expected = expected_records(gathering);
        counts_.light_paths = gathering.light_paths();
        classes_ = {.camera = settings.camera && expected.camera > 0,
                    .light = settings.light && expected.light > 0 && counts_.light_paths > 0};
        camera_ = {channels.lanes(), settings.filter.kernel().has_negative_lobes};
        light_ = {channels.lanes(), false};
        const double pixels = static_cast<double>(settings.width) * settings.height;
        // Samples without a camera record thin the density out.
        const double camera_density = std::min(static_cast<double>(gathering.coverage().size()), expected.camera) / pixels;
        normalisation_ = {channels.count(), classes_.camera, classes_.light, camera_density,
                          classes_.light ? pixels / static_cast<double>(counts_.light_paths) : 0.0};
        needed_ = grid_.cells_reaching(settings.crop);
        share_memory(sink);
    }

    Result<DevelopCounts> run(const Progress& progress) {
        const Result<Plan> plan = Plan::make(gathering_, grid_, needed_, classes_, loader_, window_bytes_);
        if (!plan) return plan.error();
        plan_ = &*plan;
        counts_.pages = plan->pages();
        counts_.page_bytes = plan->stored_bytes();
        if (const std::uint64_t least = plan->least_batch() + window_bytes_; slab_bytes_ < least)
            return Error{ErrorCode::kOutOfRange, fmt::format("--memory: too small; {}M is enough", enough_for(least) >> 20)};
        slab_.reset(static_cast<std::byte*>(std::aligned_alloc(64, slab_bytes_)));
        if (!slab_)
            return Error{ErrorCode::kOutOfRange, fmt::format("--memory {}: the system has less", format_size(settings_.memory))};
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
        Batch batch;
    };

    // The budget: waiting blocks and the threads' own buffers; the rest is one slab for records and windows.
    void share_memory(TileSink& sink) {
        const std::uint64_t threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
        const std::uint64_t waiting = settings_.memory / 16;
        const std::uint64_t tile_bytes =
            sizeof(float) * TileSink::kTile * TileSink::kTile * static_cast<std::uint64_t>(channels_.count());
        own_bytes_ = threads * (kThreadBytes + Assembly::kTilesPerThread * tile_bytes);
        slab_bytes_ = settings_.memory > waiting + own_bytes_ ? (settings_.memory - waiting - own_bytes_) / 64 * 64 : 0;
        slab_bytes_ = std::min(slab_bytes_, kMostSlab);
        window_bytes_ = static_cast<std::uint64_t>(grid_.window_width() * grid_.window_height()) * pixel_doubles() * sizeof(double);
        window_bytes_ = (window_bytes_ + 63) / 64 * 64;
        assembly_ = std::make_unique<Assembly>(grid_, settings_.filter, settings_.crop, camera_, light_, normalisation_,
                                               settings_.temporary_folder, waiting, sink);
    }

    // Whole MiB of --memory with which the slab has `slab` bytes: 15/16 of Settings::memory go to it and the threads, and that is
    // what indexes (1/8 at most) and the levels of a mip map (1/32) leave.
    std::uint64_t enough_for(std::uint64_t slab) const {
        const std::uint64_t memory = (slab + own_bytes_ + 64) * 16 / 15 * 32 / 27;
        return (memory + (2 << 20)) >> 20 << 20;
    }

    std::uint64_t pixel_doubles() const {
        return (classes_.camera ? static_cast<std::uint64_t>(camera_.doubles()) : 0) +
               (classes_.light ? static_cast<std::uint64_t>(light_.doubles()) : 0);
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
        const auto own = [&](const PageInfo& page) { return page.node == region.node; };
        if (Status s = append_pages(own, pages); !s) return s;
        std::span<const PageRef> rest = pages;
        Result<Batch> batch = load(rest, region.cells, room);
        if (!batch) return batch.error();
        assert(rest.empty());
        held_.push_back({region.node, *batch});
        return {};
    }

    // Pages that reach into a region and are not in memory yet.
    auto reaching(const Region& region) const {
        return [this, region](const PageInfo& page) {
            return !intersection(grid_.cells_of(page.node), region.cells).empty() &&
                   std::ranges::find(held_, page.node, &Held::node) == held_.end();
        };
    }
    // Appends the pages of a run, or of all, that are `wanted`, in their order.
    template <class Wanted>
    Status append_pages(std::size_t run, const Wanted& wanted, std::vector<PageRef>& found) const {
        const auto pages = gathering_.pages(run);
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
        for (std::size_t run = 0; run < gathering_.runs().size(); ++run) {
            if (Status s = append_pages(run, wanted, found); !s) return s;
        }
        return {};
    }

    // All records at once, the windows of a pane at a time.
    Status develop_resident(const Region& region, std::span<std::byte> room) {
        std::vector<PageRef> pages;
        if (Status s = append_pages(reaching(region), pages); !s) return s;
        std::span<const PageRef> rest = pages;
        const Result<Batch> batch = load(rest, region.cells, room);
        if (!batch) return batch.error();
        assert(rest.empty());
        show(region, 0.5);
        windows_ = room;
        if (Status s = develop_panes(region, region.node, *batch); !s) return s;
        return finish_region(region);
    }

    Status develop_panes(const Region& region, const FilmNode& node, const Batch& batch) {
        const PixelRect cells = intersection(grid_.cells_of(node), region.cells);
        if (cells.empty()) return {};
        if (static_cast<std::uint64_t>(cells.width() * cells.height()) * window_bytes_ > windows_.size() &&
            node.level < grid_.level()) {
            for (int i = 0; i < 4; ++i) {
                if (Status s = develop_panes(region, child(node, i), batch); !s) return s;
            }
            return {};
        }
        begin_pane(cells);
        add_records(batch, {});
        return finish_pane(node);
    }

    // The windows of all cells at once, the records a batch at a time.
    Status develop_streaming(const Region& region, std::span<std::byte> room) {
        const std::uint64_t windows = static_cast<std::uint64_t>(region.cells.width() * region.cells.height()) * window_bytes_;
        windows_ = room.last(windows);
        begin_pane(region.cells);
        std::vector<PageRef> pages;
        PageRange range{0, 0};
        for (std::size_t run = 0; run < gathering_.runs().size();) {
            pages.clear();
            for (; run < gathering_.runs().size() && pages.size() < kPagesAtOnce; ++run) {
                if (Status s = append_pages(run, reaching(region), pages); !s) return s;
            }
            std::span<const PageRef> rest = pages;
            do {
                std::span<std::byte> records = room.first(room.size() - windows);
                const Result<Batch> batch = load(rest, region.cells, records);
                if (!batch) return batch.error();
                range = {range.end, rest.empty() ? page_order(run, 0) : rest.front().order};
                add_records(*batch, range);
            } while (!rest.empty());
            show(region, static_cast<double>(run) / static_cast<double>(gathering_.runs().size()));
        }
        if (Status s = finish_pane(region.node); !s) return s;
        return finish_region(region);
    }

    Result<Batch> load(std::span<const PageRef>& pages, const PixelRect& cells, std::span<std::byte>& memory) {
        ++counts_.batches;
        return loader_.load(pages, cells, memory);
    }

    void show(const Region& region, double part) const {
        if (!*progress_) return;
        const auto area = [](const PixelRect& cells) { return static_cast<double>(cells.width() * cells.height()); };
        (*progress_)((cells_done_ + part * area(region.cells)) / area(needed_),
                     fmt::format("{} read", format_size(gathering_.bytes_read())));
    }
    Status finish_region(const Region& region) {
        ++counts_.regions;
        cells_done_ += static_cast<double>(region.cells.width() * region.cells.height());
        return {};
    }

    void begin_pane(const PixelRect& cells) {
        pane_ = {cells, std::vector<Windows::Cell>(static_cast<std::size_t>(cells.width() * cells.height()))};
        ++counts_.panes;
    }

    // Adds the records of a batch, and those held of the pages in `range`, to the windows of the pane, cell by cell.
    void add_records(const Batch& batch, const PageRange& range) {
        std::vector<const Batch*> batches = {&batch};
        for (const Held& held : held_) batches.push_back(&held.batch);
        tbb::parallel_for(std::size_t{0}, pane_.of.size(), [&](std::size_t i) {
            const std::int64_t x = pane_.cells.x0 + static_cast<std::int64_t>(i) % pane_.cells.width();
            const std::int64_t y = pane_.cells.y0 + static_cast<std::int64_t>(i) / pane_.cells.width();
            const PixelRect window = grid_.window(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            const auto pixels = static_cast<std::size_t>(window.width() * window.height());
            thread_local std::vector<Stretch> stretches;
            const auto add = [&](RecordClass record_class, const PixelSums& layout, bool unit_sum, double* sums,
                                 const double*& used) {
                segments_in_order(batches, range, x, y, record_class, stretches);
                if (stretches.empty()) return;
                if (!used) std::fill_n(sums, pixels * layout.doubles(), 0.0);
                used = sums;
                for (const Stretch& stretch : stretches) {
                    splat(settings_.filter.kernel(), layout, unit_sum, stretch.batch->columns, stretch.segments, sums,
                          static_cast<std::size_t>(window.width()));
                }
            };
            auto* const camera = reinterpret_cast<double*>(windows_.data() + i * window_bytes_);
            double* const light = camera + (classes_.camera ? pixels * camera_.doubles() : 0);
            add(RecordClass::kCamera, camera_, false, camera, pane_.of[i].camera);
            add(RecordClass::kLight, light_, true, light, pane_.of[i].light);
        });
    }

    Status finish_pane(const FilmNode& node) {
        const ZRange range = z_range(grid_, node);
        return assembly_->add(pane_, range.begin, range.end);
    }

    DevelopCounts finished_counts() const {
        DevelopCounts counts = counts_;
        const DecodeCounts& decoded = loader_.counts();
        counts.pages_decoded = decoded.pages;
        counts.page_bytes_decoded = decoded.bytes;
        counts.camera_records = decoded.camera_records;
        counts.light_records = decoded.light_records;
        counts.camera_not_finite = decoded.camera_not_finite;
        counts.light_not_finite = decoded.light_not_finite;
        counts.fallback_pixels = assembly_->counts().fallback;
        counts.empty_pixels = assembly_->counts().empty;
        counts.temporary_bytes = assembly_->bytes_on_disk();
        return counts;
    }

    const sampledb::Gathering& gathering_;
    const Channels& channels_;
    const Settings& settings_;
    FilmGrid grid_;
    Loader loader_;
    DevelopCounts counts_;
    Classes classes_;
    PixelSums camera_, light_;
    Normalisation normalisation_;
    PixelRect needed_;  // cells
    const Plan* plan_ = nullptr;
    const Progress* progress_ = nullptr;
    double cells_done_ = 0;
    std::uint64_t slab_bytes_ = 0, own_bytes_ = 0, window_bytes_ = 0;
    std::unique_ptr<std::byte, Free> slab_;
    std::vector<Held> held_;
    std::span<std::byte> windows_;
    std::unique_ptr<Assembly> assembly_;
    Windows pane_;
};

}  // namespace

Result<DevelopCounts> develop(const sampledb::Gathering& gathering, const Channels& channels, const Settings& settings,
                              TileSink& sink, const Progress& progress) {
    return Engine(gathering, channels, settings, sink).run(progress);
}

}  // namespace latent::develop
