#include "tools/convert/luminances.h"

#include <cmath>

namespace latent::convert {

// The curve's inverse at half a step from its ends.
color::PrintableRange printable_range(const color::Transfer& transfer, color::Tone tone, double sigma) {
    const auto luminance = [&](double code) {
        const double printed = transfer.decode(code / 255);
        return static_cast<float>((tone == color::Tone::kFilm ? -std::log2(1 - printed) : printed) / sigma);
    };
    return {luminance(0.5), luminance(254.5)};
}

Luminances& Luminances::operator+=(const Luminances& other) {
    histogram += other.histogram;
    counts += other.counts;
    return *this;
}

}  // namespace latent::convert
