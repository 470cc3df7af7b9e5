// The lattice of pixels: every pass visits every pixel once, positions stay in their pixels, and each pixel's samples fill it
// evenly.
#include "sampledb/data/pixel_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace latent::sampledb {
namespace {

struct Size {
    std::uint32_t width, height;
};
constexpr Size kSizes[] = {{1, 1}, {1, 7}, {64, 64}, {60, 34}, {50, 50}, {97, 13}, {640, 360}};

PositionSamplerSpec pixels(Size size, std::uint64_t seed = 0x9ABCDEF012345678u) {
    return {PositionSampler::kPixels, static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), size.width,
            size.height};
}

TEST(PixelLattice, EveryPassVisitsEveryPixelOnce) {
    for (const Size size : kSizes) {
        const PixelLattice lattice(pixels(size));
        const std::uint64_t count = std::uint64_t{size.width} * size.height;
        for (const std::uint64_t pass : {std::uint64_t{0}, std::uint64_t{5}, (std::uint64_t{1} << 40) / count}) {
            std::vector<int> visits(count);
            for (std::uint64_t n = pass * count; n < (pass + 1) * count; ++n) {
                const PixelLattice::Place place = lattice.place(n);
                ASSERT_LT(place.x, size.width);
                ASSERT_LT(place.y, size.height);
                ASSERT_EQ(place.pass, pass);
                ASSERT_EQ(lattice.sample(place), n);
                ++visits[std::uint64_t{place.y} * size.width + place.x];
            }
            EXPECT_TRUE(std::ranges::all_of(visits, [](int v) { return v == 1; })) << size.width << " x " << size.height;
        }
    }
}

TEST(PixelLattice, IsExactForTheLargestFilms) {
    std::mt19937_64 random(1);
    for (const Size size :
         {Size{1u << 20, 1u << 20}, Size{(1u << 20) - 1, (1u << 20) - 3}, Size{1u << 20, 1}, Size{999'983, 1'000'003}}) {
        const PixelLattice lattice(pixels(size));
        const unsigned __int128 count = std::uint64_t{size.width} * size.height;
        const auto pixel_of = [&](std::uint64_t n) { return lattice.place(n).y * std::uint64_t{size.width} + lattice.place(n).x; };
        const unsigned __int128 step = pixel_of(1) + count - pixel_of(0);
        for (int i = 0; i < 10'000; ++i) {
            const std::uint64_t n = random();
            const PixelLattice::Place place = lattice.place(n);
            ASSERT_EQ(place.y * std::uint64_t{size.width} + place.x,
                      static_cast<std::uint64_t>((n % count * (step % count) + pixel_of(0)) % count));
            ASSERT_EQ(lattice.sample(place), n);
        }
    }
}

// At its own size, and at every other: the pixel of a position is the one that the lattice means, at the ends of its range, too.
TEST(PixelLattice, PositionsLieInTheirPixels) {
    std::mt19937_64 random(2);
    for (const Size size : {Size{1, 1}, Size{3, 7}, Size{640, 360}, Size{1u << 20, 999'983}}) {
        const PixelLattice lattice(pixels(size));
        for (int i = 0; i < 100'000; ++i) {
            const PixelLattice::Place place = lattice.place(random() >> (i % 40));
            const FilmPosition at = lattice.position(place);
            ASSERT_EQ(std::uint64_t{at.u} * size.width >> 32, place.x);
            ASSERT_EQ(std::uint64_t{at.v} * size.height >> 32, place.y);
        }
    }
}

// The first 2^m samples of a pixel meet each of the 2^m equal rectangles of any shape once.
TEST(PixelLattice, SamplesOfAPixelAreAZeroTwoSequence) {
    const Size size{5, 3};
    const PixelLattice lattice(pixels(size));
    constexpr int kBits = 8;
    for (const std::uint64_t begin : {0u, 256u, 1024u}) {
        for (int a = 0; a <= kBits; ++a) {
            std::set<std::uint64_t> cells;
            for (std::uint64_t pass = begin; pass < begin + (1u << kBits); ++pass) {
                const FilmPosition at = lattice.position({2, 1, pass});
                const std::uint64_t x = std::uint64_t{at.u} * size.width - (std::uint64_t{2} << 32);
                const std::uint64_t y = std::uint64_t{at.v} * size.height - (std::uint64_t{1} << 32);
                cells.insert(((x + size.width) >> (32 - a)) << kBits | (y + size.height) >> (32 - (kBits - a)));
            }
            EXPECT_EQ(cells.size(), std::size_t{1} << kBits) << a;
        }
    }
}

// A part of a pass fills the film evenly: among 16 x 9 blocks of 40 x 40 pixels, none gets more than a third too many or too few of
// any 1/16 of a pass.
TEST(PixelLattice, PartsOfAPassFillTheFilmEvenly) {
    const PixelLattice lattice(pixels({640, 360}));
    constexpr std::uint64_t kPart = 640 * 360 / 16, kExpected = kPart / (16 * 9);
    for (const std::uint64_t first : {0u, 1000u, 123'456u, 230'000u}) {
        std::vector<std::uint64_t> count(16 * 9);
        for (std::uint64_t n = first; n < first + kPart; ++n) {
            const PixelLattice::Place place = lattice.place(n);
            ++count[place.y / 40 * 16 + place.x / 40];
        }
        const auto [least, most] = std::ranges::minmax(count);
        EXPECT_GT(least * 3, kExpected * 2) << first;
        EXPECT_LT(most * 3, kExpected * 4) << first;
    }
}

TEST(PixelLattice, SeedsAndPixelsHaveShiftsOfTheirOwn) {
    const Size size{64, 64};
    const PixelLattice a(pixels(size, 1)), b(pixels(size, 2));
    std::set<std::uint32_t> fractions;
    for (std::uint64_t n = 0; n < 4096; ++n) {
        for (const PixelLattice* lattice : {&a, &b}) fractions.insert(lattice->position(lattice->place(n)).u << 6);
    }
    EXPECT_GT(fractions.size(), 8180u);  // of 8192 numbers of 26 bits
}

TEST(PixelLattice, NumbersOfABlockAreOneForEachPlace) {
    const PixelLattice lattice(pixels({60, 34}));
    for (const FilmNode& node : {FilmNode{0, 0, 0}, FilmNode{3, 7, 2}, FilmNode{9, 300, 511}}) {
        const PixelLattice::Block block = lattice.block(node);
        ASSERT_LE(block.x + block.width, 60u);
        ASSERT_LE(block.y + block.height, 34u);
        for (std::uint64_t number = 0; number < 3 * std::uint64_t{block.width} * block.height; ++number) {
            const PixelLattice::Place place = block.place(number, 17);
            ASSERT_TRUE(block.holds(place));
            ASSERT_EQ(block.number(place, 17), number);
            ASSERT_EQ(place.pass, 17 + number / block.width / block.height);
        }
    }
}

// A block holds the pixel of every position in its square.
TEST(PixelLattice, BlocksHoldThePixelsOfTheirSquares) {
    std::mt19937_64 random(3);
    for (const Size size : kSizes) {
        const PixelLattice lattice(pixels(size));
        for (int i = 0; i < 20'000; ++i) {
            const PixelLattice::Place place = lattice.place(random() >> 20);
            const FilmPosition at = lattice.position(place);
            const int level = static_cast<int>(random() % 17);
            const auto cell = [&](std::uint32_t x) { return level == 0 ? 0 : x >> (32 - level); };
            ASSERT_TRUE(lattice.block({static_cast<std::uint8_t>(level), cell(at.u), cell(at.v)}).holds(place));
        }
    }
}

}  // namespace
}  // namespace latent::sampledb
