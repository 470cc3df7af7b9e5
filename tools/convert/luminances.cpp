#include "tools/convert/luminances.h"

#include <cmath>

namespace latent::convert {

void adapted_luminances(const std::array<double, 3>& y_row, std::span<const float> x, std::span<const float> y,
                        std::span<const float> z, std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double adapted =
            y_row[0] * static_cast<double>(x[i]) + y_row[1] * static_cast<double>(y[i]) + y_row[2] * static_cast<double>(z[i]);
        out[i] = std::isfinite(adapted) ? static_cast<float>(adapted) : y[i];
    }
}

// The curve's inverse at half a step from its ends.
PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, double sigma) {
    const auto luminance = [&](double code) {
        const double printed = transfer.decode(code / 255);
        return static_cast<float>((tone == color::Tone::kFilm ? -std::log2(1 - printed) : printed) / sigma);
    };
    return {luminance(0.5), luminance(254.5)};
}

void Luminances::add(std::span<const float> y, const PrintableRange& range) {
    histogram.add(y);
    for (const float value : y) {
        dark += value <= 0;
        black += value < range.black;
        burnt += value >= range.burnt;
    }
}

Luminances& Luminances::operator+=(const Luminances& other) {
    histogram += other.histogram;
    dark += other.dark;
    black += other.black;
    burnt += other.burnt;
    return *this;
}

}  // namespace latent::convert
