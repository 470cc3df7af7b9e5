#include "color/film/process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "color/film/mono.h"
#include "color/power_of_ten.h"
#include "color/rgb_space.h"

namespace latent::film {
namespace {

constexpr double kLog10Of2 = 0.30102999566398120;
constexpr double kStep = 0.05;  // between log exposures, in all curves

Triple log10_of(const Triple& v, double least) {
    Triple out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = color::log10_of(v[c] > least ? std::min(v[c], 1e12) : least);
    return out;
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
           "  light-table              a slide, or a negative as it is, on a light table (D50)\n"
           "  projection               a slide in a projector (D55)\n";
}

Result<Process> Process::make(const ProcessSettings& settings) {
    Process process;
    process.push_ = settings.push;
    process.print_log_ = settings.print_stops * kLog10Of2;
    process.scan_ = settings.paper == "scan";
    if (process.scan_ || settings.paper == "light-table" || settings.paper == "projection") {
        const char* given = settings.pack                       ? "--enlarger"
                            : settings.print_stops != 0         ? "--print-exposure"
                            : !settings.contrast_filter.empty() ? "--contrast-filter"
                                                                : nullptr;
        if (given != nullptr) return usage_error(fmt::format("{}: needs a paper, and {} is none", given, settings.paper));
    }
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
    if ((projected && !material.positive()) || (scan_ && material.positive()))
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
        if (settings.trim && material.positive()) shift_ = neutral_shift(*film_, settings.grey);
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
    Triple brightest = seen(paper_ ? *paper_ : *film_, *viewing_, {});
    if (viewed && !material.positive()) {  // the mask of a negative is orange beside the bare light
        for (std::size_t c = 0; c < 3; ++c) brightest[c] = dot(viewing_->light, matching()[c]);
    }
    base_luminance_ = brightest[1];
    white_ = color::chromaticity({brightest[0], brightest[1], brightest[2]});
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
        constexpr double kAround = 0.3;
        const double low = interpolated(settings.grey[0] - kAround, mono_h_, mono_density_),
                     high = interpolated(settings.grey[0] + kAround, mono_h_, mono_density_);
        scan_grey_.fill(grey);
        scan_contrast_.fill(std::max((high - low) / (2 * kAround), 0.1));
        fill_tables();
        return {};
    }
    if (settings.paper == "projection") return does_not_fit(material, settings.paper, indefinite(material));
    if (settings.paper == "light-table") {
        fill_tables();
        return {};
    }
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
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = 0.18 * color::power_of_ten((density[c] - scan_grey_[c]) / scan_contrast_[c]);
        return film_ ? xyz_from_scan_ * rgb : mono_xyz(rgb[0]);
    }
    if (!film_)
        return mono_xyz(
            color::power_of_ten(-(paper_h_.empty() ? a[0] : interpolated(paper_offset_ - a[0], paper_h_, paper_density_))));
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
    const auto by_log_exposure = [](const std::vector<double>& h, double more, const auto& f) {
        std::array<Table1, 3> tables;
        for (std::size_t c = 0; c < 3; ++c)
            tables[c] = tabulated(h.front(), h.back() + more, kStep, [&](double at) { return f(c, at); });
        return tables;
    };
    const auto affine = [&](std::size_t c, double slope, double offset) {
        t.slope[c] = static_cast<float>(slope);
        t.offset[c] = static_cast<float>(offset);
    };
    const auto scan = [&](std::size_t c, double sign) {
        affine(c, sign / scan_contrast_[c], color::log10_of(0.18) - scan_grey_[c] / scan_contrast_[c]);
    };
    if (!film_) {
        t.mono = true;
        t.film = layer_by_layer(
            by_log_exposure(mono_h_, 0, [&](std::size_t, double h) { return interpolated(h, mono_h_, mono_density_); }));
        for (std::size_t c = 0; c < 3; ++c) scan_ ? scan(c, 1) : affine(c, -1, paper_offset_);
        if (!paper_h_.empty())
            t.print = layer_by_layer(
                by_log_exposure(paper_h_, 0, [&](std::size_t, double h) { return -interpolated(h, paper_h_, paper_density_); }));
        const Triple white = mono_xyz(scale);
        t.matrix = {static_cast<float>(white[0]), 0, 0, 0, static_cast<float>(white[1]), 0, 0, 0, static_cast<float>(white[2])};
        return;
    }
    // Beyond the plot, a negative has a shoulder: four more decades hold all but 0.004 of it.
    const double shoulder = (film_->material().kind == Kind::kNegative ? 4 : 0) + std::abs(push_);
    const std::array<Table1, 3> amounts =
        by_log_exposure(film_->log_exposures(), shoulder, [&](std::size_t c, double h) { return film_->amount(c, h); });
    if (coupling_.adjacent != 0 || coupling_.far != 0)
        t.coupling = coupling_tables(amounts, coupling_, film_->material().positive() ? -1 : 1);
    t.film = layer_by_layer(amounts);
    for (std::size_t c = 0; c < 3; ++c) t.film.first[c] -= static_cast<float>(shift_[c]);
    const Triple least = film_->min_amounts(), most = film_->max_amounts();
    t.matrix = {static_cast<float>(scale), 0, 0, 0, static_cast<float>(scale), 0, 0, 0, static_cast<float>(scale)};
    if (scan_) {
        Curve ones;
        ones.fill(1);
        t.through = integrals_by_amounts(*film_, ones, film_->densitometer_weights(), least, most);  // log10 of 1/density
        for (std::size_t c = 0; c < 3; ++c) {
            scan(c, -1);
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
        affine(c, trim, aim - trim * aim + print_log_);
    }
    t.print =
        layer_by_layer(by_log_exposure(paper_->log_exposures(), 0, [&](std::size_t c, double h) { return paper_->amount(c, h); }));
    t.look = integrals_by_amounts(*paper_, viewing_->light, matching(), paper_->min_amounts(), paper_->max_amounts());
}

void Process::row(float scale, const std::array<std::span<const float>, 3>& exposures, const std::array<std::span<float>, 3>& xyz,
                  const GrainRow* grain) const {
    process_row(tables_, scale, {exposures[0].data(), exposures[1].data(), exposures[2].data()},
                {xyz[0].data(), xyz[1].data(), xyz[2].data()}, exposures[0].size(), grain);
}

}  // namespace latent::film
