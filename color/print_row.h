// color/print_row.h: the print's inner loop over planes, one source for every vector width. Only color/print.cpp calls it.
#pragma once

#include <array>
#include <cstddef>

#include "color/print.h"

namespace latent::color {

// How far a component may leave [0,1] in rounding before it counts as out of gamut; less than one step of 16 bits.
inline constexpr double kGamutMargin = 1e-5;

// What a row needs to know, in the precision it is used with.
struct PrintRowConstants {
    float sigma;
    Tone tone;
    Gamut gamut;
    bool adapted;                 // y_row is not (0,1,0)
    std::array<double, 3> y_row;  // y after adaptation, summed in double: it may be a small difference of large terms
    std::array<float, 9> rgb_from_xyz;
    std::array<float, 3> luminance_row;
    const float* curve;  // ToneCurve::table
    PrintableRange range;
    float* luminances;  // one per pixel; may be null
};

void print_row(const PrintRowConstants& constants, const float* x, const float* y, const float* z, float* r, float* g, float* b,
               std::size_t count, PrintReport& report);

}  // namespace latent::color
