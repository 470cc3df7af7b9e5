#include "color/observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "color/named_spectra.h"
#include "color/tables.h"

namespace latent::color {
namespace {

struct KnownObserver {
    std::string_view name, table;
};
constexpr KnownObserver kKnown[] = {
    {"cie1931", "cie1931_2deg_xyz_1nm"},
    {"cie1964", "cie1964_10deg_xyz_1nm"},
    {"cie2015-2", "cie2015_2deg_xyz_1nm"},
    {"cie2015-10", "cie2015_10deg_xyz_1nm"},
};

}  // namespace

Observer::Observer(std::string name, std::vector<double> lambda_nm, std::vector<std::array<double, 3>> response)
    : name_(std::move(name)), lambda_nm_(std::move(lambda_nm)), response_(std::move(response)) {
    assert(lambda_nm_.size() >= 2 && lambda_nm_.size() == response_.size());
    std::uint32_t knot = 0;
    for (double lambda = lambda_nm_.front(); lambda <= lambda_nm_.back(); lambda += 1) {
        while (lambda_nm_[knot + 1] <= lambda && knot + 2 < lambda_nm_.size()) ++knot;
        knot_below_.push_back(knot);
    }
}

Observer Observer::from_table(std::string_view name, std::string_view table_name) {
    const Table& t = table(table_name);
    std::vector<double> lambda_nm;
    std::vector<std::array<double, 3>> response;
    for (std::size_t row = 0; row < t.rows(); ++row) {
        lambda_nm.push_back(t.at(row, 0));
        response.push_back({t.at(row, 1), t.at(row, 2), t.at(row, 3)});
    }
    return {std::string(name), std::move(lambda_nm), std::move(response)};
}

Result<Observer> Observer::by_name(std::string_view name) {
    std::string choices;
    for (const KnownObserver& known : kKnown) {
        if (known.name == name) return from_table(known.name, known.table);
        choices += fmt::format("{}{}", choices.empty() ? "" : ", ", known.name);
    }
    return Error{ErrorCode::kNotFound, fmt::format("unknown observer \"{}\"; choose {}, or a CSV file", name, choices)};
}

const Observer& Observer::cie1931() {
    static const Observer observer = from_table(kKnown[0].name, kKnown[0].table);
    return observer;
}

std::array<double, 3> Observer::at(double lambda_nm) const {
    if (!(lambda_nm >= lambda_nm_.front() && lambda_nm <= lambda_nm_.back())) return {};
    std::size_t i = knot_below_[static_cast<std::size_t>(lambda_nm - lambda_nm_.front())];
    while (lambda_nm_[i + 1] <= lambda_nm && i + 2 < lambda_nm_.size()) ++i;
    const double t = (lambda_nm - lambda_nm_[i]) / (lambda_nm_[i + 1] - lambda_nm_[i]);
    std::array<double, 3> out;
    for (int c = 0; c < 3; ++c) out[c] = response_[i][c] + t * (response_[i + 1][c] - response_[i][c]);
    return out;
}

std::array<float, 3> Observer::operator()(float lambda_nm) const {
    const std::array<double, 3> f = at(lambda_nm);
    return {static_cast<float>(f[0]), static_cast<float>(f[1]), static_cast<float>(f[2])};
}

Spectrum Observer::curve(int component) const {
    std::vector<double> value;
    for (const auto& response : response_) value.push_back(response[component]);
    auto s = Spectrum::from_samples(lambda_nm_, std::move(value), Outside::kZero);
    assert(s);
    return *std::move(s);
}

Xyz xyz_from_spectrum(const Spectrum& s, const Observer& observer) {
    return {integral_of_product(s, observer.curve(0)), integral_of_product(s, observer.curve(1)),
            integral_of_product(s, observer.curve(2))};
}

double photometric_sum(const Spectrum& s) {
    const Observer& cie = Observer::cie1931();
    double sum = 0;
    for (std::size_t i = 0; i < cie.lambda_nm().size(); ++i) sum += cie.responses()[i][1] * s(cie.lambda_nm()[i]);
    return sum;
}

Chromaticity d65_chromaticity(const Observer& observer) { return chromaticity(xyz_from_spectrum(illuminant_d65(), observer)); }

}  // namespace latent::color
