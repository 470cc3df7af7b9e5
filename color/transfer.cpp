#include "color/transfer.h"

#include <cmath>

namespace latent::color {

Transfer Transfer::srgb() { return {12.92, 0.0031308, 1.055, 1 / 2.4}; }

Transfer Transfer::rec2020() {
    // alpha and beta solve: the two pieces meet with equal value and slope.
    constexpr double kAlpha = 1.09929682680944, kBeta = 0.018053968510807;
    return {4.5, kBeta, kAlpha, 0.45};
}

double Transfer::encode(double linear_value) const {
    if (is_linear()) return linear_value;
    const double x = std::abs(linear_value);
    const double encoded = x < linear_below ? slope * x : scale * std::pow(x, exponent) - (scale - 1);
    return std::copysign(encoded, linear_value);
}

double Transfer::decode(double encoded_value) const {
    if (is_linear()) return encoded_value;
    const double v = std::abs(encoded_value);
    const double x = v < slope * linear_below ? v / slope : std::pow((v + (scale - 1)) / scale, 1 / exponent);
    return std::copysign(x, encoded_value);
}

}  // namespace latent::color
