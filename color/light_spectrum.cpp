#include "color/light_spectrum.h"

#include <algorithm>
#include <cmath>

#include "color/observer.h"

namespace latent::color {

namespace {

constexpr double kNarrowestLine = 0.05;  // nm

}  // namespace

bool has_fine_lines(const Spectrum& s) {
    const auto lambda = s.lambda_nm();
    for (std::size_t i = 1; i < lambda.size(); ++i) {
        if (lambda[i] - lambda[i - 1] < 1 && lambda[i] > kLambdaMin && lambda[i - 1] < kLambdaMax) return true;
    }
    return false;
}

Spectrum with_lines_widened(const Spectrum& s) {
    std::vector<double> lambda(s.lambda_nm().begin(), s.lambda_nm().end());
    std::vector<double> value(s.values().begin(), s.values().end());
    const bool ends = s.outside() == Outside::kZero;
    for (std::size_t next = 0; next < lambda.size();) {
        std::size_t first = next++;
        if (value[first] == 0) continue;
        while (next < lambda.size() && value[next] != 0) ++next;
        std::size_t last = next - 1;
        if (!ends && (first == 0 || next == lambda.size())) continue;
        if (first > 0) --first;
        if (next < lambda.size()) last = next;
        const double width = lambda[last] - lambda[first];
        if (!(width > 0 && width < kNarrowestLine)) continue;
        const double middle = 0.5 * (lambda[first] + lambda[last]), stretch = kNarrowestLine / width;
        for (std::size_t i = first; i <= last; ++i) {
            lambda[i] = middle + (lambda[i] - middle) * stretch;
            value[i] /= stretch;
        }
    }
    // Lines so near to each other that they now overlap are left as they were.
    const Result<Spectrum> widened = Spectrum::from_samples(std::move(lambda), std::move(value), s.outside());
    return widened ? *widened : s;
}

double luminance(const Spectrum& s) {
    if (!has_fine_lines(s)) return photometric_sum(s);
    const auto y_bar = [](double nm) { return Observer::cie1931().at(nm)[1]; };
    double sum = 0;
    // Simpson's rule from whole nm to whole nm, where both functions are straight.
    const auto add = [&](double from, double value_from, double to, double value_to) {
        const auto product = [&](double nm) {
            return (value_from + (nm - from) / (to - from) * (value_to - value_from)) * y_bar(nm);
        };
        const double end = std::min(to, kLambdaMax);
        for (double a = std::max(from, kLambdaMin); a < end;) {
            const double b = std::min(std::floor(a) + 1, end);
            sum += (b - a) / 6 * (product(a) + 4 * product(0.5 * (a + b)) + product(b));
            a = b;
        }
    };
    const auto nm = s.lambda_nm(), value = s.values();
    const auto knot = [&](std::size_t i) {
        return static_cast<double>(static_cast<float>(nm[i]));
    };  // tables of lights hold floats
    for (std::size_t i = 0; i + 1 < nm.size(); ++i) add(knot(i), value[i], knot(i + 1), value[i + 1]);
    if (s.outside() == Outside::kClamped) {
        add(kLambdaMin, value.front(), knot(0), value.front());
        add(knot(nm.size() - 1), value.back(), kLambdaMax, value.back());
    }
    return sum;
}

}  // namespace latent::color
