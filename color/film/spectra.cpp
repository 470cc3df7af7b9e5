#include "color/film/spectra.h"

#include <algorithm>
#include <cassert>

#include "base/parse.h"
#include "color/film/material.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "color/power_of_ten.h"
#include "color/tristimulus.h"

namespace latent::film {
namespace {

// Planck's law, up to a factor [CODATA18].
double blackbody(double nm, double kelvin) {
    const double micrometres = nm / 1000, square = micrometres * micrometres;
    return 1 / (square * square * micrometres * (color::power_of_e(1.438776877e7 / (nm * kelvin)) - 1));
}

}  // namespace

double interpolated(double at, std::span<const double> x, std::span<const double> y) {
    const auto above = static_cast<std::size_t>(std::ranges::upper_bound(x, at) - x.begin());
    if (above == 0) return y.front();
    if (above == x.size()) return y.back();
    const double part = (at - x[above - 1]) / (x[above] - x[above - 1]);
    return y[above - 1] + part * (y[above] - y[above - 1]);
}

Curve sampled(std::span<const double> lambda_nm, std::span<const double> y) {
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) out[i] = interpolated(kFirstNm + static_cast<double>(i), lambda_nm, y);
    return out;
}

double dot(const Curve& a, const Curve& b) {
    double sum = 0;
    for (std::size_t i = 0; i < kNm; ++i) sum += a[i] * b[i];
    return sum;
}

Curve transmittance(const Curve& density) {
    Curve out;
    std::ranges::transform(density, out.begin(), [](double d) { return color::power_of_ten(-d); });
    return out;
}

color::Spectrum light_spectrum(std::string_view name) {
    // The nominal temperatures of daylight date from c2 = 1.4380e-2 m K; c2 is 1.4388e-2 m K in [CIE15].
    if (name.starts_with('D')) return *color::daylight(*parse_number(name.substr(1)) * 100 * 1.4388 / 1.4380);
    const double kelvin = name == "A" ? 2856 : *parse_number(name.substr(0, name.size() - 1));
    return color::Spectrum::from_function([&](double nm) { return blackbody(nm, kelvin); }, color::Outside::kZero);
}

Curve light(std::string_view name) {
    const color::Spectrum spectrum = light_spectrum(name);
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) out[i] = spectrum(kFirstNm + static_cast<double>(i));
    const double luminance = dot(out, matching()[1]);
    for (double& v : out) v /= luminance;
    return out;
}

const Curves& matching() {
    static const Curves curves = [] {
        Curves out;
        for (std::size_t i = 0; i < kNm; ++i) {
            const std::array<double, 3> at = color::Observer::cie1931().at(kFirstNm + static_cast<double>(i));
            for (std::size_t c = 0; c < 3; ++c) out[c][i] = at[c];
        }
        return out;
    }();
    return curves;
}

Curves densitometer(char status) {
    const Columns table = common_table(status == 'M' ? "status_m" : "status_a");
    Curves out{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> nm, log_weight;  // -9: none, at the ends
        for (std::size_t row = 0; row < table.values[0].size(); ++row) {
            if (table.values[c + 1][row] <= -9) continue;
            nm.push_back(table.values[0][row]);
            log_weight.push_back(table.values[c + 1][row]);
        }
        double sum = 0;
        for (std::size_t i = 0; i < kNm; ++i) {
            const double at = kFirstNm + static_cast<double>(i);
            if (at < nm.front() || at > nm.back()) continue;
            sum += out[c][i] = color::power_of_ten(interpolated(at, nm, log_weight));
        }
        for (double& w : out[c]) w /= sum;
    }
    return out;
}

Curve visual_densitometer() {
    Curve out = light("A");
    for (std::size_t i = 0; i < kNm; ++i) out[i] *= matching()[1][i];
    return out;
}

double cube_root(double x) {
    double root = color::power_of_ten(color::log10_of(x) / 3);
    root -= (root * root * root - x) / (3 * root * root);  // Newton
    return root;
}

Triple lab(const Triple& xyz, const Triple& white) {
    const auto f = [](double t) { return t > 216.0 / 24389 ? cube_root(t) : (24389.0 / 27 * t + 16) / 116; };
    const double x = f(xyz[0] / white[0]), y = f(xyz[1] / white[1]), z = f(xyz[2] / white[2]);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Triple solve(const std::array<Triple, 3>& m, const Triple& y) { return color::Matrix3{m}.inverse() * y; }

}  // namespace latent::film
