#include "tools/convert/inspection.h"

#include <cmath>

#include "color/oklab.h"

namespace latent::convert {

void HueShifts::take_larger(double degrees, int at_x, int at_y) {
    const bool first = degrees == largest_degrees && (at_y < y || (at_y == y && at_x < x));
    if (degrees > largest_degrees || (degrees > 0 && first)) largest_degrees = degrees, x = at_x, y = at_y;
}

void HueShifts::add(double degrees, int at_x, int at_y) {
    above_10_degrees += degrees > 10;
    take_larger(degrees, at_x, at_y);
}

HueShifts& HueShifts::operator+=(const HueShifts& other) {
    above_10_degrees += other.above_10_degrees;
    take_larger(other.largest_degrees, other.x, other.y);
    return *this;
}

void find_hue_shifts(const color::Print& print, const color::RgbSpace& space, const InspectedRow& row, HueShifts& shifts) {
    constexpr double kMinChroma = 0.02;  // greys have no hue
    const auto oklab = [&](double r, double g, double b) {
        const std::array<double, 3> xyz = space.xyz_from_rgb * std::array{r, g, b};
        return color::oklab_from_xyz({xyz[0], xyz[1], xyz[2]});
    };
    for (std::size_t i = 0; i < row.x.size(); ++i) {
        const auto before = print.unmapped({row.x[i], row.y[i], row.z[i]});
        if (!before || !print.out_of_gamut(*before)) continue;
        const color::Oklab from = oklab(before->r, before->g, before->b), to = oklab(row.red[i], row.green[i], row.blue[i]);
        if (from.chroma() < kMinChroma || to.chroma() < kMinChroma) continue;
        shifts.add(std::abs(std::remainder(to.hue_degrees() - from.hue_degrees(), 360)), row.first_x + static_cast<int>(i),
                   row.row_y);
    }
}

void mark_clipped(const color::Print& print, const color::RgbSpace& space, const InspectedRow& row) {
    const auto& m = space.luminance_row;
    for (std::size_t i = 0; i < row.x.size(); ++i) {
        const auto put = [&](float r, float g, float b) { row.red[i] = r, row.green[i] = g, row.blue[i] = b; };
        const auto out_of_gamut = [&] {
            if (!row.lacking.empty()) return row.lacking[i] != 0;
            const auto unmapped = print.unmapped({row.x[i], row.y[i], row.z[i]});
            return unmapped && print.out_of_gamut(*unmapped);
        };
        if (row.luminance[i] > print.range().burnt) {
            put(1, 0, 0);
        } else if (!(row.luminance[i] >= print.range().black)) {
            put(0, 0, 1);
        } else if (out_of_gamut()) {
            put(1, 0, 1);
        } else {
            const double grey = m[0] * static_cast<double>(row.red[i]) + m[1] * static_cast<double>(row.green[i]) +
                                m[2] * static_cast<double>(row.blue[i]);
            put(static_cast<float>(grey), static_cast<float>(grey), static_cast<float>(grey));
        }
    }
}

}  // namespace latent::convert
