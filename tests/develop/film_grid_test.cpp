#include "tools/develop/film/film_grid.h"

#include <gtest/gtest.h>

namespace latent::develop {
namespace {

bool reaches(const FilmGrid& grid, std::int64_t cell, std::int64_t x) {
    const PixelRect window = grid.window(static_cast<std::uint32_t>(cell), 0);
    return x >= window.x0 && x < window.x1;
}

struct Case {
    std::uint32_t width, height;
    int reach;
};
// Cells of 64 pixels and of less, of a fraction of a pixel where the film is long and thin.
constexpr Case kCases[] = {{512, 512, 2}, {300, 200, 4}, {9000, 7, 2}, {5, 900, 8}, {64, 64, 1}, {1, 1, 2}};

TEST(FilmGrid, BandsCutAnAxisIntoPixelsThatTheSameCellsReach) {
    for (const Case& c : kCases) {
        SCOPED_TRACE(::testing::Message() << c.width << " x " << c.height << ", " << c.reach);
        const FilmGrid grid(c.width, c.height, c.reach);
        const std::int64_t from = c.width / 5, to = c.width - c.width / 9;
        std::vector<FilmGrid::Band> bands;
        grid.bands_x(from, to, bands);
        std::int64_t next = from;
        for (const FilmGrid::Band& band : bands) {
            EXPECT_EQ(band.from, next);
            EXPECT_LT(band.from, band.to);
            next = band.to;
            for (std::int64_t x = band.from; x < band.to; ++x) {
                for (std::int64_t cell = 0; cell < std::int64_t{1} << grid.level(); ++cell)
                    ASSERT_EQ(reaches(grid, cell, x), cell >= band.first && cell < band.last) << cell << ' ' << x;
            }
        }
        EXPECT_EQ(next, to);
    }
}

TEST(FilmGrid, InnerPixelsAreThoseThatNoCellOutsideReaches) {
    for (const Case& c : kCases) {
        SCOPED_TRACE(::testing::Message() << c.width << " x " << c.height << ", " << c.reach);
        const FilmGrid grid(c.width, c.height, c.reach);
        const std::int64_t all = std::int64_t{1} << grid.level();
        for (const auto& [first, last] :
             {std::pair{std::int64_t{0}, all}, {all / 4, all / 2}, {all / 2, all}, {all / 2, all / 2 + 1}}) {
            const PixelRect cells{first, 0, last, all};
            const PixelRect pixels = grid.inner_pixels(cells), inner = grid.inner_cells(cells);
            for (std::int64_t x = 0; x < c.width; ++x) {
                bool outside = false;
                for (std::int64_t cell = 0; cell < all; ++cell) outside |= (cell < first || cell >= last) && reaches(grid, cell, x);
                ASSERT_TRUE(outside || (x >= pixels.x0 && x < pixels.x1)) << x;
                ASSERT_TRUE(!outside || x < pixels.x0 || x >= pixels.x1) << x;
            }
            for (std::int64_t cell = first; cell < last; ++cell) {
                const PixelRect window = grid.window(static_cast<std::uint32_t>(cell), 0);
                ASSERT_EQ(cell >= inner.x0 && cell < inner.x1, window.x0 >= pixels.x0 && window.x1 <= pixels.x1) << cell;
            }
        }
    }
}

}  // namespace
}  // namespace latent::develop
