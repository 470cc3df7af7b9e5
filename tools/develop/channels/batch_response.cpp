#include "tools/develop/channels/batch_response.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

namespace latent::develop {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kGuide = 1024;

// Knots of f(Q^-1(q)) in q, sorted: those of Q and those of the observer.
std::vector<double> knots_in_q(const sampledb::WavelengthDensity& density, const color::Observer& observer) {
    const auto knots = density.knots();
    std::vector<double> q;
    for (const auto& knot : knots) q.push_back(static_cast<double>(knot.cumulative) * 0x1p-48);
    for (const double nm : observer.lambda_nm()) {
        const double lambda = nm * 0x1p20;
        const auto above =
            std::ranges::upper_bound(knots, lambda, {}, [](const auto& knot) { return static_cast<double>(knot.lambda); });
        if (above == knots.begin() || above == knots.end()) continue;
        const auto below = above - 1;
        const double part = (lambda - below->lambda) / (static_cast<double>(above->lambda) - below->lambda);
        q.push_back((static_cast<double>(below->cumulative) + part * static_cast<double>(above->cumulative - below->cumulative)) *
                    0x1p-48);
    }
    std::ranges::sort(q);
    return q;
}

// Where in xi (units of 2^-32) the sum over a batch of k stops being linear.
std::vector<double> breaks_in_xi(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) {
    std::vector<double> breaks = {0};
    for (const double q : knots_in_q(density, observer)) {
        const double place = q * k;
        breaks.push_back((place - std::floor(place)) * 0x1p32);
    }
    std::ranges::sort(breaks);
    std::vector<double> distinct;
    for (const double b : breaks) {  // an interval without a whole xi is none
        if (!distinct.empty() && std::ceil(b) == std::ceil(distinct.back())) distinct.pop_back();
        if (std::ceil(b) < 0x1p32) distinct.push_back(b);
    }
    return distinct;
}

struct Knots {
    const sampledb::WavelengthDensity::Knot &below, &above;
};
Knots knots_about(const sampledb::WavelengthDensity& density, double q) {
    const auto knots = density.knots();
    auto above =
        std::ranges::upper_bound(knots, q * 0x1p48, {}, [](const auto& knot) { return static_cast<double>(knot.cumulative); });
    above = std::clamp(above, knots.begin() + 1, knots.end() - 1);
    return {*(above - 1), *above};
}

double wavelength_nm(const sampledb::WavelengthDensity& density, double q) {
    const auto [below, above] = knots_about(density, q);
    const double part =
        (q * 0x1p48 - static_cast<double>(below.cumulative)) / static_cast<double>(above.cumulative - below.cumulative);
    return (below.lambda + part * (static_cast<double>(above.lambda) - below.lambda)) * 0x1p-20;
}

// d lambda / d Q = 1 / p, in nm.
double nm_per_quantile(const sampledb::WavelengthDensity& density, double q) {
    const auto [below, above] = knots_about(density, q);
    return (static_cast<double>(above.lambda) - below.lambda) * 0x1p-20 /
           (static_cast<double>(above.cumulative - below.cumulative) * 0x1p-48);
}

std::array<double, 3> response(const color::Observer& observer, double nm) {
    const auto lambda = observer.lambda_nm();
    const auto f = observer.responses();
    if (nm < lambda.front() || nm > lambda.back()) return {};
    const std::size_t above = std::clamp<std::size_t>(std::ranges::upper_bound(lambda, nm) - lambda.begin(), 1, lambda.size() - 1);
    const double part = (nm - lambda[above - 1]) / (lambda[above] - lambda[above - 1]);
    std::array<double, 3> value;
    for (int c = 0; c < 3; ++c) value[c] = f[above - 1][c] + part * (f[above][c] - f[above - 1][c]);
    return value;
}

}  // namespace

BatchResponse::BatchResponse(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) : k_(k) {
    const std::vector<double> breaks = breaks_in_xi(density, k, observer);
    const std::size_t groups = (k + 3) / 4;
    table_.assign(breaks.size() * groups * kGroupFloats, 0.0f);
    for (std::size_t r = 0; r < breaks.size(); ++r) {
        const double begin = breaks[r], end = r + 1 < breaks.size() ? breaks[r + 1] : 0x1p32;
        rows_.push_back({static_cast<std::uint32_t>(std::ceil(begin)), begin, 1 / (end - begin)});
        for (int i = 0; i < k; ++i) {  // a line through two inner points, for curves may jump at their ends
            const auto at = [&](double t) {
                return response(observer, wavelength_nm(density, ((begin + t * (end - begin)) * 0x1p-32 + i) / k));
            };
            const std::array<double, 3> low = at(0.25), high = at(0.75);
            float* group = &table_[(r * groups + i / 4) * kGroupFloats + i % 4];
            for (int c = 0; c < 3; ++c) {
                const double step = 2 * (high[c] - low[c]);
                group[8 * c] = static_cast<float>(low[c] - 0.25 * step);
                group[8 * c + 4] = static_cast<float>(step);
            }
        }
    }
    std::size_t row = 0;
    for (int g = 0; g < kGuide; ++g) {
        while (row + 1 < rows_.size() && rows_[row + 1].first_xi <= static_cast<std::uint32_t>(g) << 22) ++row;
        guide_.push_back(static_cast<std::uint32_t>(row));
    }
}

std::uint64_t BatchResponse::bytes(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) {
    return (density.knots().size() + observer.lambda_nm().size()) * ((std::uint64_t(k) + 3) / 4) * kGroupFloats * sizeof(float);
}

void BatchResponse::xyz(std::uint32_t xi, const float* power, float* out) const {
    std::size_t row = guide_[xi >> 22];
    while (row + 1 < rows_.size() && rows_[row + 1].first_xi <= xi) ++row;
    const std::size_t groups = (static_cast<std::size_t>(k_) + 3) / 4;
    const float* group = &table_[row * groups * kGroupFloats];

    // Four partial sums on every processor, added in one order.
    const hn::FixedTag<float, 4> d;
    const auto t = hn::Set(d, static_cast<float>((xi - rows_[row].begin) * rows_[row].scale));
    auto x = hn::Zero(d), y = x, z = x;
    const auto add = [&](auto p) {
        x = hn::Add(x, hn::Mul(p, hn::Add(hn::LoadU(d, group), hn::Mul(t, hn::LoadU(d, group + 4)))));
        y = hn::Add(y, hn::Mul(p, hn::Add(hn::LoadU(d, group + 8), hn::Mul(t, hn::LoadU(d, group + 12)))));
        z = hn::Add(z, hn::Mul(p, hn::Add(hn::LoadU(d, group + 16), hn::Mul(t, hn::LoadU(d, group + 20)))));
    };
    int i = 0;
    for (; i + 4 <= k_; i += 4, group += kGroupFloats) add(hn::LoadU(d, power + i));
    if (i < k_) {
        float last[4] = {};
        std::copy(power + i, power + k_, last);
        add(hn::LoadU(d, last));
    }
    const auto sum = [&](auto v) {
        float s[4];
        hn::StoreU(v, d, s);
        return (s[0] + s[1]) + (s[2] + s[3]);
    };
    out[0] = sum(x);
    out[1] = sum(y);
    out[2] = sum(z);
}

Result<BatchWhite> BatchWhite::make(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) {
    const auto refuse = [](const char* why) { return usage_error(std::string("--estimator ratio: ") + why); };
    if (density.empty())
        return refuse("needs wavelengths that were drawn from the density of the job; these records store their wavelengths");
    for (const std::array<double, 3>& f : observer.responses()) {
        if (std::ranges::min(f) < 0) return refuse("a response of this observer has negative values");
    }
    const std::vector<double> breaks = breaks_in_xi(density, k, observer);
    BatchWhite white;
    std::array<double, 3> integral{};  // over the density's range: the mean over xi
    for (std::size_t r = 0; r < breaks.size(); ++r) {
        const double begin = breaks[r], end = r + 1 < breaks.size() ? breaks[r + 1] : 0x1p32;
        std::array<double, 3> low{}, high{};
        for (int i = 0; i < k; ++i) {
            for (const double t : {0.25, 0.75}) {
                const double q = ((begin + t * (end - begin)) * 0x1p-32 + i) / k;
                const std::array<double, 3> f = response(observer, wavelength_nm(density, q));
                const double per_pdf = nm_per_quantile(density, q) / k;
                for (std::size_t c = 0; c < 3; ++c) (t < 0.5 ? low : high)[c] += f[c] * per_pdf;
            }
        }
        Row row{static_cast<std::uint32_t>(std::ceil(begin)), begin, 1 / (end - begin), {}, {}};
        for (std::size_t c = 0; c < 3; ++c) {
            row.step[c] = 2 * (high[c] - low[c]);
            row.low[c] = low[c] - 0.25 * row.step[c];
            integral[c] += 0.5 * (low[c] + high[c]) * (end - begin) * 0x1p-32;
        }
        white.rows_.push_back(row);
    }
    if (!(std::ranges::min(integral) > 0)) return refuse("a response of this observer is zero at all wavelengths of the records");
    for (Row& row : white.rows_) {
        for (std::size_t c = 0; c < 3; ++c) row.low[c] /= integral[c], row.step[c] /= integral[c];
    }
    return white;
}

std::array<float, 3> BatchWhite::operator()(std::uint32_t xi) const {
    const Row& row = *(std::ranges::upper_bound(rows_, xi, {}, &Row::first_xi) - 1);
    const double t = (xi - row.begin) * row.scale;
    std::array<float, 3> white;
    for (std::size_t c = 0; c < 3; ++c) white[c] = static_cast<float>(std::max(0.0, row.low[c] + t * row.step[c]));
    return white;
}

}  // namespace latent::develop
