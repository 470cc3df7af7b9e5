#include "tools/develop/kernel/scatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "tests/color/simd_targets.h"

namespace latent::develop {
namespace {

constexpr std::size_t kCells = 5;
constexpr int kBehind = 64;  // bytes behind the columns of a cell, which belong to another

// Rows in any order of cells, some elsewhere, some of zeros.
struct MadeRows {
    std::vector<std::uint32_t> cells, u, v;
    std::vector<float> values;
    MadeRows(std::size_t count, std::size_t stride) {
        std::mt19937 random(3);
        for (std::size_t i = 0; i < count; ++i) {
            cells.push_back(i % 64 < 32 ? 2 : static_cast<std::uint32_t>(random() % (kCells + 1)));
            u.push_back(static_cast<std::uint32_t>(random())), v.push_back(static_cast<std::uint32_t>(random()));
            const bool is_zero = random() % 3 == 0;
            for (std::size_t k = 0; k < stride; ++k) {
                constexpr float kLeast = std::numeric_limits<float>::denorm_min();
                const float number = random() % 2 == 0 ? static_cast<float>(random()) : kLeast;
                values.push_back(is_zero ? (random() % 2 == 0 ? 0.0f : -0.0f) : random() % 2 == 0 ? number : -number);
            }
        }
    }
};

TEST(Scatter, IsThatOfOneRowAfterAnotherOnAllProcessors) {
    for (const std::size_t stride : {std::size_t{4}, std::size_t{7}}) {
        for (const bool drops_zeros : {false, true}) {
            for (const std::size_t count : {std::size_t{1}, std::size_t{37}, std::size_t{1003}}) {
                const MadeRows rows(count, stride);
                const auto is_kept = [&](std::size_t i, std::uint32_t cell) {
                    const auto values = rows.values.begin() + static_cast<std::ptrdiff_t>(i * stride);
                    const bool is_zero =
                        std::all_of(values, values + static_cast<std::ptrdiff_t>(stride), [](float x) { return x == 0; });
                    return rows.cells[i] == cell && !(drops_zeros && is_zero);
                };
                color::with_every_simd_target([&] {
                    std::vector<CellSpace> cells;
                    std::vector<std::vector<std::byte>> memory;
                    for (std::uint32_t cell = 0; cell < kCells; ++cell) {
                        const auto room = static_cast<std::uint32_t>(std::ranges::count(rows.cells, cell));
                        memory.emplace_back(SegmentColumns::bytes(room, stride) + kBehind, std::byte{0xAB});
                        cells.push_back({SegmentColumns::at(memory.back().data(), room), 0, room});
                    }
                    memory.emplace_back(SegmentColumns::bytes(count, stride));
                    cells.push_back({SegmentColumns::at(memory.back().data(), count), 0, static_cast<std::uint32_t>(count)});
                    scatter({rows.cells, rows.u.data(), rows.v.data(), rows.values.data(), stride}, drops_zeros, cells);
                    for (std::uint32_t cell = 0; cell < kCells; ++cell) {
                        const SegmentColumns& columns = cells[cell].columns;
                        std::uint32_t place = 0;
                        for (std::size_t i = 0; i < count; ++i) {
                            if (!is_kept(i, cell)) continue;
                            ASSERT_LT(place, cells[cell].kept);
                            ASSERT_EQ(columns.x[place], rows.u[i]);
                            ASSERT_EQ(columns.y[place], rows.v[i]);
                            ASSERT_TRUE(std::equal(columns.values + place * stride, columns.values + (place + 1) * stride,
                                                   &rows.values[i * stride]));
                            ++place;
                        }
                        ASSERT_EQ(place, cells[cell].kept);
                        ASSERT_TRUE(std::all_of(memory[cell].end() - kBehind, memory[cell].end(),
                                                [](std::byte x) { return x == std::byte{0xAB}; }));
                    }
                });
            }
        }
    }
}

TEST(Scatter, DropsRowsOfZerosAlone) {
    for (const std::size_t stride : {std::size_t{4}, std::size_t{7}}) {
        const MadeRows rows(101, stride);
        std::vector<std::byte> memory(SegmentColumns::bytes(101, stride));
        const SegmentColumns columns = SegmentColumns::at(memory.data(), 101);
        std::ranges::copy(rows.u, columns.x);
        std::ranges::copy(rows.v, columns.y);
        std::ranges::copy(rows.values, columns.values);
        const std::uint32_t left = drop_zeros(columns, 101, stride);
        std::uint32_t place = 0;
        for (std::size_t i = 0; i < 101; ++i) {
            const auto values = rows.values.begin() + static_cast<std::ptrdiff_t>(i * stride);
            if (std::all_of(values, values + static_cast<std::ptrdiff_t>(stride), [](float x) { return x == 0; })) continue;
            ASSERT_LT(place, left);
            EXPECT_EQ(columns.x[place], rows.u[i]);
            EXPECT_TRUE(std::equal(values, values + static_cast<std::ptrdiff_t>(stride), columns.values + place * stride));
            ++place;
        }
        EXPECT_EQ(place, left);
    }
}

}  // namespace
}  // namespace latent::develop
