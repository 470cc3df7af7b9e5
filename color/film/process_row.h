// color/film/process_row.h: the film's inner loop over planes, one source for every vector width. Only process.cpp calls it.
#pragma once

#include <array>
#include <cstddef>

#include "color/film/process_tables.h"

namespace latent::film {

// Grain of a row: standard normal noise for each layer, and how much of it a density shows. In black and white, of the first layer
// alone.
struct GrainRow {
    std::array<const float*, 3> noise;
    const LayerTables* sigma;  // by amount
};

void process_row(const ProcessTables& tables, float scale, const std::array<const float*, 3>& in, const std::array<float*, 3>& out,
                 std::size_t count, const GrainRow* grain);

}  // namespace latent::film
