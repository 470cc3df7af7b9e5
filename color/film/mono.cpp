#include "color/film/mono.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/film/push.h"
#include "color/film/spectra.h"
#include "color/film/stock.h"

namespace latent::film {
namespace {

// By which the density rises within 1.3 in log exposure above the point that is 0.1 denser than the base [ISO6].
double contrast_of(const std::vector<double>& h, const std::vector<double>& density) {
    const double base = std::ranges::min(density);
    std::size_t speed_point = 0;
    while (speed_point + 1 < h.size() && density[speed_point] < base + 0.1) ++speed_point;
    return interpolated(h[speed_point] + 1.3, h, density) - density[speed_point];
}

}  // namespace

Result<MonoCurve> mono_film(const Material& film, double push) {
    const Result<Columns> curves = need_table(film, "curves", {});
    if (!curves) return curves.error();
    if (curves->names.size() < 2) return Error{ErrorCode::kCorrupt, table_file(film, "curves") + ": has no curve"};
    const std::vector<double>& h = curves->values[0];
    constexpr double kNormal = 0.8;
    std::size_t best = 1;
    for (std::size_t i = 2; i < curves->names.size(); ++i) {
        const auto off = [&](std::size_t column) { return std::abs(contrast_of(h, curves->values[column]) - kNormal); };
        if (off(i) < off(best)) best = i;
    }
    MonoCurve out{h, {}};
    const double base = std::ranges::min(curves->values[best]);
    for (const double at : h)
        out.density.push_back(base + push_contrast(push) * (interpolated(at + push_speed(push), h, curves->values[best]) - base));
    constexpr double kStep = 0.05, kDecades = 4;
    constexpr std::size_t kEnd = 8;
    const double from = h.back(), most = out.density.back(),
                 contrast = (most - out.density[h.size() - 1 - kEnd]) / (from - h[h.size() - 1 - kEnd]);
    for (double beyond = kStep; beyond < kDecades; beyond += kStep) {
        out.log_exposure.push_back(from + beyond);
        out.density.push_back(most + shoulder(beyond, contrast));
    }
    return out;
}

Result<MonoCurve> mono_paper(const Material& paper, const std::string& contrast_filter) {
    const Result<Columns> curves = need_table(paper, "curves", {});
    if (!curves) return curves.error();
    std::string column = "filter_" + (contrast_filter.empty() ? "none" : contrast_filter == "00" ? "minus1" : contrast_filter);
    if (!curves->has("filter_none")) {  // minutes of development
        if (!contrast_filter.empty()) return usage_error(fmt::format("--contrast-filter: {} has one contrast", paper.name));
        column = curves->names[(curves->names.size() + 1) / 2];
    }
    if (!curves->has(column))
        return usage_error(fmt::format("--contrast-filter: '{}' is not 00, 0, 1, 2, 3, 4 or 5", contrast_filter));
    return MonoCurve{curves->values[0], (*curves)[column]};
}

}  // namespace latent::film
