#include "color/film/blur.h"

#include <fmt/format.h>

#include <cmath>

namespace latent::film {

Result<Triple> half_contrast(const Material& film) {
    const Result<std::optional<Columns>> table = find_table(film, "mtf");
    if (!table) return table.error();
    if (!*table) return Error{ErrorCode::kUnsupported, film.title + ": its sharpness is not known; leave out --mtf"};
    const std::vector<double>& f = (*table)->values[0];
    Triple half{};
    constexpr const char* kLayer[] = {"r", "g", "b"};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double>& left = (**table)[kLayer[c]];
        std::size_t i = 0;
        while (i < f.size() && left[i] > 0.5) ++i;
        if (i == f.size()) {  // the plot ends above
            half[c] = f.back() * std::sqrt(left.back() / (1 - left.back()));
        } else if (i == 0) {
            half[c] = f.front() * std::sqrt(left.front() / (1 - left.front()));
        } else {
            half[c] = f[i - 1] + (f[i] - f[i - 1]) * (left[i - 1] - 0.5) / (left[i - 1] - left[i]);
        }
        if (!(half[c] > 0) || !std::isfinite(half[c]))
            return Error{ErrorCode::kCorrupt, fmt::format("{}: its MTF of layer {} does not fall", film.title, kLayer[c])};
    }
    return half;
}

double contrast_left(double half, double cycles_per_mm) {
    const double x = cycles_per_mm / half;
    return 1 / (1 + x * x);
}

double returned_light(double um) {
    constexpr double kThickness = 125, kReach = 8 * kThickness;  // um, of the base
    constexpr double kIndex = 1.48, kInside = 0.04;              // reflected below the critical angle
    if (um > kReach) return 0;
    const double tan = um / (2 * kThickness), cos2 = 1 / (1 + tan * tan);
    const bool total = (1 - cos2) * kIndex * kIndex >= 1;  // sin^2 of the angle of exit
    return (total ? 1 : kInside) * cos2 * cos2;
}

Triple returned_share(const Material& film, bool bare) {
    if (!film.colour) return bare ? Triple{0.1, 0.1, 0.1} : Triple{0.02, 0.02, 0.02};
    return bare ? Triple{0.1, 0.04, 0.01} : Triple{0.02, 0.006, 0};
}

}  // namespace latent::film
