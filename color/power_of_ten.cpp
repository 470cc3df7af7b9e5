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

// x = 2^n m, 1/sqrt 2 <= m < sqrt 2; ln m = 2 (s + s^3/3 + s^5/5 + ...) of s = (m - 1) / (m + 1), whose series ends below 1e-19.
double log10_of(double x) {
    int n = 0;
    double m = std::frexp(x, &n);
    if (m < 1 / std::numbers::sqrt2) m *= 2, --n;
    const double s = (m - 1) / (m + 1), square = s * s;
    double sum = 0, power = s;
    for (int i = 1; i < 24; i += 2, power *= square) sum += power / i;
    return (n * std::numbers::ln2 + 2 * sum) / std::numbers::ln10;
}

double power_of_e(double x) { return power_of_ten(x / std::numbers::ln10); }

}  // namespace latent::color
