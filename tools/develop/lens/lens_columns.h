// tools/develop/lens/lens_columns.h: where and when the light of records met the lens. docs/format.md, "Registry".
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::develop {

// Its place among the extra columns.
inline std::optional<std::size_t> place_of(const sampledb::Job& job, const char* column) {
    const auto found = std::ranges::find(job.extra, column, &sampledb::ExtraColumnSpec::name);
    if (found == job.extra.end()) return std::nullopt;
    return static_cast<std::size_t>(found - job.extra.begin());
}

// The same, if it holds fractions as unsigned numbers.
inline std::optional<std::size_t> place_of_fractions(const sampledb::Job& job, const char* column) {
    const std::optional<std::size_t> place = place_of(job, column);
    if (place && job.extra[*place].type == sampledb::ColumnType::kF32) return std::nullopt;
    return place;
}

// Those of lens.x and lens.y, if the job has both.
inline std::optional<std::array<std::size_t, 2>> lens_columns(const sampledb::Job& job) {
    const auto x = place_of_fractions(job, "lens.x"), y = place_of_fractions(job, "lens.y");
    if (!x || !y) return std::nullopt;
    return std::array{*x, *y};
}

// Errors: kUsage, beginning with `option`: it has not. `aovs`: what that needs.
inline Status check_lens_columns(const sampledb::Job& job, const std::string& option, const std::string& aovs = "lens") {
    if (lens_columns(job)) return {};
    return usage_error(option + ": the files do not say where light met the lens; render the scene again with --aov " + aovs +
                       ", and a camera that has a lens");
}

// The leading 8 bits of a column of unsigned numbers, of rows begin .. end-1, one after the other. In `copies` if they are wider.
inline const std::uint8_t* leading_bytes(const sampledb::ExtraColumn& column, std::size_t begin, std::size_t end,
                                         std::vector<std::uint8_t>& copies) {
    const std::size_t width = sampledb::width(column.type);
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(column.values.data());
    if (width == 1) return bytes + begin;
    copies.resize(end - begin);
    for (std::size_t i = 0; i < copies.size(); ++i) copies[i] = bytes[(begin + i) * width + width - 1];
    return copies.data();
}

// The middle of a cell of the lens, along x or y of the unit disk.
inline double middle_of_cell(std::size_t cell) { return (static_cast<double>(cell) + 0.5) / 128 - 1; }
inline std::array<double, 2> lens_point(const sampledb::Page& page, const std::array<std::size_t, 2>& columns, std::size_t row) {
    std::vector<std::uint8_t> copy;
    const auto along = [&](std::size_t column) { return middle_of_cell(*leading_bytes(page.extra[column], row, row + 1, copy)); };
    return {along(columns[0]), along(columns[1])};
}

}  // namespace latent::develop
