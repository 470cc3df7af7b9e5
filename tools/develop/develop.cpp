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

using sampledb::RecordClass;

constexpr std::size_t kPagesAtOnce = 1 << 14;    // references to pages of a region that streams
constexpr std::size_t kLeastBatch = 8 << 20;     // bytes
constexpr std::uint64_t kThreadBytes = 2 << 20;  // a decoded page and what the decoder holds

struct RecordCounts {
    std::uint64_t camera = 0, light = 0;
};

// Records of the selected samples. Runs that are taken whole know theirs; of the others, two at most in merged files, the sample
// numbers are read.
Result<RecordCounts> count_records(const sampledb::Gathering& gathering) {
    RecordCounts counts;
    sampledb::Page page;
    const sampledb::ColumnSet numbers{.samples = true, .positions = false, .values = false, .share = false, .extra = false};
    for (std::size_t i = 0; i < gathering.runs().size(); ++i) {
        const sampledb::SelectedRun& run = gathering.runs()[i];
        if (!run.cut) {
            counts.camera += run.header.camera_records;
            counts.light += run.header.light_records;
            continue;
        }
        const auto pages = gathering.pages(i);
        if (!pages) return pages.error();
        for (const sampledb::PageInfo& info : **pages) {
            if (Status s = gathering.read_page(i, info, numbers, page); !s) return s.error();
            (info.record_class == RecordClass::kCamera ? counts.camera : counts.light) += page.count;
        }
    }
    return counts;
}

class Engine {
 public:
    Engine(const sampledb::Gathering& gathering, const RecordCounts& records, const Channels& channels, const Settings& settings,
           TileSink& sink)
        : gathering_(gathering),
          channels_(channels),
          settings_(settings),
          grid_(settings.width, settings.height, settings.filter.reach()) {
        counts_.camera_records = records.camera;
        counts_.light_records = records.light;
        counts_.light_paths = gathering.light_paths();
        classes_ = {.camera = settings.camera && counts_.camera_records > 0,
                    .light = settings.light && counts_.light_records > 0 && counts_.light_paths > 0};
        camera_ = {channels.lanes(), settings.filter.kernel().has_negative_lobes};
        light_ = {channels.lanes(), false};
        const double pixels = static_cast<double>(settings.width) * settings.height;
        // Samples without a camera record thin the density out.
        const double camera_density = static_cast<double>(std::min(gathering.coverage().size(), records.camera)) / pixels;
        normalisation_ = {channels.count(), classes_.camera, classes_.light, camera_density,
                          classes_.light ? pixels / static_cast<double>(counts_.light_paths) : 0.0};
        needed_ = grid_.cells_reaching(settings.crop);
        share_memory(sink);
    }

    Result<DevelopCounts> run(const Progress& progress) {
        if (slab_bytes_ < kLeastBatch + window_bytes_) {
            return Error{ErrorCode::kOutOfRange,
                         fmt::format("--memory {}: too small; give at least {}", format_size(settings_.memory),
                                     format_size(settings_.memory - slab_bytes_ + kLeastBatch + window_bytes_))};
        }
        slab_.reset(static_cast<std::byte*>(std::aligned_alloc(64, slab_bytes_)));
        if (!slab_)
            return Error{ErrorCode::kOutOfRange, fmt::format("--memory {}: the system has less", format_size(settings_.memory))};

        const std::uint64_t resident = std::max<std::uint64_t>(slab_bytes_ / 8 * 5, kLeastBatch);
        const RegionLimits limits{window_bytes_, std::min(resident, slab_bytes_ - window_bytes_),
                                  std::min(slab_bytes_ / 4 * 3, slab_bytes_ - kLeastBatch)};
        const Result<std::vector<Region>> regions = plan_regions(gathering_, grid_, needed_, classes_, *batch_, limits);
        if (!regions) return regions.error();
        for (const Region& region : *regions) {
            const auto show = [&](double part) {
                const double done = (static_cast<double>(counts_.regions) + part) / static_cast<double>(regions->size());
                if (progress) progress(done, fmt::format("{} read", format_size(gathering_.bytes_read())));
            };
            Status s = region.resident ? develop_resident(region, limits.resident_bytes, show) : develop_streaming(region, show);
            if (!s) return s.error();
            ++counts_.regions;
            batch_->forget_before(z_range(grid_, region.node).end);
        }
        if (progress) progress(1, "");
        return finished_counts();
    }

 private:
    struct Free {
        void operator()(std::byte* memory) const { std::free(memory); }
    };

    // The budget: waiting blocks, pages carried from region to region, the threads' own buffers; the rest is one slab for records
    // and windows.
    void share_memory(TileSink& sink) {
        const std::uint64_t threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
        const std::uint64_t carry = settings_.memory / 8, waiting = settings_.memory / 16;
        const std::uint64_t tile_bytes =
            sizeof(float) * TileSink::kTile * TileSink::kTile * static_cast<std::uint64_t>(channels_.count());
        const std::uint64_t own = threads * (kThreadBytes + Assembly::kTilesPerThread * tile_bytes);
        slab_bytes_ = settings_.memory > carry + waiting + own ? (settings_.memory - carry - waiting - own) / 64 * 64 : 0;
        window_bytes_ = static_cast<std::uint64_t>(grid_.window_width() * grid_.window_height()) * pixel_doubles() * sizeof(double);
        window_bytes_ = (window_bytes_ + 63) / 64 * 64;
        batch_ = std::make_unique<Batch>(gathering_, grid_, channels_, carry);
        assembly_ = std::make_unique<Assembly>(grid_, settings_.filter, settings_.crop, camera_, light_, normalisation_,
                                               settings_.temporary_folder, waiting, sink);
    }

    std::uint64_t pixel_doubles() const {
        return (classes_.camera ? static_cast<std::uint64_t>(camera_.doubles()) : 0) +
               (classes_.light ? static_cast<std::uint64_t>(light_.doubles()) : 0);
    }

    using ShowPart = std::function<void(double part_of_region)>;

    // All records at once, the windows of a pane at a time.
    Status develop_resident(const Region& region, std::uint64_t record_room, const ShowPart& show) {
        std::vector<PageRef> pages;
        for (std::size_t run = 0; run < gathering_.runs().size(); ++run) {
            if (Status s = append_pages(gathering_, grid_, region, classes_, run, pages); !s) return s;
        }
        count(pages, region);
        std::span<const PageRef> rest = pages;
        if (Status s = load(region, rest, {slab_.get(), record_room}); !s) return s;
        assert(rest.empty());
        show(0.5);
        windows_ = std::span(slab_.get() + record_room, slab_bytes_ - record_room);
        return develop_panes(region, region.node);
    }

    Status develop_panes(const Region& region, const sampledb::FilmNode& node) {
        const PixelRect cells = intersection(grid_.cells_of(node), region.cells);
        if (cells.empty()) return {};
        if (static_cast<std::uint64_t>(cells.width() * cells.height()) * window_bytes_ > windows_.size() &&
            node.level < grid_.level()) {
            for (int i = 0; i < 4; ++i) {
                if (Status s = develop_panes(region, child(node, i)); !s) return s;
            }
            return {};
        }
        begin_pane(cells);
        add_batch();
        return finish_pane(node);
    }

    // The windows of all cells at once, the records a batch at a time.
    Status develop_streaming(const Region& region, const ShowPart& show) {
        const std::uint64_t windows = static_cast<std::uint64_t>(region.cells.width() * region.cells.height()) * window_bytes_;
        windows_ = std::span(slab_.get() + (slab_bytes_ - windows), windows);
        begin_pane(region.cells);
        std::vector<PageRef> pages;
        for (std::size_t run = 0; run < gathering_.runs().size();) {
            pages.clear();
            for (; run < gathering_.runs().size() && pages.size() < kPagesAtOnce; ++run) {
                if (Status s = append_pages(gathering_, grid_, region, classes_, run, pages); !s) return s;
            }
            count(pages, region);
            for (std::span<const PageRef> rest = pages; !rest.empty();) {
                if (Status s = load(region, rest, {slab_.get(), slab_bytes_ - windows}); !s) return s;
                add_batch();
                show(static_cast<double>(run) / static_cast<double>(gathering_.runs().size()));
            }
        }
        return finish_pane(region.node);
    }

    // Takes the pages that fit off the front of `pages`.
    Status load(const Region& region, std::span<const PageRef>& pages, std::span<std::byte> memory) {
        const Result<std::size_t> taken = batch_->load(pages, memory, region.cells, needed_, z_range(grid_, region.node).end);
        if (!taken) return taken.error();
        pages = pages.subspan(*taken);
        ++counts_.batches;
        return {};
    }

    void begin_pane(const PixelRect& cells) {
        pane_ = {cells, std::vector<Windows::Cell>(static_cast<std::size_t>(cells.width() * cells.height()))};
        ++counts_.panes;
    }

    // Adds the records of the batch to the windows of the pane, cell by cell.
    void add_batch() {
        tbb::parallel_for(std::size_t{0}, pane_.of.size(), [&](std::size_t i) {
            const std::int64_t x = pane_.cells.x0 + static_cast<std::int64_t>(i) % pane_.cells.width();
            const std::int64_t y = pane_.cells.y0 + static_cast<std::int64_t>(i) / pane_.cells.width();
            const PixelRect window = grid_.window(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            const auto pixels = static_cast<std::size_t>(window.width() * window.height());
            auto* const camera = reinterpret_cast<double*>(windows_.data() + i * window_bytes_);
            double* const light = camera + (classes_.camera ? pixels * camera_.doubles() : 0);
            add_records(batch_->segments(x, y, RecordClass::kCamera), camera_, false, camera, pixels, window, pane_.of[i].camera);
            add_records(batch_->segments(x, y, RecordClass::kLight), light_, true, light, pixels, window, pane_.of[i].light);
        });
    }

    void add_records(std::span<const Segment> segments, const PixelSums& layout, bool unit_sum, double* sums, std::size_t pixels,
                     const PixelRect& window, const double*& used) const {
        if (segments.empty()) return;
        if (!used) std::fill_n(sums, pixels * layout.doubles(), 0.0);
        used = sums;
        splat(settings_.filter.kernel(), layout, unit_sum, batch_->columns(), segments, sums,
              static_cast<std::size_t>(window.width()));
    }

    Status finish_pane(const sampledb::FilmNode& node) {
        const ZRange range = z_range(grid_, node);
        return assembly_->add(pane_, range.begin, range.end);
    }

    // Pages count in the region where they begin, or where they are met first if that is not needed.
    void count(const std::vector<PageRef>& pages, const Region& region) {
        const ZRange range = z_range(grid_, region.node);
        for (const PageRef& page : pages) {
            const PixelRect cells = intersection(grid_.cells_of(page.info.node), needed_);
            const std::uint64_t first = z_code(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0));
            if (first < range.begin || first >= range.end) continue;
            ++counts_.pages;
            counts_.page_bytes += page.info.stored_size;
        }
    }

    DevelopCounts finished_counts() const {
        DevelopCounts counts = counts_;
        const DecodeCounts& decoded = batch_->counts();
        counts.pages_decoded = decoded.pages;
        counts.page_bytes_decoded = decoded.bytes;
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
    DevelopCounts counts_;
    Classes classes_;
    PixelSums camera_, light_;
    Normalisation normalisation_;
    PixelRect needed_;  // cells
    std::uint64_t slab_bytes_ = 0, window_bytes_ = 0;
    std::unique_ptr<std::byte, Free> slab_;
    std::span<std::byte> windows_;
    std::unique_ptr<Batch> batch_;
    std::unique_ptr<Assembly> assembly_;
    Windows pane_;
};

}  // namespace

Result<DevelopCounts> develop(const sampledb::Gathering& gathering, const Channels& channels, const Settings& settings,
                              TileSink& sink, const Progress& progress) {
    const Result<RecordCounts> records = count_records(gathering);
    if (!records) return records.error();
    return Engine(gathering, *records, channels, settings, sink).run(progress);
}

}  // namespace latent::develop
