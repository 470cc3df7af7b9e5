// tools/develop/engine/assembly.h: windows of finished cells become pixels, pixels become tiles. docs/developing.md, "From sums to
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
#include "tools/develop/channels/layers.h"
#include "tools/develop/engine/positive.h"
#include "tools/develop/film/border.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/windows.h"

namespace latent::develop {

// Takes finished tiles, each once, in an order that the image size, the crop and the filter determine.
class TileSink {
 public:
    static constexpr int kTile = 256;

    virtual ~TileSink() = default;
    // Tile (x, y) of the crop, counted in kTile x kTile pixels from its corner; rows one after another, RowLayout::outputs() floats
    // per pixel.
    virtual Status write(int x, int y, std::span<const float> pixels) = 0;
    // After the tiles of each pane: here, it may use all threads of the arena.
    virtual Status after_pane() { return {}; }
};

// What turns sums into values.
struct Normalisation {
    RowLayout layout;                  // how a pixel's sums in each image are laid out, and its values
    bool camera, light;                // which images are added up
    double camera_density;             // samples per pixel of the film
    double light_scale;                // pixels of the full film / N
    std::array<double, 2> half_scale;  // N over the samples of either half
};

struct PixelCounts {
    std::atomic<std::uint64_t> fallback = 0;  // camera pixels of few samples, weighed without the filter's negative lobes
    std::atomic<std::uint64_t> empty = 0;     // camera pixels without any record
};

// Panes arrive in Z order and cover all cells that reach into the crop. Pixels that the same cells reach form pieces: most are
// reached by one cell, and finished with it. Where cells of several panes reach a piece, its sums wait for the last of them; pixels
// wait until their tile is complete. Both wait in memory or, beyond `waiting_memory`, in unnamed files in `folder`.
class Assembly {
 public:
    Assembly(const FilmGrid& grid, const Filter& filter, const PixelRect& crop, const Normalisation& normalisation,
             const std::filesystem::path& folder, std::uint64_t waiting_memory, TileSink& sink);

    // Adds the windows of a pane, whose codes on the Z curve are z_begin .. z_end-1, and writes the tiles that are complete now.
    // `positive` is asked for sums of pixels whose weight is too small, and of those that wait.
    Status add(const Windows& windows, const PositiveSums& positive, std::uint64_t z_begin, std::uint64_t z_end);
    // The cells of a pane (numbers in it, ascending) that reach pixels which no other pane reaches and whose weight is too small:
    // those which `positive` will be asked for, and which no border holds.
    std::vector<std::size_t> cells_of_few_samples(const Windows& windows) const;

    const PixelCounts& counts() const { return counts_; }
    std::uint64_t bytes_on_disk() const { return sums_.bytes_on_disk() + finished_.bytes_on_disk(); }

 private:
    struct Tile {
        int x, y;
        PixelRect pixels;
        std::uint64_t first_z, last_z;
    };
    struct Pane {
        const Windows& windows;
        const PositiveSums& positive;
        std::uint64_t z_begin, z_end;
    };
    // Pixels that cells x0..x1-1, y0..y1-1 reach, all of them and no others.
    struct Piece {
        PixelRect pixels, cells;
    };
    // Its sums: null where no cell has such records.
    struct Sums {
        const double* camera;
        const double* light;
        const double* positive;             // what earlier panes gave; null: nothing
        std::size_t camera_row, light_row;  // doubles from one row to the next
    };

    std::vector<Tile> tiles_touched(const Windows& windows) const;
    template <class Visit>
    void for_pieces(const PixelRect& pixels, const Visit& visit) const;  // visit(Piece)
    Status add_tile(const Pane& pane, const Tile& tile, bool complete, std::span<float> pixels);
    bool finishes(const Pane& pane, const Piece& piece) const;
    Status add_piece(const Pane& pane, const Piece& piece, float* out, std::size_t out_row);
    Status add_waiting(const Pane& pane, const Piece& piece, bool begun, bool finished, float* out, std::size_t out_row);
    void add_positive(const Pane& pane, const Piece& piece, std::span<double> sums) const;
    Sums add_up(const Windows& windows, const Piece& piece, double* camera, double* light) const;
    Sums sums_in_pane(const Windows& windows, const Piece& piece, std::vector<double>& memory) const;
    void finish(const Pane& pane, const Piece& piece, const Sums& sums, float* out, std::size_t out_row);
    void finish_few_samples(const Pane& pane, const Piece& piece, const Sums& sums, float* out, std::size_t out_row);
    template <class Visit>
    void for_few_samples(const PixelRect& pixels, const Piece& piece, const Sums& sums, const Visit& visit) const;
    double min_weight(std::int64_t x, std::int64_t y) const;
    double light_scale(std::int64_t x, std::int64_t y) const;

    const FilmGrid& grid_;
    PixelRect crop_;
    Normalisation normalisation_;
    EntryCounts entries_;
    int stride_;
    bool has_lobes_;
    BorderShare border_;
    std::size_t slot_sums_;  // doubles of one image in a slot of sums_
    SlotFile sums_, finished_;
    TileSink& sink_;
    std::vector<std::vector<float>> buffers_;  // one for each tile in work
    PixelCounts counts_;
};

}  // namespace latent::develop
