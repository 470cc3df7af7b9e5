// tools/convert/inspection.h: a closer look at what a print does to colours, pixel by pixel. docs/converting.md, "The report".
#pragma once

#include <cstdint>
#include <span>

#include "color/print.h"

namespace latent::convert {

// Differences of hue between pixels and their prints, in OKLab, for pixels out of gamut that have a hue before and after.
struct HueShifts {
    double largest_degrees = 0;
    int x = 0, y = 0;  // where; the first of several, in the coordinates of the display window
    std::uint64_t above_10_degrees = 0;

    void add(double degrees, int at_x, int at_y);
    HueShifts& operator+=(const HueShifts& other);

 private:
    void take_larger(double degrees, int at_x, int at_y);
};

struct InspectedRow {
    std::span<const float> x, y, z;         // the picture's
    std::span<const float> luminance;       // after adaptation
    std::span<float> red, green, blue;      // the print's
    std::span<const std::uint8_t> lacking;  // 1: the device lacks this colour; empty: what is out of gamut, the print says
    int first_x = 0, row_y = 0;             // in the coordinates of the display window
};

void find_hue_shifts(const color::Print& print, const color::RgbSpace& space, const InspectedRow& row, HueShifts& shifts);

// Burnt pixels become red, black ones blue, those out of gamut magenta; all others grey.
void mark_clipped(const color::Print& print, const color::RgbSpace& space, const InspectedRow& row);

}  // namespace latent::convert
