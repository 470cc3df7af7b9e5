// color/film/process_row.h: the film's inner loop over planes, one source for every vector width. Only process.cpp calls it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace latent::film {

// y(x), linear between entries 1/`per_unit` apart, from `first` on; level outside.
struct Table1 {
    float first = 0, per_unit = 1;
    std::vector<float> y;
};

// Three numbers for three numbers, linear in each between kNodes equidistant places; level outside.
struct Table3 {
    static constexpr int kNodes = 33;
    std::array<float, 3> first{}, per_unit{};
    std::vector<float> v;  // three for each place, the last axis runs fastest

    static std::size_t place(std::size_t i, std::size_t j, std::size_t k) { return 3 * ((i * kNodes + j) * kNodes + k); }
};

struct ProcessTables {
    bool mono = false;                // the first layer is all there is
    std::array<Table1, 3> film;       // amounts by log10 exposure
    std::array<float, 3> coupling{};  // red and green, green and blue, red and blue; signed
    std::array<float, 3> shift{};     // of the log exposures, after coupling
    Table3 through;                   // amounts to log10 exposures of the print; or to log10 XYZ; none: amounts are densities
    std::array<float, 3> slope{1, 1, 1}, offset{};           // applied to these
    std::array<Table1, 3> print;                             // amounts of the print by log10 exposure; mono: log10 Y; may be empty
    Table3 look;                                             // amounts of the print to log10 XYZ; may be empty
    std::array<float, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};  // from 10^ of these to XYZ
};

// Grain of a row: standard normal noise for each layer, and how much of it a density shows.
struct GrainRow {
    std::array<const float*, 3> noise;
    const std::array<Table1, 3>* sigma;  // by amount
};

void process_row(const ProcessTables& tables, float scale, const std::array<const float*, 3>& in, const std::array<float*, 3>& out,
                 std::size_t count, const GrainRow* grain);

}  // namespace latent::film
