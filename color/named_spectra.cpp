#include "color/named_spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include "color/tables.h"

namespace latent::color {
namespace {

// The numbers must be known to be good.
Spectrum clamped(std::vector<double> lambda_nm, std::vector<double> value) {
    auto s = Spectrum::from_samples(std::move(lambda_nm), std::move(value), Outside::kClamped);
    assert(s);
    return *std::move(s);
}

Spectrum from_table(std::string_view file, std::string_view column) {
    return clamped(table(file).column("wavelength_nm"), table(file).column(column));
}

// n^2 - 1 = sum of B_i l^2 / (l^2 - C_i) [SCHOTT], at every nm from its shortest valid wavelength (300 nm at least) to 830 nm.
Spectrum glass(std::string_view schott_name) {
    const std::vector<double> c = table("glass_sellmeier").column(schott_name);
    std::vector<double> lambda_nm, eta;
    for (double lambda = c[0] * 1000; lambda <= kLambdaMax; lambda += 1) {
        const double l2 = lambda * lambda * 1e-6;
        lambda_nm.push_back(lambda);
        eta.push_back(std::sqrt(1 + c[1] * l2 / (l2 - c[2]) + c[3] * l2 / (l2 - c[4]) + c[5] * l2 / (l2 - c[6])));
    }
    return clamped(std::move(lambda_nm), std::move(eta));
}

// 100 (560/l)^5 (exp(1.435e7 / (2848 560)) - 1) / (exp(1.435e7 / (2848 l)) - 1)    [CIE15]
// every 5 nm and linear between, which "stdillum-A" means in pbrt-v4.
Spectrum illuminant_a() {
    std::vector<double> lambda_nm, power;
    for (double lambda = 300; lambda <= kLambdaMax; lambda += 5) {
        lambda_nm.push_back(lambda);
        power.push_back(100 * std::pow(560 / lambda, 5) * std::expm1(1.435e7 / (2848 * 560.0)) /
                        std::expm1(1.435e7 / (2848 * lambda)));
    }
    return clamped(std::move(lambda_nm), std::move(power));
}

// The nominal temperatures date from c2 = 1.4380e-2 m K; c2 is 1.4388e-2 m K in [CIE15].
Spectrum nominal_daylight(double kelvin) { return *daylight(kelvin * 1.4388 / 1.4380); }

struct NamedSpectrum {
    std::string name;
    std::function<Spectrum()> make;
};

std::vector<NamedSpectrum> make_registry() {
    std::vector<NamedSpectrum> all;
    const std::pair<const char*, const char*> glasses[] = {
        {"BK7", "N-BK7"},   {"BAF10", "N-BAF10"}, {"FK51A", "N-FK51A"}, {"LASF9", "N-LASF9"}, {"SF5", "N-SF5"},
        {"SF10", "N-SF10"}, {"SF11", "N-SF11"},   {"F5", "N-SF5"},      {"F10", "N-SF10"},    {"F11", "N-SF11"}};
    for (const auto& [name, schott_name] : glasses) {
        all.push_back({fmt::format("glass-{}", name), [schott_name = schott_name] { return glass(schott_name); }});
    }
    for (const char* metal : {"Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"}) {
        for (const char* column : {"eta", "k"}) {
            all.push_back({fmt::format("metal-{}-{}", metal, column),
                           [file = fmt::format("metal_{}", metal), column] { return from_table(file, column); }});
        }
    }
    all.push_back({"stdillum-A", illuminant_a});
    all.push_back({"stdillum-D50", [] { return nominal_daylight(5000); }});
    all.push_back({"stdillum-D65", [] { return nominal_daylight(6500); }});
    all.push_back({"illum-acesD60", [] { return *daylight(6000); }});  // the true temperature 6000 K [ACES-D60]
    for (int i = 1; i <= 12; ++i) {
        all.push_back({fmt::format("stdillum-F{}", i),
                       [column = fmt::format("FL{}", i)] { return from_table("illuminants_fl1_fl12_5nm", column); }});
    }
    return all;
}

const std::vector<NamedSpectrum>& registry() {
    static const std::vector<NamedSpectrum> all = make_registry();
    return all;
}

}  // namespace

Result<Spectrum> named_spectrum(std::string_view name) {
    const auto found = std::ranges::find(registry(), name, &NamedSpectrum::name);
    if (found != registry().end()) return found->make();
    const std::string_view family = name.substr(0, name.find('-'));
    std::string choices;
    for (const NamedSpectrum& s : registry()) {
        if (s.name.starts_with(family) && s.name.find('-') == family.size()) choices += (choices.empty() ? "" : ", ") + s.name;
    }
    if (choices.empty()) choices = "glass-*, metal-*-eta, metal-*-k, stdillum-* and illum-acesD60";
    return Error{ErrorCode::kNotFound, fmt::format("unknown spectrum \"{}\"; choose from {}", name, choices)};
}

std::vector<std::string> named_spectrum_names() {
    std::vector<std::string> names;
    for (const NamedSpectrum& s : registry()) names.push_back(s.name);
    return names;
}

const Spectrum& illuminant_d65() {
    static const Spectrum d65 = nominal_daylight(6500);
    return d65;
}

Result<Chromaticity> daylight_chromaticity(double cct_kelvin) {
    const double t = cct_kelvin, t2 = t * t, t3 = t2 * t;
    if (!(t >= 4000 && t <= 25000)) {
        return Error{ErrorCode::kOutOfRange, fmt::format("daylight is defined for 4000 to 25000 K, not {} K", cct_kelvin)};
    }
    const double x = t <= 7000 ? -4.6070e9 / t3 + 2.9678e6 / t2 + 0.09911e3 / t + 0.244063
                               : -2.0064e9 / t3 + 1.9018e6 / t2 + 0.24748e3 / t + 0.237040;
    return Chromaticity{x, -3 * x * x + 2.87 * x - 0.275};
}

Result<Spectrum> daylight(double cct_kelvin) {
    const Result<Chromaticity> xy = daylight_chromaticity(cct_kelvin);
    if (!xy) return xy.error();
    const auto three_decimals = [](double value) { return std::round(value * 1000) / 1000; };
    const double m = 0.0241 + 0.2562 * xy->x - 0.7341 * xy->y;
    const double m1 = three_decimals((-1.3515 - 1.7703 * xy->x + 5.9114 * xy->y) / m);
    const double m2 = three_decimals((0.0300 - 31.4424 * xy->x + 30.0717 * xy->y) / m);
    const Table& basis = table("cie_daylight_basis_s0_s1_s2_5nm");
    std::vector<double> power = basis.column("S0");
    const std::vector<double> s1 = basis.column("S1"), s2 = basis.column("S2");
    for (std::size_t i = 0; i < power.size(); ++i) power[i] += m1 * s1[i] + m2 * s2[i];
    return clamped(basis.column("wavelength_nm"), std::move(power));
}

}  // namespace latent::color
