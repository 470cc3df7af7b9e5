#include "color/film/process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "color/film/mono.h"
#include "color/power_of_ten.h"
#include "color/rgb_space.h"

namespace latent::film {
namespace {

constexpr double kLog10Of2 = 0.30102999566398120;
constexpr double kStep = 0.05;  // of log exposures, in all curves

Triple log10_of(const Triple& v, double least) {
    Triple out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = color::log10_of(v[c] > least ? std::min(v[c], 1e12) : least);
    return out;
}

// f at `first`, `first` + kStep, ... to `last` and beyond.
Table1 tabulated(double first, double last, const std::function<double(double)>& f) {
    Table1 table{static_cast<float>(first), static_cast<float>(1 / kStep), {}};
    const int entries = static_cast<int>(std::ceil((last - first) / kStep)) + 1;
    for (int i = 0; i < entries; ++i) table.y.push_back(static_cast<float>(f(first + i * kStep)));
    return table;
}

// log10 of the integrals of light 10^-density by three weights, over amounts of dye from `least` to `most`.
Table3 integrals_by_amounts(const Stock& stock, const Curve& light, const Curves& weights, const Triple& least,
                            const Triple& most) {
    constexpr int kN = Table3::kNodes;
    Table3 table;
    std::array<std::vector<Curve>, 3> passed;  // by dye: transmittance of the amount at each node
    for (std::size_t c = 0; c < 3; ++c) {
        const double step = (most[c] - least[c]) / (kN - 1);
        table.first[c] = static_cast<float>(least[c]);
        table.per_unit[c] = static_cast<float>(1 / step);
        for (int i = 0; i < kN; ++i) {
            Curve density = stock.dyes()[c];
            for (double& d : density) d *= least[c] + i * step;
            passed[c].push_back(transmittance(density));
        }
    }
    Curves through_base;
    const Curve base = transmittance(stock.base());
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < kNm; ++i) through_base[k][i] = light[i] * weights[k][i] * base[i];
    }
    table.v.resize(3 * kN * kN * kN);
    for (std::size_t i = 0; i < kN; ++i) {
        for (std::size_t j = 0; j < kN; ++j) {
            for (std::size_t c = 0; c < 3; ++c) {
                Curve weighted;
                for (std::size_t n = 0; n < kNm; ++n) weighted[n] = through_base[c][n] * passed[0][i][n] * passed[1][j][n];
                for (std::size_t k = 0; k < kN; ++k)
                    table.v[Table3::place(i, j, k) + c] =
                        static_cast<float>(color::log10_of(std::max(dot(weighted, passed[2][k]), 1e-30)));
            }
        }
    }
    return table;
}

Error does_not_fit(const Material& film, std::string_view paper, const char* what) {
    const char* fitting = !film.colour      ? "polymax, 2302 or scan"
                          : film.positive() ? "light-table, projection, radiance or ilfochrome"
                                            : "endura, crystal-archive-dpii, 2383 or scan";
    return usage_error(fmt::format("{} is {}, and {} does not go with it; choose {}", film.name, what, paper, fitting));
}

const char* indefinite(const Material& film) {
    return !film.colour ? "a black-and-white negative" : film.positive() ? "a slide" : "a colour negative";
}

}  // namespace

std::string list_views() {
    return "without paper (--paper):\n"
           "  scan                     a negative, scanned and inverted; the options of a plain print go with it\n"
           "  light-table              a slide on a light table (D50)\n"
           "  projection               a slide in a projector (D55)\n";
}

Result<Process> Process::make(const ProcessSettings& settings) {
    Process process;
    process.push_ = settings.push;
    process.print_log_ = settings.print_stops * kLog10Of2;
    process.scan_ = settings.paper == "scan";
    if (Status s = settings.film.colour ? process.make_colour(settings) : process.make_black_and_white(settings); !s)
        return s.error();
    return process;
}

Status Process::make_colour(const ProcessSettings& settings) {
    const Material& material = settings.film;
    Result<Stock> film = Stock::make(material);
    if (!film) return film.error();
    film_ = film->pushed(settings.push);
    coupling_ = settings.couplers ? film_->usual_coupling() : Coupling{};
    const bool projected = settings.paper == "projection", viewed = projected || settings.paper == "light-table";
    if (!settings.contrast_filter.empty())
        return usage_error(
            fmt::format("--contrast-filter: is for black-and-white paper, and {} is {}", material.name, indefinite(material)));
    if ((viewed && !material.positive()) || (scan_ && material.positive()))
        return does_not_fit(material, settings.paper, indefinite(material));
    const auto process_grey = [&](const Triple& grey) { return film_->amounts(film_->coupled(grey, coupling_)); };
    description_ = fmt::format("{} on {}", material.name, settings.paper);
    if (scan_) {
        scan_grey_ = film_->integral_density(process_grey(settings.grey));
        constexpr double kAround = 0.3;
        Triple below = settings.grey, above = settings.grey;
        for (std::size_t c = 0; c < 3; ++c) below[c] -= kAround, above[c] += kAround;
        const Triple low = film_->integral_density(process_grey(below)), high = film_->integral_density(process_grey(above));
        for (std::size_t c = 0; c < 3; ++c) scan_contrast_[c] = std::max((high[c] - low[c]) / (2 * kAround), 0.1);
        const color::RgbSpace& srgb = color::RgbSpace::srgb();
        xyz_from_scan_ = srgb.xyz_from_rgb;
        white_ = srgb.primaries.white;
        fill_tables();
        return {};
    }
    if (viewed) {
        viewing_ = viewing_of(projected ? Kind::kPrintFilm : Kind::kReversal);
        if (settings.trim) shift_ = neutral_shift(*film_, settings.grey);
    } else {
        const Result<Material> found = find_material(settings.paper, false);
        if (!found) return found.error();
        if (!found->colour || (found->kind == Kind::kReversalPrint) != material.positive())
            return does_not_fit(material, found->name, indefinite(material));
        Result<Stock> paper = Stock::make(*found);
        if (!paper) return paper.error();
        paper_ = *std::move(paper);
        viewing_ = viewing_of(found->kind);
        const Curve grey = film_->density(process_grey(settings.grey));
        printer_.emplace(*paper_, grey);
        if (settings.trim) {
            std::vector<Curve> greys;
            for (int half_stops = -4; half_stops <= 4; ++half_stops) {
                Triple h = settings.grey;
                for (double& v : h) v += half_stops * 0.5 * kLog10Of2;
                greys.push_back(film_->density(process_grey(h)));
            }
            printer_->trim_to(*paper_, greys);
        }
        if (settings.pack) printer_->use(*settings.pack, *paper_, grey);
        const Triple& ymc = printer_->pack().ymc;
        description_ = fmt::format("{} on {}, filters {:.0f}Y {:.0f}M {:.0f}C", material.name, found->name, 100 * ymc[0],
                                   100 * ymc[1], 100 * ymc[2]);
    }
    const Stock& last = paper_ ? *paper_ : *film_;
    const Triple base = seen(last, *viewing_, {});
    base_luminance_ = base[1];
    white_ = color::chromaticity({base[0], base[1], base[2]});
    fill_tables();
    return {};
}

Status Process::make_black_and_white(const ProcessSettings& settings) {
    const Material& material = settings.film;
    Result<MonoCurve> film = mono_film(material, settings.push);
    if (!film) return film.error();
    mono_h_ = film->log_exposure;
    mono_density_ = film->density;
    white_ = color::RgbSpace::srgb().primaries.white;
    description_ = fmt::format("{} on {}", material.name, settings.paper);
    const double grey = interpolated(settings.grey[0], mono_h_, mono_density_);
    if (settings.pack)
        return usage_error("--enlarger: the filters are for colour; use --contrast-filter for paper in black and white");
    if (scan_) {
        if (!settings.contrast_filter.empty()) return usage_error("--contrast-filter: needs a paper, not a scan");
        constexpr double kAround = 0.3;
        const double low = interpolated(settings.grey[0] - kAround, mono_h_, mono_density_),
                     high = interpolated(settings.grey[0] + kAround, mono_h_, mono_density_);
        scan_grey_[0] = grey;
        scan_contrast_[0] = std::max((high - low) / (2 * kAround), 0.1);
        fill_tables();
        return {};
    }
    if (settings.paper == "light-table" || settings.paper == "projection")
        return does_not_fit(material, settings.paper, indefinite(material));
    const Result<Material> found = find_material(settings.paper, false);
    if (!found) return found.error();
    if (found->colour) return does_not_fit(material, found->name, indefinite(material));
    Result<MonoCurve> paper = mono_paper(*found, settings.contrast_filter);
    if (!paper) return paper.error();
    paper_h_ = paper->log_exposure;
    paper_density_ = paper->density;
    description_ = fmt::format("{} on {}", material.name, found->name);
    if (!settings.contrast_filter.empty()) description_ += ", contrast filter " + settings.contrast_filter;
    const double least = std::ranges::min(paper_density_);
    paper_offset_ = inverted(paper_h_, paper_density_, -color::log10_of(viewing_of(found->kind).aim)) + grey + print_log_;
    base_luminance_ = color::power_of_ten(-least);
    fill_tables();
    return {};
}

Triple Process::film_amounts(const Triple& exposure) const {
    const Triple h = log10_of(exposure, 1e-12);
    if (!film_) {
        const double density = interpolated(h[0], mono_h_, mono_density_);
        return {density, density, density};
    }
    Triple moved = film_->coupled(h, coupling_);
    for (std::size_t c = 0; c < 3; ++c) moved[c] += shift_[c];
    return film_->amounts(moved);
}

Triple Process::seen_by(const Triple& exposure) const {
    const Triple a = film_amounts(exposure);
    if (scan_) {
        const Triple density = film_ ? film_->integral_density(a) : a;
        Triple rgb;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = film_ ? c : 0;
            rgb[c] = 0.18 * color::power_of_ten((density[k] - scan_grey_[k]) / scan_contrast_[k]);
        }
        return film_ ? xyz_from_scan_ * rgb : mono_xyz(rgb[0]);
    }
    if (!film_) return mono_xyz(color::power_of_ten(-interpolated(paper_offset_ - a[0], paper_h_, paper_density_)));
    if (!paper_) return seen(*film_, *viewing_, a);
    Triple h = printer_->exposures(*paper_, film_->density(a));
    for (double& v : h) v += print_log_;
    return seen(*paper_, *viewing_, paper_->amounts(h));
}

Triple Process::mono_xyz(double y) const {
    const color::Xyz white = color::xyz_from_chromaticity(white_);
    return {white.x * y, y, white.z * y};
}

Triple Process::operator()(const Triple& exposure) const {
    Triple xyz = seen_by(exposure);
    for (double& v : xyz) v /= base_luminance_;
    return xyz;
}

void Process::fill_tables() {
    ProcessTables& t = tables_;
    const double scale = 1 / base_luminance_;
    if (!film_) {
        t.mono = true;
        t.film[0] = tabulated(mono_h_.front(), mono_h_.back(), [&](double h) { return interpolated(h, mono_h_, mono_density_); });
        if (scan_) {
            t.slope[0] = static_cast<float>(1 / scan_contrast_[0]);
            t.offset[0] = static_cast<float>(color::log10_of(0.18) - scan_grey_[0] / scan_contrast_[0]);
        } else {
            t.slope[0] = -1;
            t.offset[0] = static_cast<float>(paper_offset_);
            t.print[0] =
                tabulated(paper_h_.front(), paper_h_.back(), [&](double h) { return -interpolated(h, paper_h_, paper_density_); });
        }
        const Triple white = mono_xyz(scale);
        t.matrix = {static_cast<float>(white[0]), 0, 0, 0, static_cast<float>(white[1]), 0, 0, 0, static_cast<float>(white[2])};
        return;
    }
    // Beyond the plot, a negative has a shoulder: four more decades hold all but 0.004 of it.
    const std::vector<double>& h = film_->log_exposures();
    constexpr double kShoulderDecades = 4;
    const double last = h.back() + (film_->material().kind == Kind::kNegative ? kShoulderDecades : 0) + std::abs(push_);
    for (std::size_t c = 0; c < 3; ++c) t.film[c] = tabulated(h.front(), last, [&](double at) { return film_->amount(c, at); });
    const float sign = film_->material().positive() ? -1 : 1;
    t.coupling = {sign * static_cast<float>(coupling_.adjacent), sign * static_cast<float>(coupling_.adjacent),
                  sign * static_cast<float>(coupling_.far)};
    for (std::size_t c = 0; c < 3; ++c) t.shift[c] = static_cast<float>(shift_[c]);
    Triple least = film_->min_amounts(), most = film_->max_amounts();
    t.matrix = {static_cast<float>(scale), 0, 0, 0, static_cast<float>(scale), 0, 0, 0, static_cast<float>(scale)};
    if (scan_) {
        Curve ones;
        ones.fill(1);
        t.through = integrals_by_amounts(*film_, ones, film_->densitometer_weights(), least, most);  // log10 of 1/density
        for (std::size_t c = 0; c < 3; ++c) {
            t.slope[c] = static_cast<float>(-1 / scan_contrast_[c]);
            t.offset[c] = static_cast<float>(color::log10_of(0.18) - scan_grey_[c] / scan_contrast_[c]);
            for (std::size_t k = 0; k < 3; ++k) t.matrix[3 * c + k] = static_cast<float>(xyz_from_scan_.m[c][k]);
        }
        return;
    }
    if (!paper_) {
        t.through = integrals_by_amounts(*film_, viewing_->light, matching(), least, most);
        return;
    }
    t.through = integrals_by_amounts(*film_, printer_->light(), paper_->sensitivities(), least, most);
    for (std::size_t c = 0; c < 3; ++c) {
        const double trim = printer_->trim()[c], aim = printer_->aim()[c];
        t.slope[c] = static_cast<float>(trim);
        t.offset[c] = static_cast<float>(aim - trim * aim + print_log_);
        t.print[c] = tabulated(paper_->log_exposures().front(), paper_->log_exposures().back(),
                               [&](double at) { return paper_->amount(c, at); });
    }
    t.look = integrals_by_amounts(*paper_, viewing_->light, matching(), paper_->min_amounts(), paper_->max_amounts());
}

void Process::row(float scale, const std::array<std::span<const float>, 3>& exposures, const std::array<std::span<float>, 3>& xyz,
                  const GrainRow* grain) const {
    process_row(tables_, scale, {exposures[0].data(), exposures[1].data(), exposures[2].data()},
                {xyz[0].data(), xyz[1].data(), xyz[2].data()}, exposures[0].size(), grain);
}

}  // namespace latent::film
