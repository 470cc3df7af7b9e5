#include "color/film/process_tables.h"

#include <algorithm>
#include <cmath>

#include "color/power_of_ten.h"

namespace latent::film {
namespace {

// Places on an axis of `entries` from `first` on. Nothing lies on the last place, which has no next one.
template <class Table>
void set_axis(Table& table, std::size_t layer, float first, float per_unit, std::size_t entries) {
    table.first[layer] = first;
    table.per_unit[layer] = per_unit;
    table.last[layer] = std::nextafter(static_cast<float>(entries - 1), 0.0F);
}

// `number`(layer, which, entry).
LayerTables tables_of(const std::array<Table1, 3>& axes,
                      const std::function<float(std::size_t, std::size_t, std::size_t)>& number) {
    LayerTables tables;
    for (std::size_t layer = 0; layer < 3; ++layer) {
        const Table1& axis = axes[layer];
        set_axis(tables, layer, axis.first, axis.per_unit, axis.y.size());
        tables.y[layer].assign(8 * (axis.y.size() - 1), 0);
        for (std::size_t i = 0; i + 1 < axis.y.size(); ++i) {
            for (std::size_t which = 0; which < 3; ++which) {
                float* at = &tables.y[layer][8 * i + which];
                at[0] = number(layer, which, i);
                at[4] = number(layer, which, i + 1) - at[0];
            }
        }
    }
    return tables;
}

// Numbers at n places of an axis, which has `inner` of them at each place, `outer` times; with those halfway between them, by
// cubics through four places.
std::vector<double> refined(const std::vector<double>& from, std::size_t outer, std::size_t n, std::size_t inner) {
    std::vector<double> to(outer * (2 * n - 1) * inner);
    for (std::size_t o = 0; o < outer; ++o) {
        for (std::size_t i = 0; i < n; ++i) {
            const double* const at = &from[(o * n + i) * inner];
            double* const out = &to[(o * (2 * n - 1) + 2 * i) * inner];
            std::copy_n(at, inner, out);
            if (i + 1 == n) continue;
            const bool first = i == 0, last = i + 2 == n;
            // The four places begin at `four`, of which the third and fourth, or the first and second, lie outside at the ends.
            const double* const four = first ? at : last ? at - 2 * inner : at - inner;
            const std::array<double, 4> weights = first  ? std::array{5.0, 15.0, -5.0, 1.0}
                                                  : last ? std::array{1.0, -5.0, 15.0, 5.0}
                                                         : std::array{-1.0, 9.0, 9.0, -1.0};
            for (std::size_t x = 0; x < inner; ++x) {
                double sum = 0;
                for (std::size_t k = 0; k < 4; ++k) sum += weights[k] * four[k * inner + x];
                out[inner + x] = sum / 16;
            }
        }
    }
    return to;
}

}  // namespace

Table1 tabulated(double first, double last, double step, const std::function<double(double)>& f) {
    Table1 table{static_cast<float>(first), static_cast<float>(1 / step), {}};
    const int entries = static_cast<int>(std::ceil((last - first) / step)) + 1;
    for (int i = 0; i < entries; ++i) table.y.push_back(static_cast<float>(f(first + i * step)));
    return table;
}

LayerTables layer_by_layer(const std::array<Table1, 3>& tables) {
    return tables_of(tables,
                     [&](std::size_t layer, std::size_t which, std::size_t i) { return layer == which ? tables[layer].y[i] : 0; });
}

LayerTables coupling_tables(const std::array<Table1, 3>& amounts, const Coupling& coupling, double sign) {
    const auto held = [&](std::size_t layer, std::size_t by, std::size_t i) {
        return static_cast<float>(sign * coupling.between(layer, by)) * amounts[by].y[i];
    };
    return tables_of(amounts, [&](std::size_t layer, std::size_t which, std::size_t i) {
        return layer == which ? held(layer, 0, i) + held(layer, 1, i) + held(layer, 2, i) : -held(which, layer, i);
    });
}

Table3 integrals_by_amounts(const Stock& stock, const Curve& light, const Curves& weights, const Triple& least,
                            const Triple& most) {
    constexpr std::size_t kNodes = Table3::kNodes, kN = (kNodes + 1) / 2;  // every other one; those between are as good by cubics
    Table3 table;
    std::array<std::vector<Curve>, 3> passed;  // by dye: transmittance of the amount at each node
    for (std::size_t c = 0; c < 3; ++c) {
        const double step = (most[c] - least[c]) / (kN - 1);
        set_axis(table, c, static_cast<float>(least[c]), static_cast<float>(2 / step), kNodes);
        for (std::size_t i = 0; i < kN; ++i) {
            Curve density = stock.dyes()[c];
            for (double& d : density) d *= least[c] + static_cast<double>(i) * step;
            passed[c].push_back(transmittance(density));
        }
    }
    std::vector<std::array<double, kN>> last(kNm);  // passed[2], by nm: so the sums of a line advance side by side
    for (std::size_t n = 0; n < kNm; ++n) {
        for (std::size_t k = 0; k < kN; ++k) last[n][k] = passed[2][k][n];
    }
    Curves through_base;
    const Curve base = transmittance(stock.base());
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < kNm; ++i) through_base[k][i] = light[i] * weights[k][i] * base[i];
    }
    std::vector<double> logs(3 * kN * kN * kN);
    for (std::size_t i = 0; i < kN; ++i) {
        for (std::size_t j = 0; j < kN; ++j) {
            for (std::size_t c = 0; c < 3; ++c) {
                std::array<double, kN> sums{};
                for (std::size_t n = 0; n < kNm; ++n) {
                    const double weight = through_base[c][n] * passed[0][i][n] * passed[1][j][n];
                    for (std::size_t k = 0; k < kN; ++k) sums[k] += weight * last[n][k];
                }
                for (std::size_t k = 0; k < kN; ++k)
                    logs[3 * ((i * kN + j) * kN + k) + c] = color::log10_of(std::max(sums[k], 1e-30));
            }
        }
    }
    logs = refined(refined(refined(logs, kN * kN, kN, 3), kN, kN, 3 * kNodes), 1, kN, 3 * kNodes * kNodes);
    table.v.assign(logs.begin(), logs.end());
    table.v.push_back(0);
    return table;
}

}  // namespace latent::film
