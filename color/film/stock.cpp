#include "color/film/stock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "color/film/dyes.h"
#include "color/film/push.h"
#include "color/power_of_ten.h"

namespace latent::film {
namespace {

constexpr double kShoulder = 0.5;  // amount that a negative still gains beyond the end of its plot

// The nearest non-decreasing sequence: pool adjacent violators.
std::vector<double> rising(const std::vector<double>& y) {
    std::vector<std::pair<double, int>> blocks;
    for (const double v : y) {
        blocks.emplace_back(v, 1);
        while (blocks.size() > 1 && blocks[blocks.size() - 2].first > blocks.back().first) {
            const auto [last, n1] = blocks.back();
            blocks.pop_back();
            auto& [mean, n0] = blocks.back();
            mean = (mean * n0 + last * n1) / (n0 + n1);
            n0 += n1;
        }
    }
    std::vector<double> out;
    for (const auto& [mean, n] : blocks) out.insert(out.end(), static_cast<std::size_t>(n), mean);
    return out;
}

std::vector<double> monotone(std::vector<double> y, bool falling) {
    if (!falling) return rising(y);
    for (double& v : y) v = -v;
    y = rising(y);
    for (double& v : y) v = -v;
    return y;
}

Curve with_dyes(const Curve& base, const Curves& dyes, const Triple& a) {
    Curve out;
    for (std::size_t i = 0; i < kNm; ++i) out[i] = base[i] + a[0] * dyes[0][i] + a[1] * dyes[1][i] + a[2] * dyes[2][i];
    return out;
}

Triple integral_densities(const Curve& density, const Curves& weights) {
    const Curve t = transmittance(density);
    Triple out;
    for (std::size_t k = 0; k < 3; ++k) out[k] = -color::log10_of(dot(t, weights[k]));
    return out;
}

// A curve with values at 645, 540 and 445 nm (r, g, b), level outside.
Curve through(const Triple& nodes) {
    const std::array nm{445.0, 540.0, 645.0}, y{nodes[2], nodes[1], nodes[0]};
    return sampled(nm, y);
}

// Relative spectral sensitivities as the table has them, -9 = none.
Curves sensitivities_of(const Columns& table) {
    Curves out{};
    const std::vector<double>& nm = table.values[0];
    constexpr const char* kLayers[] = {"log10_r", "log10_g", "log10_b"};
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> s;
        for (const double log_s : table[kLayers[c]]) s.push_back(log_s > -9 ? color::power_of_ten(log_s) : 0);
        for (std::size_t i = 0; i < kNm; ++i) {
            const double at = kFirstNm + static_cast<double>(i);
            if (at >= nm.front() && at <= nm.back()) out[c][i] = interpolated(at, nm, s);
        }
    }
    return out;
}

}  // namespace

Triple unmixed(const Triple& target, const Curve& base, const Curves& dyes, const Curves& weights, Triple a) {
    for (int step = 0; step < 40; ++step) {
        const Curve t = transmittance(with_dyes(base, dyes, a));
        std::array<Triple, 3> jacobian;  // derivatives of -log10 of the integrals
        Triple missing;
        for (std::size_t k = 0; k < 3; ++k) {
            Curve weighted;
            for (std::size_t i = 0; i < kNm; ++i) weighted[i] = t[i] * weights[k][i];
            const double integral = std::accumulate(weighted.begin(), weighted.end(), 0.0);
            for (std::size_t j = 0; j < 3; ++j) jacobian[k][j] = dot(weighted, dyes[j]) / integral;
            missing[k] = target[k] + color::log10_of(integral);
        }
        const Triple change = solve(jacobian, missing);
        for (std::size_t j = 0; j < 3; ++j) a[j] += std::clamp(change[j], -0.5, 0.5);
        if (std::abs(change[0]) + std::abs(change[1]) + std::abs(change[2]) < 1e-13) break;
    }
    return a;
}

double shoulder(double beyond, double contrast) { return kShoulder * (1 - color::power_of_e(-beyond * contrast / kShoulder)); }

double inverted(std::span<const double> h, std::span<const double> y, double at) {
    const double sign = y.back() > y.front() ? 1 : -1;
    std::vector<double> rising_y;
    for (const double v : y) rising_y.push_back(sign * v);
    return interpolated(sign * at, rising_y, h);
}

Result<Stock> Stock::make(const Material& material) {
    const Result<Columns> sensitivity = need_table(material, "sensitivity", {"log10_r", "log10_g", "log10_b"});
    if (!sensitivity) return sensitivity.error();
    const Result<Columns> curves = need_table(material, "curves", {"r", "g", "b"});
    if (!curves) return curves.error();
    Result<Dyes> dyes = dyes_of(material);
    if (!dyes) return dyes.error();

    Stock stock;
    stock.material_ = material;
    stock.h_ = curves->values[0];
    const std::array densities{(*curves)["r"], (*curves)["g"], (*curves)["b"]};
    stock.sensitivity_ = sensitivities_of(*sensitivity);
    for (std::size_t c = 0; c < 3; ++c) {
        // Camera films: the balance light with Y = 1 exposes every layer by 1. Prints: the sensitivity is the reciprocal of the
        // exposure for density 1 above the least, so that exposures are those of the curves.
        const double least = std::ranges::min(densities[c]);
        const double scale = material.in_camera() ? 1 / dot(light(material.balance), stock.sensitivity_[c])
                                                  : color::power_of_ten(inverted(stock.h_, densities[c], least + 1));
        for (double& s : stock.sensitivity_[c]) s *= scale;
    }
    stock.dyes_ = dyes->unit;
    stock.separation_rms_ = dyes->separation_rms;
    stock.weights_ = densitometer(material.status);

    const Triple least{std::ranges::min(densities[0]), std::ranges::min(densities[1]), std::ranges::min(densities[2])};
    stock.base_ = dyes->base.value_or(through(least));
    for (int i = 0; i < 5; ++i) {  // the dyes and the curves were plotted of two samples: follow the curves
        const Triple read = integral_densities(stock.base_, stock.weights_);
        const Curve correction = through({least[0] - read[0], least[1] - read[1], least[2] - read[2]});
        for (std::size_t j = 0; j < kNm; ++j) stock.base_[j] += correction[j];
    }
    for (std::size_t i = 0; i < stock.h_.size(); ++i) {
        const Triple a = unmixed({densities[0][i], densities[1][i], densities[2][i]}, stock.base_, stock.dyes_, stock.weights_);
        for (std::size_t c = 0; c < 3; ++c) stock.amount_[c].push_back(a[c]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double>& a = stock.amount_[c];
        a = monotone(std::move(a), material.positive());
        if (material.kind != Kind::kNegative) continue;
        std::size_t end = a.size() - 1;
        while (end > 8 && a[end] - a[end - 1] <= 1e-9) --end;
        stock.shoulder_from_[c] = stock.h_[end];
        stock.shoulder_slope_[c] = (a[end] - a[end - 8]) / (stock.h_[end] - stock.h_[end - 8]);
    }
    return stock;
}

Stock Stock::pushed(double stops) const {
    Stock out = *this;
    out.push_ += stops;
    return out;
}

double Stock::amount(std::size_t layer, double h) const {
    h += push_speed(push_);
    double a = interpolated(h, h_, amount_[layer]);
    if (material_.kind == Kind::kNegative && h > shoulder_from_[layer])
        a += shoulder(h - shoulder_from_[layer], shoulder_slope_[layer]);
    return push_contrast(push_) * a;
}

Triple Stock::amounts(const Triple& h) const { return {amount(0, h[0]), amount(1, h[1]), amount(2, h[2])}; }

double Stock::exposure_for(std::size_t layer, double amount) const {
    return inverted(h_, amount_[layer], amount / push_contrast(push_)) - push_speed(push_);
}

Triple Stock::min_amounts() const {
    Triple least;
    for (std::size_t c = 0; c < 3; ++c) least[c] = push_contrast(push_) * std::ranges::min(amount_[c]);
    return least;
}

Triple Stock::max_amounts() const {
    const double more = material_.kind == Kind::kNegative ? kShoulder : 0;
    Triple most;
    for (std::size_t c = 0; c < 3; ++c) most[c] = push_contrast(push_) * (std::ranges::max(amount_[c]) + more);
    return most;
}

Triple Stock::coupled(const Triple& h, const Coupling& coupling) const {
    const double sign = material_.positive() ? -1 : 1;
    Triple out = h;
    for (std::size_t i = 0; i < 3; ++i) {
        double held = 0;
        for (std::size_t j = 0; j < 3; ++j) held += coupling.between(i, j) * (amount(j, h[j]) - amount(j, h[i]));
        out[i] -= sign * held;
    }
    return out;
}

Coupling Stock::usual_coupling() const {
    if (material_.kind == Kind::kNegative) return {0.20, 0.10};
    if (material_.kind == Kind::kReversal) return {0.06, 0.03};
    return {};
}

Curve Stock::density(const Triple& amounts) const { return with_dyes(base_, dyes_, amounts); }

Triple Stock::integral_density(const Triple& amounts) const { return integral_densities(density(amounts), weights_); }

}  // namespace latent::film
