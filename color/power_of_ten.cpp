#include "color/power_of_ten.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace latent::color {

// x = n + f, |f| <= 1/2; the series of e^(f ln 10) ends below 1e-17.
double power_of_ten(double x) {
    const double n = std::round(std::clamp(x, -400.0, 400.0)), t = (std::clamp(x, -400.0, 400.0) - n) * std::numbers::ln10;
    double sum = 1, term = 1;
    for (int i = 1; i < 22; ++i) sum += term *= t / i;
    for (int i = 0; i < std::abs(n); ++i) sum = n > 0 ? sum * 10 : sum / 10;
    return sum;
}

double power_of_e(double x) { return power_of_ten(x / std::numbers::ln10); }

}  // namespace latent::color
