#include "tools/develop/engine/assembly.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "base/in_order.h"
#include "sampledb/data/z_order.h"
#include "tools/develop/channels/normalise.h"

namespace latent::develop {

namespace {

// Pixels whose sum of w c is below this share of its expectation are weighed without the filter's negative lobes.
constexpr double kMinWeight = 0.05;

constexpr std::int64_t kChunk = 16;  // sums wait, and few samples are looked for, in chunks of at most 16 x 16 pixels
constexpr std::int64_t kBlock = 16;  // finished pixels wait in blocks of 16 x 16
constexpr std::int64_t kTileBlocks = TileSink::kTile / kBlock;

std::uint64_t z_of(std::int64_t cell_x, std::int64_t cell_y) {
    return sampledb::z_code(static_cast<std::uint32_t>(cell_x), static_cast<std::uint32_t>(cell_y));
}

std::uint64_t key_of(std::int64_t x, std::int64_t y) { return static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x); }

PixelRect moved(const PixelRect& r, std::int64_t x, std::int64_t y) { return {r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y}; }

bool contains(const PixelRect& outer, const PixelRect& inner) { return intersection(outer, inner) == inner; }

// The cells of a rectangle along the Z curve.
template <class Visit>
void for_cells_in_z_order(const PixelRect& cells, const Visit& visit) {
    if (cells.width() == 1 && cells.height() == 1) return visit(cells.x0, cells.y0);
    thread_local std::vector<std::tuple<std::uint64_t, std::int64_t, std::int64_t>> order;
    order.clear();
    for (std::int64_t y = cells.y0; y < cells.y1; ++y) {
        for (std::int64_t x = cells.x0; x < cells.x1; ++x) order.push_back({z_of(x, y), x, y});
    }
    std::ranges::sort(order);
    for (const auto& [z, x, y] : order) visit(x, y);
}

template <class Visit>
void for_chunks(const PixelRect& pixels, const Visit& visit) {
    for (std::int64_t y = pixels.y0; y < pixels.y1; y += kChunk) {
        for (std::int64_t x = pixels.x0; x < pixels.x1; x += kChunk) visit(intersection({x, y, x + kChunk, y + kChunk}, pixels));
    }
}

// Adds the part of a window that lies in `pixels` to their sums.
void add_window(const double* window, const PixelRect& reach, const PixelRect& pixels, const EntryCounts& entries, double* sums) {
    const std::int64_t stride = entries.stride(), row = pixels.width() * stride;
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y, sums += row) {
        const double* from = window + ((y - reach.y0) * reach.width() + (pixels.x0 - reach.x0)) * stride;
        add_sums(entries, from, sums, row);
    }
}

}  // namespace

Assembly::Assembly(const FilmGrid& grid, const Filter& filter, const PixelRect& crop, const Normalisation& normalisation,
                   const std::filesystem::path& folder, std::uint64_t waiting_memory, TileSink& sink)
    : grid_(grid),
      crop_(crop),
      normalisation_(normalisation),
      entries_(normalisation.layout.entries()),
      stride_(entries_.stride()),
      has_lobes_(filter.kernel().has_negative_lobes),
      border_(filter, grid.width(), grid.height()),
      slot_sums_(static_cast<std::size_t>(kChunk * filter.kernel().side() * stride_)),
      sums_(folder,
            slot_sums_ * sizeof(double) *
                ((normalisation.camera ? 1 : 0) + (normalisation.light ? 1 : 0) + (normalisation.camera && has_lobes_ ? 1 : 0)),
            waiting_memory / 2),
      finished_(folder, sizeof(float) * kBlock * kBlock * static_cast<std::size_t>(normalisation.layout.outputs()),
                waiting_memory / 2),
      sink_(sink),
      buffers_(pieces_at_once()) {}

Status Assembly::add(const Windows& windows, const PositiveSums& positive, std::uint64_t z_begin, std::uint64_t z_end) {
    const Pane pane{windows, positive, z_begin, z_end};
    const std::vector<Tile> tiles = tiles_touched(windows);
    // The pixels of a tile that is complete; empty for others.
    const auto add_up = [&](std::size_t i) -> Result<std::span<const float>> {
        const Tile& tile = tiles[i];
        const bool complete = tile.last_z < z_end;
        std::vector<float>& buffer = buffers_[i % buffers_.size()];  // the tile that had it is written
        buffer.resize(static_cast<std::size_t>(tile.pixels.width() * tile.pixels.height() * normalisation_.layout.outputs()));
        if (Status s = add_tile(pane, tile, complete, buffer); !s) return s.error();
        return complete ? std::span<const float>(buffer) : std::span<const float>();
    };
    const auto write = [&](std::size_t i, std::span<const float> pixels) {
        return pixels.empty() ? Status() : sink_.write(tiles[i].x, tiles[i].y, pixels);
    };
    if (Status s = make_in_order(tiles.size(), add_up, write); !s) return s;
    return sink_.after_pane();
}

// In the order in which they would be complete: by the last cell that reaches them.
std::vector<Assembly::Tile> Assembly::tiles_touched(const Windows& windows) const {
    const PixelRect& cells = windows.cells;
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
            tiles.push_back({static_cast<int>(x), static_cast<int>(y), pixels, z_of(reaching.x0, reaching.y0),
                             z_of(reaching.x1 - 1, reaching.y1 - 1)});
        }
    }
    std::ranges::sort(tiles, {}, [](const Tile& tile) { return std::tuple(tile.last_z, tile.y, tile.x); });
    return tiles;
}

template <class Visit>
void Assembly::for_pieces(const PixelRect& pixels, const Visit& visit) const {
    thread_local std::vector<FilmGrid::Band> columns, rows;
    grid_.bands_x(pixels.x0, pixels.x1, columns);
    grid_.bands_y(pixels.y0, pixels.y1, rows);
    for (const FilmGrid::Band& y : rows) {
        for (const FilmGrid::Band& x : columns) visit(Piece{{x.from, y.from, x.to, y.to}, {x.first, y.first, x.last, y.last}});
    }
}

// Whether the last of the cells that reach a piece lies in the pane.
bool Assembly::finishes(const Pane& pane, const Piece& piece) const {
    const std::uint64_t last = z_of(piece.cells.x1 - 1, piece.cells.y1 - 1);
    return last >= pane.z_begin && last < pane.z_end;
}

Status Assembly::add_tile(const Pane& pane, const Tile& tile, bool complete, std::span<float> pixels) {
    const auto channels = static_cast<std::size_t>(normalisation_.layout.outputs());
    const std::size_t row = static_cast<std::size_t>(tile.pixels.width()) * channels;
    const auto at = [&](std::int64_t x, std::int64_t y) {
        return &pixels[static_cast<std::size_t>(y - tile.pixels.y0) * row +
                       static_cast<std::size_t>(x - tile.pixels.x0) * channels];
    };
    // Blocks that this pane changes, or that the tile is made of.
    std::array<bool, kTileBlocks * kTileBlocks> wanted;
    wanted.fill(complete);
    if (!complete) {
        for_pieces(tile.pixels, [&](const Piece& piece) {
            if (!finishes(pane, piece)) return;
            const PixelRect inside = moved(piece.pixels, -tile.pixels.x0, -tile.pixels.y0);
            for (std::int64_t y = inside.y0 / kBlock; y * kBlock < inside.y1; ++y) {
                for (std::int64_t x = inside.x0 / kBlock; x * kBlock < inside.x1; ++x)
                    wanted[static_cast<std::size_t>(y * kTileBlocks + x)] = true;
            }
        });
    }
    const auto for_blocks = [&](const auto& visit) {  // visit(key, pixels); its status ends the loop
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (!wanted[i]) continue;
            const auto x = tile.pixels.x0 + static_cast<std::int64_t>(i) % kTileBlocks * kBlock;
            const auto y = tile.pixels.y0 + static_cast<std::int64_t>(i) / kTileBlocks * kBlock;
            const PixelRect block = intersection({x, y, x + kBlock, y + kBlock}, tile.pixels);
            if (block.empty()) continue;
            if (Status s = visit(key_of(x, y), block); !s) return s;
        }
        return Status{};
    };

    thread_local std::vector<float> values;
    values.resize(kBlock * kBlock * channels);
    if (tile.first_z < pane.z_begin || !complete) {  // what earlier panes have finished; black is not kept
        const Status status = for_blocks([&](std::uint64_t key, const PixelRect& block) -> Status {
            const Result<bool> waited = finished_.take(key, std::as_writable_bytes(std::span(values)));
            if (!waited) return waited.error();
            const auto width = static_cast<std::size_t>(block.width()) * channels;
            for (std::int64_t y = block.y0; y < block.y1; ++y) {
                if (*waited)
                    std::copy_n(&values[static_cast<std::size_t>(y - block.y0) * width], width, at(block.x0, y));
                else
                    std::fill_n(at(block.x0, y), width, 0.0f);
            }
            return {};
        });
        if (!status) return status;
    }
    Status status;
    for_pieces(tile.pixels, [&](const Piece& piece) {
        if (status) status = add_piece(pane, piece, at(piece.pixels.x0, piece.pixels.y0), row);
    });
    if (!status || complete) return status;
    return for_blocks([&](std::uint64_t key, const PixelRect& block) -> Status {
        const auto width = static_cast<std::size_t>(block.width()) * channels;
        bool black = true;
        for (std::int64_t y = block.y0; y < block.y1; ++y) {
            const float* const from = at(block.x0, y);
            black = black && std::all_of(from, from + width, [](float v) { return v == 0; });
            std::copy_n(from, width, &values[static_cast<std::size_t>(y - block.y0) * width]);
        }
        return black ? Status{} : finished_.put(key, std::as_bytes(std::span(values)));
    });
}

Status Assembly::add_piece(const Pane& pane, const Piece& piece, float* out, std::size_t out_row) {
    if (intersection(piece.cells, pane.windows.cells).empty()) return {};
    const bool begun = z_of(piece.cells.x0, piece.cells.y0) < pane.z_begin, finished = finishes(pane, piece);
    if (begun || !finished) return add_waiting(pane, piece, begun, finished, out, out_row);
    thread_local std::vector<double> memory;
    finish(pane, piece, sums_in_pane(pane.windows, piece, memory), out, out_row);
    return {};
}

// Adds the sums of a pane to those of the panes before. They wait in chunks, which have room in a slot.
Status Assembly::add_waiting(const Pane& pane, const Piece& piece, bool begun, bool finished, float* out, std::size_t out_row) {
    const PixelRect& pixels = piece.pixels;
    const auto stride = static_cast<std::size_t>(stride_);
    const auto size = static_cast<std::size_t>(pixels.width() * pixels.height()) * stride;
    const std::size_t images = (normalisation_.camera ? 1 : 0) + (normalisation_.light ? 1 : 0);
    const bool with_positive = normalisation_.camera && has_lobes_;
    const std::size_t kinds = images + (with_positive ? 1 : 0);  // camera, light, positive
    thread_local std::vector<double> memory, slot;
    memory.assign(kinds * size, 0.0);
    slot.resize(kinds * slot_sums_);
    double* const camera = normalisation_.camera ? memory.data() : nullptr;
    double* const light = normalisation_.light ? memory.data() + (images - 1) * size : nullptr;
    double* const positive = with_positive ? memory.data() + images * size : nullptr;
    const auto for_rows = [&](const PixelRect& chunk, const auto& visit) {  // visit(of the slot, of the piece, doubles)
        double* in_slot = slot.data();
        const auto row = static_cast<std::size_t>(chunk.width()) * stride;
        for (std::size_t kind = 0; kind < kinds; ++kind) {
            for (std::int64_t y = chunk.y0; y < chunk.y1; ++y, in_slot += row) {
                const std::int64_t first = (y - pixels.y0) * pixels.width() + chunk.x0 - pixels.x0;
                visit(in_slot, &memory[kind * size + static_cast<std::size_t>(first) * stride], row);
            }
        }
    };
    bool any = false;
    Status status;
    for_chunks(begun ? pixels : PixelRect{}, [&](const PixelRect& chunk) {
        if (!status) return;
        const Result<bool> waited = sums_.take(key_of(chunk.x0, chunk.y0), std::as_writable_bytes(std::span(slot)));
        if (!waited) status = waited.error();
        if (!waited || !*waited) return;
        any = true;
        for_rows(chunk, [](const double* in_slot, double* sums, std::size_t n) { std::copy_n(in_slot, n, sums); });
    });
    if (!status) return status;
    Sums sums = add_up(pane.windows, piece, camera, light);
    any = any || sums.camera || sums.light;
    if (finished) {
        if (any) sums.camera = camera, sums.light = light, sums.positive = positive;
        finish(pane, piece, sums, out, out_row);
        return {};
    }
    if (with_positive) add_positive(pane, piece, std::span(positive, size));
    for_chunks(any ? pixels : PixelRect{}, [&](const PixelRect& chunk) {
        for_rows(chunk, [](double* in_slot, const double* its_sums, std::size_t n) { std::copy_n(its_sums, n, in_slot); });
        if (status) status = sums_.put(key_of(chunk.x0, chunk.y0), std::as_bytes(std::span(slot)));
    });
    return status;
}

void Assembly::add_positive(const Pane& pane, const Piece& piece, std::span<double> sums) const {
    for_cells_in_z_order(intersection(piece.cells, pane.windows.cells), [&](std::int64_t x, std::int64_t y) {
        if (pane.windows.at(x, y).camera) pane.positive.add(x, y, piece.pixels, sums);
    });
}

// Adds the windows of the pane's cells to sums of a piece, row after row. Null where none of them has such records.
Assembly::Sums Assembly::add_up(const Windows& windows, const Piece& piece, double* camera, double* light) const {
    const auto row = static_cast<std::size_t>(piece.pixels.width() * stride_);
    Sums sums{nullptr, nullptr, nullptr, row, row};
    for_cells_in_z_order(intersection(piece.cells, windows.cells), [&](std::int64_t x, std::int64_t y) {
        const Windows::Cell& cell = windows.at(x, y);
        const PixelRect window = grid_.window(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
        if (cell.camera) add_window(cell.camera, window, piece.pixels, entries_, camera), sums.camera = camera;
        if (cell.light) add_window(cell.light, window, piece.pixels, entries_, light), sums.light = light;
    });
    return sums;
}

// Sums of a piece whose cells all lie in the pane: those of its only cell stay where they are.
Assembly::Sums Assembly::sums_in_pane(const Windows& windows, const Piece& piece, std::vector<double>& memory) const {
    const PixelRect& cells = piece.cells;
    if (cells.width() > 1 || cells.height() > 1) {
        const auto size = static_cast<std::size_t>(piece.pixels.width() * piece.pixels.height() * stride_);
        memory.assign(2 * size, 0.0);
        return add_up(windows, piece, memory.data(), memory.data() + size);
    }
    const Windows::Cell& cell = windows.at(cells.x0, cells.y0);
    const PixelRect window = grid_.window(static_cast<std::uint32_t>(cells.x0), static_cast<std::uint32_t>(cells.y0));
    const auto row = static_cast<std::size_t>(window.width() * stride_);
    const std::int64_t first = ((piece.pixels.y0 - window.y0) * window.width() + piece.pixels.x0 - window.x0) * stride_;
    return {cell.camera ? cell.camera + first : nullptr, cell.light ? cell.light + first : nullptr, nullptr, row, row};
}

double Assembly::min_weight(std::int64_t x, std::int64_t y) const {
    return kMinWeight * normalisation_.camera_density *
           border_.camera_share(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
}
double Assembly::light_scale(std::int64_t x, std::int64_t y) const {
    return normalisation_.light_scale / border_.light_share(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
}

void Assembly::finish(const Pane& pane, const Piece& piece, const Sums& sums, float* out, std::size_t out_row) {
    const PixelRect& pixels = piece.pixels;
    const auto width = static_cast<std::size_t>(pixels.width());
    thread_local std::vector<double> least, scale;
    least.resize(width), scale.resize(width);
    const bool inside = border_.inside(pixels);
    std::size_t few = 0;
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        for (std::size_t x = 0; x < width && (!inside || y == pixels.y0); ++x) {
            least[x] = min_weight(pixels.x0 + static_cast<std::int64_t>(x), y);
            scale[x] = light_scale(pixels.x0 + static_cast<std::int64_t>(x), y);
        }
        const auto row = static_cast<std::size_t>(y - pixels.y0);
        few += normalise_row(
            {sums.camera ? sums.camera + row * sums.camera_row : nullptr, sums.light ? sums.light + row * sums.light_row : nullptr,
             normalisation_.layout, least, scale, normalisation_.half_scale},
            out + row * out_row);
    }
    if (!sums.camera && normalisation_.camera) counts_.empty += width * static_cast<std::uint64_t>(pixels.height());
    if (few > 0) finish_few_samples(pane, piece, sums, out, out_row);
}

// Visits those of a piece's pixels whose weight is too small, until `visit` returns false.
template <class Visit>
void Assembly::for_few_samples(const PixelRect& pixels, const Piece& piece, const Sums& sums, const Visit& visit) const {
    const bool inside = border_.inside(pixels);  // all have the same least weight
    double least = min_weight(pixels.x0, pixels.y0);
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        const double* at = sums.camera + static_cast<std::size_t>(y - piece.pixels.y0) * sums.camera_row +
                           static_cast<std::size_t>((pixels.x0 - piece.pixels.x0) * stride_);
        for (std::int64_t x = pixels.x0; x < pixels.x1; ++x, at += stride_) {
            if (!inside) least = min_weight(x, y);
            if (normalisation_.layout.min_divisor(at) < least && !visit(x, y)) return;
        }
    }
}

void Assembly::finish_few_samples(const Pane& pane, const Piece& piece, const Sums& sums, float* out, std::size_t out_row) {
    const auto stride = static_cast<std::size_t>(stride_), outputs = static_cast<std::size_t>(normalisation_.layout.outputs()),
               share = static_cast<std::size_t>(normalisation_.layout.share());
    thread_local std::vector<double> positive;
    thread_local std::vector<std::array<std::int64_t, 2>> pixels;
    std::uint64_t fallback = 0, empty = 0;
    for_chunks(piece.pixels, [&](const PixelRect& chunk) {
        PixelRect few{chunk.x1, chunk.y1, chunk.x0, chunk.y0};  // about them
        pixels.clear();
        for_few_samples(chunk, piece, sums, [&](std::int64_t x, std::int64_t y) {
            pixels.push_back({x, y});
            few = {std::min(few.x0, x), std::min(few.y0, y), std::max(few.x1, x + 1), std::max(few.y1, y + 1)};
            return true;
        });
        if (pixels.empty()) return;
        const auto row_of = [&](std::int64_t y) { return static_cast<std::size_t>(y - piece.pixels.y0); };
        const auto column_of = [&](std::int64_t x) { return static_cast<std::size_t>(x - piece.pixels.x0); };
        positive.assign(static_cast<std::size_t>(few.width() * few.height()) * stride, 0.0);
        if (has_lobes_ && sums.positive) {
            add_window(sums.positive, piece.pixels, few, entries_, positive.data());
        }
        if (has_lobes_) {
            add_positive(pane, {few, piece.cells}, positive);
        } else {
            const auto first = row_of(few.y0) * sums.camera_row + column_of(few.x0) * stride;
            for (std::int64_t y = 0; y < few.height(); ++y) {
                std::copy_n(sums.camera + first + static_cast<std::size_t>(y) * sums.camera_row,
                            static_cast<std::size_t>(few.width()) * stride,
                            &positive[static_cast<std::size_t>(y * few.width()) * stride]);
            }
        }
        for (const auto& [x, y] : pixels) {
            const std::size_t row = row_of(y), column = column_of(x);
            const double* const at = &positive[static_cast<std::size_t>((y - few.y0) * few.width() + x - few.x0) * stride];
            const double none = 0, scale = light_scale(x, y);
            normalise_row({at,
                           sums.light ? sums.light + row * sums.light_row + column * stride : nullptr,
                           normalisation_.layout,
                           {&none, 1},
                           {&scale, 1},
                           normalisation_.half_scale},
                          out + row * out_row + column * outputs);
            fallback += has_lobes_ && at[share] > 0;
            empty += !(at[share] > 0);
        }
    });
    counts_.fallback += fallback;
    counts_.empty += empty;
}

std::vector<std::size_t> Assembly::cells_of_few_samples(const Windows& windows) const {
    const std::vector<Tile> tiles = tiles_touched(windows);
    std::vector<std::atomic<bool>> few(windows.of.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
        thread_local std::vector<double> memory;
        for_pieces(tiles[i].pixels, [&](const Piece& piece) {
            if (!contains(windows.cells, piece.cells)) return;
            const Sums sums = sums_in_pane(windows, piece, memory);
            bool any = false;
            const auto found = [&](std::int64_t, std::int64_t) {
                any = true;
                return false;
            };
            if (sums.camera) for_few_samples(piece.pixels, piece, sums, found);
            if (!any) return;
            for (std::int64_t y = piece.cells.y0; y < piece.cells.y1; ++y) {
                for (std::int64_t x = piece.cells.x0; x < piece.cells.x1; ++x)
                    few[static_cast<std::size_t>((y - windows.cells.y0) * windows.cells.width() + x - windows.cells.x0)] = true;
            }
        });
    });
    std::vector<std::size_t> cells;
    for (std::size_t i = 0; i < few.size(); ++i) {
        if (few[i]) cells.push_back(i);
    }
    return cells;
}

}  // namespace latent::develop
