#include "render/spectral/spectra.h"

#include <algorithm>
#include <cmath>

#include "color/light_spectrum.h"

namespace latent::render {
namespace {

constexpr float kFirstNm = static_cast<float>(color::kLambdaMin);
constexpr std::uint32_t kLastIndex = color::kIntegerNmCount - 1;

bool is_whole(double x) { return x == std::floor(x); }

}  // namespace

WavelengthSampler::WavelengthSampler(const sampledb::WavelengthDensity& density, std::uint32_t k) : density_(density), k_(k) {
    const auto knots = density.knots();
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const double width = (knots[i + 1].lambda - knots[i].lambda) * 0x1p-20;
        const double share = static_cast<double>(knots[i + 1].cumulative - knots[i].cumulative) * 0x1p-48;
        weight_.push_back(static_cast<float>(width / (share * k)));
    }
}

void WavelengthSampler::draw(std::uint32_t xi, Wavelengths& out) const {
    out.k = k_;
    out.xi = xi;
    // Weights are those of the segments that were drawn from: a float next to a line's edge may have been rounded across it.
    std::uint16_t segment[kMaxWavelengths];
    density_.batch(xi, std::span(out.lambda_nm, k_), std::span(segment, k_));
    for (std::uint32_t i = k_; i < kMaxWavelengths; ++i) out.lambda_nm[i] = out.lambda_nm[k_ - 1];
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        const float x = std::clamp(out.lambda_nm[i] - kFirstNm, 0.0f, static_cast<float>(kLastIndex));
        const std::uint32_t whole = static_cast<std::uint32_t>(x);
        out.nearest[i] = static_cast<std::uint32_t>(x + 0.5f);
        out.below[i] = std::min(whole, kLastIndex - 1);
        out.fraction[i] = x - static_cast<float>(out.below[i]);
        out.weight[i] = i < k_ ? weight_[segment[i]] : 0;
    }
}

SpectrumTable::SpectrumTable(const color::Spectrum& s, Lookup lookup) {
    const auto lambda = s.lambda_nm();
    const auto value = s.values();
    const bool at_integers = std::all_of(lambda.begin(), lambda.end(), is_whole);
    if (s.outside() == color::Outside::kClamped &&
        std::all_of(value.begin(), value.end(), [&](double v) { return v == value[0]; })) {
        form_ = Form::kConstant;
        value_ = {value.empty() ? 0.0f : static_cast<float>(value[0])};
    } else if (lookup == Lookup::kNearestNm ? !has_fine_lines(s) : at_integers) {
        form_ = lookup == Lookup::kNearestNm ? Form::kNearest : Form::kLinear;
        for (int i = 0; i < color::kIntegerNmCount; ++i) value_.push_back(static_cast<float>(s(color::kLambdaMin + i)));
    } else {
        form_ = Form::kKnots;
        const bool clamped = s.outside() == color::Outside::kClamped;
        knot_nm_ = {0, std::nextafter(static_cast<float>(lambda.front()), 0.0f)};
        value_.assign(2, clamped ? static_cast<float>(value.front()) : 0.0f);
        for (std::size_t i = 0; i < lambda.size(); ++i) {
            knot_nm_.push_back(static_cast<float>(lambda[i]));
            value_.push_back(static_cast<float>(value[i]));
        }
        knot_nm_.insert(knot_nm_.end(), {knot_nm_.back(), INFINITY});  // the last wavelength is outside already, as for the density
        value_.insert(value_.end(), 2, clamped ? value_.back() : 0.0f);
    }
}

void SpectrumTable::evaluate(const Wavelengths& w, SampledSpectrum& out) const {
    switch (form_) {
        case Form::kConstant:
            out = SampledSpectrum(value_[0]);
            return;
        case Form::kNearest:
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) out.v[i] = value_[w.nearest[i]];
            return;
        case Form::kLinear:
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                const float a = value_[w.below[i]], b = value_[w.below[i] + 1];
                out.v[i] = a + w.fraction[i] * (b - a);
            }
            return;
        case Form::kKnots: {
            std::size_t knot = 0;
            for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
                while (knot_nm_[knot + 1] <= w.lambda_nm[i]) ++knot;
                const float width = knot_nm_[knot + 1] - knot_nm_[knot];
                const float t = width < INFINITY ? (w.lambda_nm[i] - knot_nm_[knot]) / width : 0;
                out.v[i] = value_[knot] + t * (value_[knot + 1] - value_[knot]);
            }
            return;
        }
    }
}

std::uint32_t SpectrumLibrary::add(const color::Spectrum& s, Lookup lookup) {
    SpectrumTable table(s, lookup);
    const auto same = std::find(tables_.begin(), tables_.end(), table);
    if (same != tables_.end()) return static_cast<std::uint32_t>(same - tables_.begin());
    tables_.push_back(std::move(table));
    return static_cast<std::uint32_t>(tables_.size() - 1);
}

}  // namespace latent::render
