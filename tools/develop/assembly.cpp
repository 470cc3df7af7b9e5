#include "tools/develop/assembly.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/first_error.h"

namespace latent::develop {

namespace {

// Pixels whose sum of w c is below this share of its expectation are weighed without the filter's negative lobes.
constexpr double kLeastWeight = 0.05;

std::uint64_t z_of(std::int64_t cell_x, std::int64_t cell_y) {
    return z_code(static_cast<std::uint32_t>(cell_x), static_cast<std::uint32_t>(cell_y));
}

// Adds the part of a window that lies in `pixels` to the sums of a block.
void add_window(const double* window, const PixelRect& reach, const PixelRect& pixels, int doubles, double* sums) {
    const PixelRect common = intersection(reach, pixels);
    for (std::int64_t y = common.y0; y < common.y1; ++y) {
        const double* from = window + ((y - reach.y0) * reach.width() + (common.x0 - reach.x0)) * doubles;
        double* to = sums + ((y - pixels.y0) * pixels.width() + (common.x0 - pixels.x0)) * doubles;
        for (std::int64_t i = 0; i < common.width() * doubles; ++i) to[i] += from[i];
    }
}

}  // namespace

Assembly::Assembly(const FilmGrid& grid, const Filter& filter, const PixelRect& crop, const PixelSums& camera,
                   const PixelSums& light, const Normalisation& normalisation, const std::filesystem::path& folder,
                   std::uint64_t waiting_memory, TileSink& sink)
    : grid_(grid),
      crop_(crop),
      camera_(camera),
      light_(light),
      normalisation_(normalisation),
      border_(filter, grid.width(), grid.height()),
      sums_(folder,
            kBlockPixels * ((normalisation.camera ? camera.doubles() : 0) + (normalisation.light ? light.doubles() : 0)) *
                sizeof(double),
            waiting_memory / 2),
      finished_(folder, kBlockPixels * normalisation.channels * sizeof(float), waiting_memory / 2),
      sink_(sink) {}

Status Assembly::add(const Windows& windows, std::uint64_t z_begin, std::uint64_t z_end) {
    const Pane pane{windows, z_begin, z_end};
    const std::vector<Tile> tiles = tiles_touched(pane);
    FirstError error;
    struct Task {
        const Tile* tile;
        bool complete;
        std::vector<float> pixels;
    };
    using tbb::filter_mode;
    std::size_t next = 0;
    const auto next_tile = [&](tbb::flow_control& flow) -> Task* {
        if (next == tiles.size()) {
            flow.stop();
            return nullptr;
        }
        const Tile* tile = &tiles[next++];
        return new Task{tile, tile->last_z < z_end, {}};
    };
    const auto add_up = [&](Task* task) {
        error.keep(add_tile(pane, *task->tile, task->complete, task->pixels));
        return task;
    };
    const auto write = [&](Task* raw) {
        const std::unique_ptr<Task> task(raw);
        if (task->complete && !error) error.keep(sink_.write(task->tile->x, task->tile->y, task->pixels));
    };
    tbb::parallel_pipeline(kTilesPerThread * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                           tbb::make_filter<void, Task*>(filter_mode::serial_in_order, next_tile) &
                               tbb::make_filter<Task*, Task*>(filter_mode::parallel, add_up) &
                               tbb::make_filter<Task*, void>(filter_mode::serial_in_order, write));
    return error.status();
}

// In the order in which they would be complete: by the last cell that reaches them.
std::vector<Assembly::Tile> Assembly::tiles_touched(const Pane& pane) const {
    const PixelRect& cells = pane.windows.cells;
    const PixelRect first = grid_.window(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0));
    const PixelRect last = grid_.window(static_cast<std::uint32_t>(cells.x1 - 1), static_cast<std::uint32_t>(cells.y1 - 1));
    const PixelRect touched = intersection({first.x0, first.y0, last.x1, last.y1}, crop_);
    std::vector<Tile> tiles;
    if (touched.empty()) return tiles;
    constexpr int kTile = TileSink::kTile;
    for (std::int64_t y = (touched.y0 - crop_.y0) / kTile; crop_.y0 + y * kTile < touched.y1; ++y) {
        for (std::int64_t x = (touched.x0 - crop_.x0) / kTile; crop_.x0 + x * kTile < touched.x1; ++x) {
            const std::int64_t x0 = crop_.x0 + x * kTile, y0 = crop_.y0 + y * kTile;
            const PixelRect pixels = intersection({x0, y0, x0 + kTile, y0 + kTile}, crop_);
            const PixelRect reaching = grid_.cells_reaching(pixels);
            tiles.push_back({static_cast<int>(x), static_cast<int>(y), pixels, z_of(reaching.x1 - 1, reaching.y1 - 1)});
        }
    }
    std::ranges::sort(tiles, {}, [](const Tile& tile) { return std::tuple(tile.last_z, tile.y, tile.x); });
    return tiles;
}

std::uint64_t Assembly::key(const PixelRect& block) const {
    return static_cast<std::uint64_t>((block.y0 - crop_.y0) / kBlock) << 32 |
           static_cast<std::uint64_t>((block.x0 - crop_.x0) / kBlock);
}

Status Assembly::add_tile(const Pane& pane, const Tile& tile, bool complete, std::vector<float>& pixels) {
    const int channels = normalisation_.channels;
    std::vector<float> values(kBlockPixels * channels);
    if (complete) pixels.assign(static_cast<std::size_t>(tile.pixels.width() * tile.pixels.height()) * channels, 0.0f);
    for (std::int64_t y = tile.pixels.y0; y < tile.pixels.y1; y += kBlock) {
        for (std::int64_t x = tile.pixels.x0; x < tile.pixels.x1; x += kBlock) {
            const PixelRect block = intersection({x, y, x + kBlock, y + kBlock}, tile.pixels);
            Result<bool> ready = add_block(pane, block, key(block), values);
            if (!ready) return ready.error();
            if (complete && !*ready) {  // finished by an earlier pane; black blocks are not kept
                ready = finished_.take(key(block), std::as_writable_bytes(std::span(values)));
                if (!ready) return ready.error();
            }
            if (!*ready) continue;
            if (complete) {
                for (std::int64_t row = 0; row < block.height(); ++row) {
                    std::copy_n(&values[row * block.width() * channels], block.width() * channels,
                                &pixels[((y - tile.pixels.y0 + row) * tile.pixels.width() + (x - tile.pixels.x0)) * channels]);
                }
            } else if (std::ranges::any_of(values, [](float v) { return v != 0; })) {
                if (Status s = finished_.put(key(block), std::as_bytes(std::span(values))); !s) return s;
            }
        }
    }
    return {};
}

Result<bool> Assembly::add_block(const Pane& pane, const PixelRect& pixels, std::uint64_t key, std::span<float> values) {
    const PixelRect reaching = grid_.cells_reaching(pixels);
    const PixelRect cells = intersection(reaching, pane.windows.cells);
    if (cells.empty()) return false;
    const bool begun = z_of(reaching.x0, reaching.y0) < pane.z_begin;
    const bool finished = z_of(reaching.x1 - 1, reaching.y1 - 1) < pane.z_end;
    const int camera_doubles = camera_.doubles(), light_doubles = light_.doubles();

    if (!begun && finished && reaching.width() == 1 && reaching.height() == 1) {  // inside one cell: nothing to add up
        const Windows::Cell& cell = pane.windows.at(cells.x0, cells.y0);
        const PixelRect window = grid_.window(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0));
        const std::int64_t first = (pixels.y0 - window.y0) * window.width() + (pixels.x0 - window.x0);
        resolve(
            {pixels, cell.camera ? cell.camera + first * camera_doubles : nullptr,
             cell.light ? cell.light + first * light_doubles : nullptr, static_cast<std::size_t>(window.width() * camera_doubles),
             static_cast<std::size_t>(window.width() * light_doubles)},
            values);
        return true;
    }

    thread_local std::vector<double> sums;
    const std::size_t camera_size = normalisation_.camera ? kBlockPixels * camera_doubles : 0;
    sums.assign(camera_size + (normalisation_.light ? kBlockPixels * light_doubles : 0), 0.0);
    double* camera = sums.data();
    double* light = sums.data() + camera_size;
    bool any = false;
    if (begun) {
        const Result<bool> waited = sums_.take(key, std::as_writable_bytes(std::span(sums)));
        if (!waited) return waited.error();
        any = *waited;
    }
    thread_local std::vector<std::pair<std::uint64_t, PixelRect>> in_z_order;
    in_z_order.clear();
    for (std::int64_t y = cells.y0; y < cells.y1; ++y) {
        for (std::int64_t x = cells.x0; x < cells.x1; ++x) in_z_order.push_back({z_of(x, y), {x, y, x + 1, y + 1}});
    }
    std::ranges::sort(in_z_order, {}, [](const auto& entry) { return entry.first; });
    for (const auto& [z, at] : in_z_order) {
        const Windows::Cell& cell = pane.windows.at(at.x0, at.y0);
        const PixelRect window = grid_.window(static_cast<std::uint32_t>(at.x0), static_cast<std::uint32_t>(at.y0));
        if (cell.camera) add_window(cell.camera, window, pixels, camera_doubles, camera);
        if (cell.light) add_window(cell.light, window, pixels, light_doubles, light);
        any = any || cell.camera || cell.light;
    }
    if (finished) {
        const auto width = static_cast<std::size_t>(pixels.width());
        resolve({pixels, normalisation_.camera ? camera : nullptr, normalisation_.light ? light : nullptr, width * camera_doubles,
                 width * light_doubles},
                values);
    } else if (any) {
        if (Status s = sums_.put(key, std::as_bytes(std::span(sums))); !s) return s.error();
    }
    return finished;
}

void Assembly::resolve(const Block& block, std::span<float> values) {
    const int channels = normalisation_.channels, share = channels;
    std::uint64_t fallback = 0, empty = 0;
    float* out = values.data();
    for (std::int64_t y = block.pixels.y0; y < block.pixels.y1; ++y) {
        const double* camera = block.camera ? block.camera + (y - block.pixels.y0) * block.camera_row : nullptr;
        const double* light = block.light ? block.light + (y - block.pixels.y0) * block.light_row : nullptr;
        for (std::int64_t x = block.pixels.x0; x < block.pixels.x1; ++x, out += channels) {
            const auto px = static_cast<std::uint32_t>(x), py = static_cast<std::uint32_t>(y);
            double weight = 0;
            bool without_lobes = false;
            if (camera) {
                weight = camera_.split ? camera[share] + camera[camera_.lanes + share] : camera[share];
                if (!(weight >= kLeastWeight * normalisation_.camera_density * border_.camera_share(px, py))) {
                    without_lobes = true;
                    weight = camera[share];
                    weight > 0 ? ++fallback : ++empty;
                }
            } else if (normalisation_.camera) {
                ++empty;
            }
            const double light_scale = light ? normalisation_.light_scale / border_.light_share(px, py) : 0;
            for (int c = 0; c < channels; ++c) {
                double sum = 0;
                if (weight > 0)
                    sum = (without_lobes || !camera_.split ? camera[c] : camera[c] + camera[camera_.lanes + c]) / weight;
                if (light) sum += light_scale * light[c];
                out[c] = static_cast<float>(sum);
            }
            if (camera) camera += camera_.doubles();
            if (light) light += light_.doubles();
        }
    }
    std::fill(out, values.data() + values.size(), 0.0f);
    if (fallback > 0) counts_.fallback += fallback;
    if (empty > 0) counts_.empty += empty;
}

}  // namespace latent::develop
