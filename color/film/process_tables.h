// color/film/process_tables.h: a film and its print as tables, for process_row.h.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "color/film/stock.h"

namespace latent::film {

// y(x), linear between entries 1/`per_unit` apart, from `first` on; level outside.
struct Table1 {
    float first = 0, per_unit = 1;
    std::vector<float> y;
};

// f at `first`, `first` + step, ... to `last` and beyond.
Table1 tabulated(double first, double last, double step, const std::function<double(double)>& f);

// Three numbers, each added up from the tables of three layers: v = y_r(x_r) + y_g(x_g) + y_b(x_b).
struct LayerTables {
    std::array<float, 4> first{}, per_unit{}, last{};  // by layer; `last`: just below the last place
    std::array<std::vector<float>, 3> y;  // by layer; eight for each place: four numbers, and what the next place has more

    bool empty() const { return y[0].empty(); }
};

// Each layer has the number of its own.
LayerTables layer_by_layer(const std::array<Table1, 3>& tables);
// How much layers that form these amounts, by log exposure, move their log exposures: Stock::coupled.
LayerTables coupling_tables(const std::array<Table1, 3>& amounts, const Coupling& coupling, double sign);

// Three numbers for three numbers, linear in each between kNodes equidistant places; level outside.
struct Table3 {
    static constexpr int kNodes = 65;
    std::array<float, 4> first{}, per_unit{}, last{};  // as of LayerTables
    std::vector<float> v;                              // three for each place, the last axis runs fastest; and one more, not used

    bool empty() const { return v.empty(); }
};

// log10 of the integrals of light 10^-density by three weights, over amounts of dye from `least` to `most`.
Table3 integrals_by_amounts(const Stock& stock, const Curve& light, const Curves& weights, const Triple& least, const Triple& most);

// Steps that are empty are left out.
struct ProcessTables {
    bool mono = false;                                       // the first layer stands for all three
    LayerTables coupling;                                    // added to the log10 exposures
    LayerTables film;                                        // amounts by log10 exposure
    Table3 through;                                          // amounts to log10 exposures of the print, or to log10 XYZ
    std::array<float, 4> slope{1, 1, 1}, offset{};           // applied to these
    LayerTables print;                                       // amounts of the print by log10 exposure; mono: log10 Y
    Table3 look;                                             // amounts of the print to log10 XYZ
    std::array<float, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};  // from 10^ of these to XYZ
};

}  // namespace latent::film
