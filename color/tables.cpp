#include "color/tables.h"

#include <algorithm>
#include <cassert>

namespace latent::color {

std::vector<double> Table::column(std::string_view column_name) const {
    const auto found = std::ranges::find(columns, column_name);
    assert(found != columns.end());
    std::vector<double> out(rows());
    for (std::size_t row = 0; row < rows(); ++row) out[row] = at(row, static_cast<std::size_t>(found - columns.begin()));
    return out;
}

const Table& table(std::string_view name) {
    const auto found = std::ranges::find(tables(), name, &Table::name);
    assert(found != tables().end());
    return *found;
}

}  // namespace latent::color
