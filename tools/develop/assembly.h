// tools/develop/assembly.h: windows of finished cells become pixels, pixels become tiles. docs/developing.md, "From sums to
// pixels".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/result.h"
#include "base/slot_file.h"
#include "tools/develop/border.h"
#include "tools/develop/film_grid.h"
#include "tools/develop/splat.h"

namespace latent::develop {

// Takes finished tiles, each once, in an order that the image size, the crop and the filter determine.
class TileSink {
 public:
    static constexpr int kTile = 256;

    virtual ~TileSink() = default;
    // Tile (x, y) of the crop, counted in kTile x kTile pixels from its corner; rows one after another, `channels` floats per
    // pixel.
    virtual Status write(int x, int y, std::span<const float> pixels) = 0;
};

// What turns sums into values.
struct Normalisation {
    int channels;           // of a pixel
    bool camera, light;     // which images are added up
    double camera_density;  // samples per pixel of the film
    double light_scale;     // pixels of the full film / N
};

struct PixelCounts {
    std::atomic<std::uint64_t> fallback = 0;  // camera pixels whose sum of w c was below 0.05 of its expectation
    std::atomic<std::uint64_t> empty = 0;     // camera pixels without any record
};

// The windows of the cells of a pane (a node of the film whose cells are finished together); null where a cell has no such records.
struct Windows {
    PixelRect cells;
    struct Cell {
        const double* camera = nullptr;
        const double* light = nullptr;
    };
    std::vector<Cell> of;  // row after row
    const Cell& at(std::int64_t x, std::int64_t y) const { return of[(y - cells.y0) * cells.width() + (x - cells.x0)]; }
};

// Panes arrive in Z order and cover all cells that reach into the crop. The picture is handled in blocks of 16 x 16 pixels: a block
// is finished with the last cell that reaches it. Until then its sums wait; finished blocks wait until their tile is complete. Both
// wait in memory or, beyond `waiting_memory`, in unnamed files in `folder`.
class Assembly {
 public:
    static constexpr int kBlock = 16;
    static constexpr std::size_t kBlockPixels = std::size_t{kBlock} * kBlock;
    static constexpr std::size_t kTilesPerThread = 2;  // in memory at once

    Assembly(const FilmGrid& grid, const Filter& filter, const PixelRect& crop, const PixelSums& camera, const PixelSums& light,
             const Normalisation& normalisation, const std::filesystem::path& folder, std::uint64_t waiting_memory, TileSink& sink);

    // Adds the windows of a pane, whose codes on the Z curve are z_begin .. z_end-1, and writes the tiles that are complete now.
    Status add(const Windows& windows, std::uint64_t z_begin, std::uint64_t z_end);

    const PixelCounts& counts() const { return counts_; }
    std::uint64_t bytes_on_disk() const { return sums_.bytes_on_disk() + finished_.bytes_on_disk(); }

 private:
    struct Tile {
        int x, y;
        PixelRect pixels;
        std::uint64_t last_z;
    };
    struct Pane {
        const Windows& windows;
        std::uint64_t z_begin, z_end;
    };
    // Sums of a block: its pixels row after row.
    struct Block {
        PixelRect pixels;
        const double* camera;
        const double* light;
        std::size_t camera_row, light_row;  // doubles from one row to the next
    };

    std::vector<Tile> tiles_touched(const Pane& pane) const;
    Status add_tile(const Pane& pane, const Tile& tile, bool complete, std::vector<float>& pixels);
    // Adds what the pane gives to a block; true if it is finished, its values then in `values`.
    Result<bool> add_block(const Pane& pane, const PixelRect& pixels, std::uint64_t key, std::span<float> values);
    void resolve(const Block& block, std::span<float> values);
    std::uint64_t key(const PixelRect& block) const;

    const FilmGrid& grid_;
    PixelRect crop_;
    PixelSums camera_, light_;
    Normalisation normalisation_;
    BorderShare border_;
    SlotFile sums_, finished_;
    TileSink& sink_;
    PixelCounts counts_;
};

}  // namespace latent::develop
