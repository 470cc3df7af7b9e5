// color/tables.h: the numbers of color/data, compiled in. Only color/ itself looks here. Provenance: color/data/README.md.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace latent::color {

struct Table {
    std::string_view name;          // its file below color/data, without .csv: "film/status_m"
    std::string_view what, source;  // its comments of these names
    std::span<const std::string_view> columns;
    std::span<const double> values;  // row after row

    std::size_t rows() const { return values.size() / columns.size(); }
    double at(std::size_t row, std::size_t column) const { return values[row * columns.size() + column]; }
    std::vector<double> column(std::string_view column_name) const;
};

std::span<const Table> tables();            // all of them
const Table& table(std::string_view name);  // a table that exists
std::string_view film_materials();          // the text of film/materials.csv

}  // namespace latent::color
