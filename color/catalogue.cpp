#include "color/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/near_names.h"
#include "base/parse.h"
#include "color/observer.h"
#include "color/power_of_ten.h"
#include "color/tables.h"

namespace latent::color {
namespace {

CatalogueEntry entry(std::string name, const Table& t, std::string_view column = {}) {
    return {std::move(name), t.what, t.source, t.name, column};
}

std::vector<CatalogueEntry> list_observers() {
    std::vector<CatalogueEntry> all;
    for (const auto& [name, file] : {std::pair{"cie1931", "cie1931_2deg_xyz_1nm"},
                                     {"cie1964", "cie1964_10deg_xyz_1nm"},
                                     {"cie2015-2", "cie2015_2deg_xyz_1nm"},
                                     {"cie2015-10", "cie2015_10deg_xyz_1nm"}}) {
        all.push_back(entry(name, table(file)));
    }
    for (const std::string_view family : {"camera_pbrt_", "camera_npl_", "film_"}) {
        for (const Table& t : tables()) {
            if (t.name.starts_with(family)) all.push_back(entry(std::string(t.name.substr(family.size())), t));
        }
    }
    return all;
}

// Filters that the table lacks were digitised from curves of their density.
std::vector<CatalogueEntry> list_filters() {
    std::vector<CatalogueEntry> all;
    const auto add = [&](std::string_view number, const Table& t, std::string_view column) {
        all.push_back(entry("wratten-" + folded_name(number), t, column));
    };
    const Table& tabulated = table("filter_wratten_table_10nm");
    for (const std::string_view column : tabulated.columns.subspan(1)) add(column.substr(1), tabulated, column);
    constexpr std::string_view kBefore = "filter_wratten_", kBehind = "_digitised";
    for (const Table& t : tables()) {
        if (t.name.starts_with(kBefore) && t.name.ends_with(kBehind))
            add(t.name.substr(kBefore.size(), t.name.size() - kBefore.size() - kBehind.size()), t, "density");
    }
    std::ranges::stable_sort(all, {}, [](const CatalogueEntry& e) {
        int number = 1000;  // CC30M and the like have none, and come last
        std::from_chars(e.name.data() + e.name.find('-') + 1, e.name.data() + e.name.size(), number);
        return number;
    });
    return all;
}

Result<CatalogueEntry> find(const std::vector<CatalogueEntry>& entries, std::string_view name, std::string_view kind) {
    std::vector<std::string> names;
    for (const CatalogueEntry& e : entries) {
        if (folded_name(e.name) == folded_name(name)) return e;
        names.push_back(e.name);
    }
    const std::string near = near_names(name, names);
    return Error{ErrorCode::kNotFound, fmt::format("unknown {} '{}'; {}--list-observers shows all", kind, name,
                                                   near.empty() ? "" : fmt::format("did you mean {}? ", near))};
}

// exp(-c2 m / l), the ratio of two blackbodies in Wien's approximation, 1 where it is largest within 360..830 nm [CODATA18].
Spectrum conversion_filter(double mired) {
    const double c2_m = 1.438776877e7 * mired * 1e-6;
    return Spectrum::from_function([&](double nm) { return power_of_e(c2_m / (mired > 0 ? kLambdaMax : kLambdaMin) - c2_m / nm); },
                                   Outside::kClamped);
}

// Planck's law at the 2850 K of the lamp that wedge spectrograms of films are made with, up to a factor [CODATA18].
double tungsten(double nm) {
    const double micrometres = nm / 1000, fifth = micrometres * micrometres * micrometres * micrometres * micrometres;
    return 1 / (fifth * (power_of_e(1.438776877e7 / (nm * 2850)) - 1));
}

ResponseTable film(const Table& t, std::string name) {
    // A wedge spectrogram shows the film's sensitivity times the light of the lamp; the other curves are of sensitivity alone.
    const bool times_lamp = t.name == "film_ilford_ortho_plus_80";
    ResponseTable out{std::move(name), ObserverKind::kFilm, {}, {}};
    for (std::size_t row = 0; row < t.rows(); ++row) {
        const double nm = t.at(row, 0), sensitivity = power_of_ten(t.at(row, 1)) / (times_lamp ? tungsten(nm) : 1);
        out.lambda_nm.push_back(nm);
        out.response.push_back({sensitivity, sensitivity, sensitivity});
    }
    return out;
}

ResponseTable three_curves(const Table& t, std::string name, ObserverKind kind) {
    ResponseTable out{std::move(name), kind, {}, {}};
    for (std::size_t row = 0; row < t.rows(); ++row) {
        out.lambda_nm.push_back(t.at(row, 0));
        out.response.push_back({t.at(row, 1), t.at(row, 2), t.at(row, 3)});
    }
    return out;
}

}  // namespace

const std::vector<CatalogueEntry>& observer_catalogue() {
    static const std::vector<CatalogueEntry> all = list_observers();
    return all;
}

const std::vector<CatalogueEntry>& lens_filter_catalogue() {
    static const std::vector<CatalogueEntry> all = list_filters();
    return all;
}

Result<Observer> Observer::by_name(std::string_view name) {
    const Result<CatalogueEntry> found = find(observer_catalogue(), name, "observer");
    if (!found) return found.error();
    const Table& t = table(found->table);
    if (found->name == "cie1931") return cie1931();
    if (t.name.starts_with("film_")) return from_table(film(t, found->name));
    return from_table(three_curves(t, found->name, t.name.starts_with("camera_") ? ObserverKind::kCamera : ObserverKind::kEye));
}

Result<Spectrum> lens_filter(std::string_view name) {
    constexpr std::string_view kMired = "mired:";
    if (name.starts_with(kMired)) {
        const Result<double> mired = parse_number(name.substr(kMired.size()));
        if (mired && std::abs(*mired) <= 1000) return conversion_filter(*mired);
        return is_not(name, "a conversion filter of up to 1000 mired (try mired:131, or mired:-131)");
    }
    const Result<CatalogueEntry> found = find(lens_filter_catalogue(), name, "filter");
    if (!found) return found.error();
    const Table& t = table(found->table);
    std::vector<double> value = t.column(found->column);
    if (found->column == "density") {
        for (double& v : value) v = power_of_ten(-v);
    }
    return Spectrum::from_samples(t.column("wavelength_nm"), std::move(value), Outside::kClamped);
}

std::string listing(std::string_view title, const std::vector<CatalogueEntry>& entries) {
    std::size_t width = 0;
    for (const CatalogueEntry& e : entries) width = std::max(width, e.name.size());
    std::string text = fmt::format("{}:\n", title);
    for (const CatalogueEntry& e : entries)
        text += fmt::format("  {:{}}  {}\n  {:{}}  source: {}\n", e.name, width, e.what, "", width, e.source);
    return text;
}

}  // namespace latent::color
