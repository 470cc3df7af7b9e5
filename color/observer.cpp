#include "color/observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "color/named_spectra.h"
#include "color/tables.h"

namespace latent::color {
namespace {

constexpr Chromaticity kEqual{1.0 / 3, 1.0 / 3};

Xyz seen_daylight(const Observer& observer) { return xyz_from_spectrum(illuminant_d65(), observer); }

}  // namespace

Observer::Observer(ResponseTable table)
    : name_(std::move(table.name)),
      kind_(table.kind),
      lambda_nm_(std::move(table.lambda_nm)),
      response_(std::move(table.response)) {
    assert(lambda_nm_.size() >= 2 && lambda_nm_.size() == response_.size());
    std::uint32_t knot = 0;
    for (double lambda = lambda_nm_.front(); lambda <= lambda_nm_.back(); lambda += 1) {
        while (lambda_nm_[knot + 1] <= lambda && knot + 2 < lambda_nm_.size()) ++knot;
        knot_below_.push_back(knot);
    }
}

Result<Observer> Observer::from_table(ResponseTable table) {
    Observer observer(std::move(table));
    const double eye = seen_daylight(cie1931()).y;
    const Xyz seen = seen_daylight(observer);
    const bool camera = observer.kind_ == ObserverKind::kCamera;
    if (!(seen.y > 0) || (camera && !(seen.x > 0 && seen.z > 0))) {
        return Error{ErrorCode::kOutOfRange,
                     camera ? "a channel of the camera has no response to daylight from 360 to 830 nm"
                            : "the second column of responses (or the only one) has no response to daylight from 360 to 830 nm"};
    }
    const std::array<double, 3> scale =
        camera ? std::array{eye / seen.x, eye / seen.y, eye / seen.z} : std::array{eye / seen.y, eye / seen.y, eye / seen.y};
    for (auto& response : observer.response_) {
        for (int c = 0; c < 3; ++c) response[c] *= scale[c];
        if (std::ranges::any_of(response, [](double r) { return !std::isfinite(r); }))
            return Error{ErrorCode::kOutOfRange, "the responses to daylight are too small beside others, or beside 1"};
    }
    if (camera) {
        observer.sensitivity_ = {seen.x / seen.y, 1, seen.z / seen.y};
        observer.neutral_ = cie1931().neutral();
    } else {
        observer.neutral_ = observer.kind_ == ObserverKind::kFilm ? kEqual : chromaticity(seen);
    }
    return observer;
}

const Observer& Observer::cie1931() {
    static const Observer observer = [] {
        const Table& t = table("cie1931_2deg_xyz_1nm");
        ResponseTable responses{.name = "cie1931"};
        for (std::size_t row = 0; row < t.rows(); ++row) {
            responses.lambda_nm.push_back(t.at(row, 0));
            responses.response.push_back({t.at(row, 1), t.at(row, 2), t.at(row, 3)});
        }
        Observer as_tabulated(std::move(responses));
        as_tabulated.neutral_ = chromaticity(seen_daylight(as_tabulated));
        return as_tabulated;
    }();
    return observer;
}

Observer Observer::unbalanced() const {
    assert(kind_ == ObserverKind::kCamera);
    Observer out = *this;
    out.sensitivity_ = {1, 1, 1};
    out.name_ += ", unbalanced";
    for (auto& response : out.response_) {
        for (int c = 0; c < 3; ++c) response[c] *= sensitivity_[c];
    }
    return out;
}

Observer Observer::as_eye(const Matrix3& xyz_from_rgb) const {
    assert(kind_ == ObserverKind::kCamera);
    Observer out = *this;
    out.kind_ = ObserverKind::kEye;
    out.name_ += ", as XYZ";
    for (auto& response : out.response_) response = xyz_from_rgb * response;
    return out;
}

Observer Observer::behind(const Spectrum& transmittance, std::string_view filter_name, double factor) const {
    ResponseTable table{fmt::format("{} + {}", name_, filter_name), kind_, lambda_nm_, {}};
    const double first = lambda_nm_.front(), last = lambda_nm_.back();
    for (const double nm : transmittance.lambda_nm()) table.lambda_nm.push_back(nm);
    for (double nm = std::ceil(first); nm < last; ++nm) table.lambda_nm.push_back(nm);
    std::erase_if(table.lambda_nm, [&](double nm) { return nm < first || nm > last; });
    std::ranges::sort(table.lambda_nm);
    table.lambda_nm.erase(std::unique(table.lambda_nm.begin(), table.lambda_nm.end()), table.lambda_nm.end());
    for (const double nm : table.lambda_nm) {
        std::array<double, 3> response = at(nm);
        for (double& value : response) value *= transmittance(nm) * factor;
        table.response.push_back(response);
    }
    Observer out(std::move(table));
    out.neutral_ = neutral_;
    out.sensitivity_ = sensitivity_;
    return out;
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

}  // namespace latent::color
