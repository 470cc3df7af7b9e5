#include "color/film/dyes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/power_of_ten.h"

namespace latent::film {
namespace {

Curve at_every_nm(const Columns& table, std::string_view column) { return sampled(table.values[0], table[column]); }

double nm_of(std::size_t i) { return kFirstNm + static_cast<double>(i); }

// Beyond the end of its plot at `edge`, a dye falls off as a Gaussian, relative to the value there.
double tail(std::size_t dye, double nm, double edge) {
    constexpr double kPeak[] = {670, 542, 447}, kSigma[] = {60, 38, 42};
    const double d = nm - kPeak[dye], d0 = edge - kPeak[dye];
    if (std::abs(d0) >= 150) return 1;
    return color::power_of_e(-std::max(d * d - d0 * d0, 0.0) / (2 * kSigma[dye] * kSigma[dye]));
}

// Net dyes (mask included) of masked negatives: the mean of those of the four Vision3 films.
Curves template_dyes() {
    Curves mean{};
    for (const char* name : {"kodak_5203.dyes", "kodak_5207.dyes", "kodak_5213.dyes", "kodak_5219.dyes"}) {
        const Columns table = common_table(name);
        std::size_t dye = 0;
        for (const char* column : {"cyan", "magenta", "yellow"}) {
            const Curve one = at_every_nm(table, column);
            for (std::size_t i = 0; i < kNm; ++i) mean[dye][i] += one[i] / 4;
            ++dye;
        }
    }
    return mean;
}

// What fits net = midscale - minimum best, of the template's dyes, each moved by a multiple of 3 nm up to 12 nm, and scaled.
struct Fit {
    Curves dyes;
    double squares = 0;
    std::size_t samples = 0;
};
Fit fit_template(const Curve& net, std::size_t first, std::size_t last) {
    constexpr int kMoves = 9;
    const Curves plain = template_dyes();
    std::array<std::array<Curve, kMoves>, 3> moved;
    for (std::size_t dye = 0; dye < 3; ++dye) {
        for (int m = 0; m < kMoves; ++m) {
            for (int i = 0; i < static_cast<int>(kNm); ++i)
                moved[dye][m][i] = plain[dye][std::clamp(i - 3 * (m - kMoves / 2), 0, static_cast<int>(kNm) - 1)];
        }
    }
    std::vector<std::size_t> places;
    for (std::size_t i = (first + 4) / 5 * 5; i <= last; i += 5) places.push_back(i);
    Fit best{.dyes = {}, .squares = 1e300, .samples = places.size()};
    for (const Curve& c : moved[0]) {
        for (const Curve& m : moved[1]) {
            for (const Curve& y : moved[2]) {
                const std::array<const Curve*, 3> x{&c, &m, &y};
                std::array<Triple, 3> normal{};
                Triple right{};
                for (const std::size_t i : places) {
                    for (std::size_t a = 0; a < 3; ++a) {
                        right[a] += (*x[a])[i] * net[i];
                        for (std::size_t b = 0; b < 3; ++b) normal[a][b] += (*x[a])[i] * (*x[b])[i];
                    }
                }
                const Triple scale = solve(normal, right);
                double squares = 0;
                for (const std::size_t i : places) {
                    const double off = scale[0] * c[i] + scale[1] * m[i] + scale[2] * y[i] - net[i];
                    squares += off * off;
                }
                if (squares >= best.squares) continue;
                best.squares = squares;
                for (std::size_t a = 0; a < 3; ++a) {
                    for (std::size_t i = 0; i < kNm; ++i) best.dyes[a][i] = scale[a] * (*x[a])[i];
                }
            }
        }
    }
    return best;
}

// The measured difference between midscale and minimum, shared out among the dyes in the proportions of the fit, so that their sum
// is exact. Beyond the plot, the fit itself, scaled to meet its ends.
Dyes separated(const Columns& table) {
    Curve net = at_every_nm(table, "midscale");
    const Curve minimum = at_every_nm(table, "minimum");
    for (std::size_t i = 0; i < kNm; ++i) net[i] -= minimum[i];
    std::size_t first = 0, last = kNm - 1;
    while (nm_of(first) < table.values[0].front()) ++first;
    while (nm_of(last) > table.values[0].back()) --last;
    Fit fit = fit_template(net, first, last);
    Curve total{};
    for (Curve& dye : fit.dyes) {
        for (std::size_t i = 0; i < kNm; ++i) total[i] += dye[i] = std::max(dye[i], 0.0) + 1e-6;
    }
    for (std::size_t i = 0; i < kNm; ++i) {
        const std::size_t end = nm_of(i) < 500 ? first : last;
        if (i < first || i > last) net[i] = total[i] * net[end] / total[end];
    }
    for (Curve& dye : fit.dyes) {
        for (std::size_t i = 0; i < kNm; ++i) dye[i] *= net[i] / total[i];
    }
    return {fit.dyes, std::nullopt, std::sqrt(fit.squares / static_cast<double>(fit.samples))};
}

Dyes published(const Columns& table, bool have_base) {
    Dyes dyes{.unit = {at_every_nm(table, "cyan"), at_every_nm(table, "magenta"), at_every_nm(table, "yellow")}};
    if (have_base) {
        for (std::size_t i = 0; i < kNm; ++i) {
            const double least = std::min({dyes.unit[0][i], dyes.unit[1][i], dyes.unit[2][i]});
            for (Curve& dye : dyes.unit) dye[i] -= least;
        }
    }
    const double from = table.values[0].front(), to = table.values[0].back();
    for (std::size_t dye = 0; dye < 3; ++dye) {
        const Curve plotted = dyes.unit[dye];
        for (std::size_t i = 0; i < kNm; ++i) {
            if (nm_of(i) < from)
                dyes.unit[dye][i] = plotted[static_cast<std::size_t>(std::ceil(from - kFirstNm))] * tail(dye, nm_of(i), from);
            if (nm_of(i) > to)
                dyes.unit[dye][i] = plotted[static_cast<std::size_t>(std::floor(to - kFirstNm))] * tail(dye, nm_of(i), to);
        }
    }
    return dyes;
}

}  // namespace

Result<Dyes> dyes_of(const Material& material) {
    Result<Columns> table = need_table(material, "dyes", {});
    if (!table) return table.error();
    const std::vector<double>& nm = table->values[0];
    constexpr double kNeedFrom = 420, kNeedTo = 680;
    if (nm.front() > kNeedFrom || nm.back() < kNeedTo)
        return Error{ErrorCode::kCorrupt, fmt::format("{}: goes from {} to {} nm, but must reach from {} to {}",
                                                      table_file(material, "dyes"), nm.front(), nm.back(), kNeedFrom, kNeedTo)};
    const bool separate = !table->has("cyan");
    table = need_table(
        material, "dyes",
        separate ? std::vector<std::string>{"midscale", "minimum"} : std::vector<std::string>{"cyan", "magenta", "yellow"});
    if (!table) return table.error();
    Dyes dyes = separate ? separated(*table) : published(*table, material.dyes_have_base);
    constexpr double kFrom[] = {600, 500, 400}, kTo[] = {730, 600, 500};
    for (std::size_t dye = 0; dye < 3; ++dye) {
        double peak = 0;
        for (std::size_t i = 0; i < kNm; ++i) {
            if (nm_of(i) > kFrom[dye] && nm_of(i) < kTo[dye]) peak = std::max(peak, dyes.unit[dye][i]);
        }
        if (!(peak > 0))
            return Error{ErrorCode::kCorrupt, table_file(material, "dyes") + ": a dye absorbs nothing where it should most"};
        for (double& d : dyes.unit[dye]) d /= peak;
    }
    if (table->has("minimum")) dyes.base = at_every_nm(*table, "minimum");
    return dyes;
}

}  // namespace latent::film
