#include "tools/convert/spread_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/first_error.h"

namespace latent::convert {

using image::Convolver;
using image::Rect;

namespace {

// Start of the tile that holds `at`.
int tile_start(int origin, int step, int at) { return origin + (at - origin) / step * step; }

// What the tiles of `wanted` see of the picture.
Rect seen_for(const Convolver& convolver, const Rect& wanted) {
    const Rect& picture = convolver.picture();
    const int step = convolver.step(), margin = convolver.margin();
    return intersect(picture, {tile_start(picture.x0, step, wanted.x0) - margin, tile_start(picture.y0, step, wanted.y0) - margin,
                               tile_start(picture.x0, step, wanted.x1 - 1) + step + margin,
                               tile_start(picture.y0, step, wanted.y1 - 1) + step + margin});
}

// The picture after its light has spread, or what its pixels have gained alone.
enum class Part : std::uint8_t { kAll, kGained };

class SpreadRows : public Rows {
 public:
    static Result<std::unique_ptr<Rows>> create(std::unique_ptr<Rows> before, std::shared_ptr<const Convolver> convolver, Part part,
                                                const Rect& wanted, int keep, const std::filesystem::path& folder) {
        Result<RowFile> after = RowFile::create(folder, wanted, keep + convolver->step());
        if (!after) return after.error();
        return std::unique_ptr<Rows>(new SpreadRows(std::move(before), std::move(convolver), part, wanted, std::move(*after)));
    }
    Status make(int y1) override {
        while (made_ < y1) {
            if (Status s = make_tiles(made_); !s) return s;
            made_ += convolver_->step();
        }
        return {};
    }
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const override {
        return after_.read(channel, x0, y, row);
    }

 private:
    SpreadRows(std::unique_ptr<Rows> before, std::shared_ptr<const Convolver> convolver, Part part, const Rect& wanted,
               RowFile after)
        : before_(std::move(before)),
          convolver_(std::move(convolver)),
          part_(part),
          wanted_(wanted),
          after_(std::move(after)),
          made_(tile_start(convolver_->picture().y0, convolver_->step(), wanted.y0)) {
        const auto size = static_cast<std::size_t>(convolver_->size());
        for (std::vector<float>& plane : planes_) plane.resize(size * size);
    }
    Status make_tiles(int y0);

    std::unique_ptr<Rows> before_;
    std::shared_ptr<const Convolver> convolver_;
    Part part_;
    Rect wanted_;
    RowFile after_;
    int made_;
    Convolver::Planes planes_;
};

// Makes the wanted tiles that begin in row y0.
Status SpreadRows::make_tiles(int y0) {
    const Rect& picture = convolver_->picture();
    const int step = convolver_->step(), margin = convolver_->margin(), size = convolver_->size();
    if (Status s = before_->make(std::min(picture.y1, y0 + step + margin)); !s) return s;
    FirstError error;
    for (int x0 = tile_start(picture.x0, step, wanted_.x0); x0 < wanted_.x1; x0 += step) {
        const Rect seen = intersect(picture, {x0 - margin, y0 - margin, x0 - margin + size, y0 - margin + size});
        const Rect tile = intersect(wanted_, {x0, y0, x0 + step, y0 + step});
        const auto row_of = [&](int y) { return static_cast<std::size_t>(y - (y0 - margin)) * static_cast<std::size_t>(size); };
        tbb::parallel_for(0, size, [&](int i) {
            const int y = y0 - margin + i;
            for (std::size_t c = 0; c < 3 && !error; ++c) {
                const std::span<float> row{&planes_[c][row_of(y)], static_cast<std::size_t>(size)};
                std::ranges::fill(row, 0.0F);
                if (y < seen.y0 || y >= seen.y1) continue;
                const auto part =
                    row.subspan(static_cast<std::size_t>(seen.x0 - (x0 - margin)), static_cast<std::size_t>(seen.width()));
                error.keep(before_->read(c, seen.x0, y, part));
                for (float& value : part) value = Convolver::usable(value);
            }
        });
        if (error) return error.status();
        convolver_->spread(planes_, [&](std::size_t c, const float* gained) {
            tbb::parallel_for(tile.y0, tile.y1, [&](int y) {
                if (error) return;
                const float* gains = gained + row_of(y) + (tile.x0 - (x0 - margin));
                const auto width = static_cast<std::size_t>(tile.width());
                if (part_ == Part::kGained) return error.keep(after_.write(c, tile.x0, y, {gains, width}));
                std::vector<float> light(width), out(width);
                error.keep(before_->read(c, tile.x0, y, light));
                convolver_->join(c, tile.x0, y, light, gains, out.data());
                error.keep(after_.write(c, tile.x0, y, out));
            });
        });
        if (error) return error.status();
    }
    return {};
}

// Pixels of `picture` in cells, from its corner on; those at its end may be smaller.
Rect in_cells(const Rect& picture, int cell) {
    return {0, 0, (picture.width() + cell - 1) / cell, (picture.height() + cell - 1) / cell};
}

// Means over cells.
class CellRows : public Rows {
 public:
    // For pixels that `before` makes, which must outlive the result. `wanted` is in cells.
    static Result<std::unique_ptr<Rows>> create(Rows& before, const Rect& picture, int cell, const Rect& wanted, int keep,
                                                const std::filesystem::path& folder) {
        Result<RowFile> file = RowFile::create(folder, wanted, keep);
        if (!file) return file.error();
        return std::unique_ptr<Rows>(new CellRows(before, picture, cell, wanted, std::move(*file)));
    }
    Status make(int y1) override {
        if (made_ >= y1) return {};
        if (Status s = before_.make(std::min(picture_.y1, picture_.y0 + y1 * cell_)); !s) return s;
        FirstError error;
        tbb::parallel_for(made_, y1, [&](int y) {
            for (std::size_t c = 0; c < 3 && !error; ++c) error.keep(make_row(c, y));
        });
        made_ = y1;
        return error.status();
    }
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const override { return file_.read(channel, x0, y, row); }

 private:
    CellRows(Rows& before, const Rect& picture, int cell, const Rect& wanted, RowFile file)
        : before_(before), picture_(picture), cell_(cell), wanted_(wanted), file_(std::move(file)), made_(wanted.y0) {}
    Status make_row(std::size_t channel, int y) {
        const Rect pixels = intersect(picture_, {picture_.x0 + wanted_.x0 * cell_, picture_.y0 + y * cell_,
                                                 picture_.x0 + wanted_.x1 * cell_, picture_.y0 + (y + 1) * cell_});
        std::vector<float> row(static_cast<std::size_t>(pixels.width())), sums(static_cast<std::size_t>(wanted_.width()));
        for (int from = pixels.y0; from < pixels.y1; ++from) {
            if (Status s = before_.read(channel, pixels.x0, from, row); !s) return s;
            for (std::size_t x = 0; x < sums.size(); ++x) {
                const std::size_t begin = x * static_cast<std::size_t>(cell_),
                                  end = std::min(begin + static_cast<std::size_t>(cell_), row.size());
                for (std::size_t i = begin; i < end; ++i) sums[x] += Convolver::usable(row[i]);
            }
        }
        for (std::size_t x = 0; x < sums.size(); ++x) {
            const int columns = std::min(cell_, pixels.width() - static_cast<int>(x) * cell_);
            sums[x] /= static_cast<float>(columns * pixels.height());
        }
        return file_.write(channel, wanted_.x0, y, sums);
    }

    Rows& before_;
    Rect picture_;
    int cell_;
    Rect wanted_;  // in cells
    RowFile file_;
    int made_;
};

// A place between the middles of cells.
struct Between {
    int below, above;
    float part;  // share of the way
};
Between between(int pixel, int cell, int cells) {
    const int from_first = 2 * pixel + 1 - cell;  // in halves of a pixel
    if (from_first < 0) return {0, 0, 0};
    const int below = from_first / (2 * cell);
    return {below, std::min(below + 1, cells - 1),
            static_cast<float>(from_first - below * 2 * cell) / static_cast<float>(2 * cell)};
}

// Pixels keep what cells do not give away, and gain what cells gain; both change evenly between the middles of cells.
class FarRows : public Rows {
 public:
    FarRows(std::unique_ptr<Rows> before, std::unique_ptr<Rows> gained, std::shared_ptr<const Convolver> convolver,
            const Rect& picture, int cell)
        : before_(std::move(before)), gained_(std::move(gained)), convolver_(std::move(convolver)), picture_(picture), cell_(cell) {
        for (int x = 0; x < picture.width(); ++x) columns_.push_back(between(x, cell, convolver_->picture().x1));
    }
    Status make(int y1) override {
        const Rect& cells = convolver_->picture();
        if (Status s = gained_->make(between(y1 - 1 - picture_.y0, cell_, cells.y1).above + 1); !s) return s;
        return before_->make(y1);
    }
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const override {
        if (Status s = before_->read(channel, x0, y, row); !s || !convolver_->spreads(channel)) return s;
        const Rect& cells = convolver_->picture();
        const Between v = between(y - picture_.y0, cell_, cells.y1);
        const Between* columns = &columns_[static_cast<std::size_t>(x0 - picture_.x0)];
        const int first = columns[0].below, last = columns[row.size() - 1].above;
        struct Cell {
            float gained, given;
        };
        std::vector<float> gained[2]{std::vector<float>(static_cast<std::size_t>(last - first + 1)), {}};
        gained[1] = gained[0];
        if (Status s = gained_->read(channel, first, v.below, gained[0]); !s) return s;
        if (Status s = gained_->read(channel, first, v.above, gained[1]); !s) return s;
        std::vector<Cell> at(gained[0].size());
        for (std::size_t i = 0; i < at.size(); ++i) {
            const int x = first + static_cast<int>(i);
            const float given = convolver_->given_away(channel, x, v.below);
            at[i] = {gained[0][i] + v.part * (gained[1][i] - gained[0][i]),
                     given + v.part * (convolver_->given_away(channel, x, v.above) - given)};
        }
        for (std::size_t i = 0; i < row.size(); ++i) {
            const Between u = columns[i];
            const Cell a = at[static_cast<std::size_t>(u.below - first)], b = at[static_cast<std::size_t>(u.above - first)];
            const float given = a.given + u.part * (b.given - a.given), more = a.gained + u.part * (b.gained - a.gained);
            if (row[i] == Convolver::usable(row[i])) row[i] = row[i] * (1 - given) + more;
        }
        return {};
    }

 private:
    std::unique_ptr<Rows> before_, gained_;  // pixels; cells, made of those pixels
    std::shared_ptr<const Convolver> convolver_;
    Rect picture_;
    int cell_;
    std::vector<Between> columns_;
};

std::shared_ptr<const Convolver> convolver_for(std::optional<image::Kernel>& kernel, const Rect& picture) {
    if (!kernel) return nullptr;
    auto convolver = std::make_shared<const Convolver>(*kernel, picture);
    kernel.reset();  // no longer needed, and large
    return convolver;
}

}  // namespace

std::size_t spread_bytes(const Spread& spread, const image::ExrImage& image, int threads) {
    // The program itself, and the pattern of an aperture: made first, but the allocator may keep its memory.
    constexpr std::size_t kBeside = 44 << 20;
    const Rect& picture = image.data_window;
    return kBeside + bytes_to_read(image, picture, threads) + (spread.near ? Convolver::bytes(spread.near->radius(), picture) : 0) +
           (spread.far ? Convolver::bytes(spread.far->radius(), in_cells(picture, spread.cell)) : 0);
}

Result<std::unique_ptr<Rows>> light_rows(const Source& source, Spread spread, const BandPlan& print,
                                         const std::filesystem::path& folder, int threads) {
    const Rect picture = source.reader.image().data_window;
    const int cell = spread.cell;
    const auto near = convolver_for(spread.near, picture), far = convolver_for(spread.far, in_cells(picture, cell));
    // From the end: what each step needs of the one before.
    Rect wanted = print.area, wanted_gains{}, wanted_cells{};
    int keep = highest(print);
    const int keep_gains = keep / cell + 4;
    if (far) {
        const Rect from{wanted.x0 - picture.x0, wanted.y0 - picture.y0, wanted.x1 - picture.x0, wanted.y1 - picture.y0};
        wanted_gains = intersect(far->picture(), {from.x0 / cell - 1, from.y0 / cell - 1, from.x1 / cell + 2, from.y1 / cell + 2});
        wanted_cells = seen_for(*far, wanted_gains);
        wanted = intersect(picture, {picture.x0 + wanted_cells.x0 * cell, picture.y0 + wanted_cells.y0 * cell,
                                     picture.x0 + wanted_cells.x1 * cell, picture.y0 + wanted_cells.y1 * cell});
        keep += (far->size() + 2) * cell;
    }
    Result<std::unique_ptr<Rows>> rows =
        PictureRows::create(source, near ? seen_for(*near, wanted).y0 : wanted.y0, near ? near->size() : keep, folder, threads);
    if (rows && near) rows = SpreadRows::create(*std::move(rows), near, Part::kAll, wanted, keep, folder);
    if (!rows || !far) return rows;
    Result<std::unique_ptr<Rows>> cells = CellRows::create(**rows, picture, cell, wanted_cells, far->size(), folder);
    if (cells) cells = SpreadRows::create(*std::move(cells), far, Part::kGained, wanted_gains, keep_gains, folder);
    if (!cells) return cells;
    return std::unique_ptr<Rows>(std::make_unique<FarRows>(*std::move(rows), *std::move(cells), far, picture, cell));
}

}  // namespace latent::convert
