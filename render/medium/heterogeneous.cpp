#include "render/medium/heterogeneous.h"

#include <algorithm>
#include <cmath>

#include "render/math/elementary.h"
#include "render/medium/extinction.h"

namespace latent::render {
namespace {

// The share of each value in the throughput of the k wavelengths; that of white if the throughput is black.
template <class Extinction>
auto shares(const Extinction& extinction, const SampledSpectrum& value) {
    auto share = extinction.sums(value);
    const float total = share.sum();
    if (!(total > 0)) share = extinction.sums(SampledSpectrum(1.0f));
    const float scale = 1 / (total > 0 ? total : share.sum());
    return values_of<Extinction::N>([&](std::uint32_t i) { return share.v[i] * scale; });
}

template <std::uint32_t N>
std::uint32_t index_by(const MediumValues<N>& share, Uniform u) {
    float left = u;
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < N; ++i) {
        if (!(share[i] > 0)) continue;
        last = i;
        if (left < share[i]) break;
        left -= share[i];
    }
    return last;
}

template <std::uint32_t N>
float mean_by(const MediumValues<N>& share, const MediumValues<N>& value) {
    return (share * value).sum();
}

template <std::uint32_t N>
MediumValues<N> real_share(const MediumValues<N>& sigma_t, float mu) {
    return values_of<N>([&](std::uint32_t i) { return std::min(sigma_t.v[i] / mu, 1.0f); });
}
template <std::uint32_t N>
MediumValues<N> rest(const MediumValues<N>& value) {
    return values_of<N>([&](std::uint32_t i) { return 1 - value.v[i]; });
}

template <class Extinction, std::uint32_t N>
MediumStep vertex(const Extinction& extinction, float t, float column, const MediumValues<N>& sigma_t) {
    const MediumValues<N> transmittance = extinction.model_transmittance(column);
    return {true, t, extinction.mean(transmittance * sigma_t), extinction.mean(transmittance), column};
}

template <class Extinction>
MediumStep passed(const Extinction& extinction, float t, float column) {
    const float mean = extinction.mean(extinction.model_transmittance(column));
    return {false, t, mean, mean, column};
}

// Optical depth to the next tentative collision.
float depth_of(float u) { return -log_one_minus(u); }
constexpr float kStop = -1;

}  // namespace

HeterogeneousMedium::UnitLine HeterogeneousMedium::unit_line(const Segment& segment) const {
    return {Vec3f(unit_from_world_.point(Vec3d(segment.o))),
            Vec3f(unit_from_world_.vector(Vec3d(segment.d) / length(Vec3d(segment.d))))};
}

float HeterogeneousMedium::deepest_cell(const SpectrumLibrary& library) const {
    const Affined world_from_unit = unit_from_world_.inverse().value_or(Affined{});
    const MajorantGrid::Size& size = majorants_.size();
    const double diagonal =
        length(world_from_unit.x) / size[0] + length(world_from_unit.y) / size[1] + length(world_from_unit.z) / size[2];
    return static_cast<float>(diagonal) * majorants_.max() * library[reference_sigma_t_].max_value();
}

template <class F>
auto HeterogeneousMedium::with_extinction(SampleState& sample, F f) const {
    if (const ScaledMedium* medium = scaled()) {
        const SpectrumLevels& levels = sample.spectra.levels(reference_sigma_t_);
        if (levels.count > 0) return f(ScaledExtinction(*medium, levels, sample));
    }
    return f(SampledExtinction(*this, reference_sigma_t_, sample));
}

template <class Collide>
float HeterogeneousMedium::track(const UnitLine& line, float end, float reference, float u, Collide collide) const {
    float depth = depth_of(u);
    float column = 0;
    const auto visit = [&](float enter, float leave, const MajorantGrid::Cell& cell) {
        const float mu = cell.max * reference;
        float t = enter;
        while (depth < mu * (leave - t)) {
            const float next = t + depth / mu;
            t = next > t ? next : std::nextafter(t, kInfinity);  // far away, a step may be too short for a float
            depth = collide(t, line.o + line.d * t, mu);
            if (depth == kStop) {
                column += cell.mean * (t - enter);
                return false;
            }
        }
        depth -= mu * (leave - t);
        column += cell.mean * (leave - enter);
        return true;
    };
    if (outside_.max == 0) {
        majorants_.traverse(line.o, line.d, end, visit);
        return column;
    }
    float at = 0;  // where the cube begins, and then ends
    bool goes_on = true;
    majorants_.traverse(line.o, line.d, end, [&](float enter, float leave, const MajorantGrid::Cell& cell) {
        if (enter > at) goes_on = visit(at, enter, outside_);
        at = leave;
        goes_on = goes_on && visit(enter, leave, cell);
        return goes_on;
    });
    if (goes_on && at < end) visit(at, end, outside_);
    return column;
}

template <class Extinction>
MediumStep HeterogeneousMedium::sample_step(Extinction extinction, const Segment& segment, Uniform u_wavelength, Uniform u,
                                            SampleState& sample, SampledSpectrum& value, SampledSpectrum* emitted) const {
    constexpr std::uint32_t N = Extinction::N;
    const MediumValues<N> share = shares(extinction, value);
    const std::uint32_t chosen = index_by(share, u_wavelength);
    MediumValues<N> passed_null(1.0f);  // the product of (1 - a)
    MediumValues<N> sigma_t;
    float scattered_at = kInfinity;
    const UnitLine line = unit_line(segment);
    const float column = track(line, segment.length, extinction.reference_max(), u, [&](float t, const Vec3f& p, float mu) {
        SampledSpectrum light;
        if (emitted != nullptr && emission(p, sample, light)) {
            light *= value;
            extinction.multiply(passed_null, light);
            *emitted += light * (1 / (mu * mean_by(share, passed_null)));
        }
        sigma_t = extinction.at(p);
        const MediumValues<N> real = real_share(sigma_t, mu);
        if (sample.random() < real[chosen]) {
            extinction.multiply(passed_null, value);
            extinction.multiply_scattering(value);
            value *= 1 / (mu * mean_by(share, passed_null * real));
            scattered_at = t;
            return kStop;
        }
        passed_null *= rest(real);
        return depth_of(sample.random());
    });
    if (scattered_at < kInfinity) return vertex(extinction, scattered_at, column, sigma_t);
    extinction.multiply(passed_null, value);
    value *= 1 / mean_by(share, passed_null);
    return passed(extinction, segment.length, column);
}

MediumStep HeterogeneousMedium::sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample,
                                            SampledSpectrum& value, SampledSpectrum* emitted) const {
    return with_extinction(
        sample, [&](auto extinction) { return sample_step(extinction, segment, u_wavelength, u, sample, value, emitted); });
}

template <class Extinction>
float HeterogeneousMedium::multiply_transmittance(Extinction& extinction, const UnitLine& line, float end, SampleState& sample,
                                                  SampledSpectrum& value) const {
    constexpr std::uint32_t N = Extinction::N;
    const MediumValues<N> before = extinction.maxima(value);
    const float little = 0.05f * before.max();
    MediumValues<N> estimate(1.0f);
    const float u = sample.random();
    const float column = track(line, end, extinction.reference_max(), u, [&](float, const Vec3f& p, float mu) {
        estimate *= rest(real_share(extinction.at(p), mu));
        const float most = (before * estimate).max();
        if (most >= little && most > 0) return depth_of(sample.random());
        // What has nearly nothing left is followed one time in four, and then counts four times.
        if (!(most > 0 && sample.random() < 0.25f)) {
            estimate = MediumValues<N>(0.0f);
            return kInfinity;  // the column goes on
        }
        estimate *= MediumValues<N>(4.0f);
        return depth_of(sample.random());
    });
    extinction.multiply(estimate, value);
    return column;
}

MediumStep HeterogeneousMedium::scatter_at(const Segment& segment, float t, SampleState& sample, SampledSpectrum& value) const {
    return with_extinction(sample, [&](auto extinction) {
        const UnitLine line = unit_line(segment);
        const Vec3f p = line.o + line.d * t;
        const bool is_empty = is_empty_at(p);
        if (is_empty) value = SampledSpectrum(0.0f);
        const auto sigma_t = is_empty ? decltype(extinction.at(p))(0.0f) : extinction.at(p);
        extinction.multiply_scattering(value);
        return vertex(extinction, t, multiply_transmittance(extinction, line, t, sample, value), sigma_t);
    });
}

MediumStep HeterogeneousMedium::multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const {
    return with_extinction(sample, [&](auto extinction) {
        const float column = multiply_transmittance(extinction, unit_line(segment), segment.length, sample, value);
        return passed(extinction, segment.length, column);
    });
}

float HeterogeneousMedium::scattering_over_transmittance(const Vec3f& p, float column, SampleState& sample) const {
    return with_extinction(sample, [&](auto extinction) {
        const MediumStep step = vertex(extinction, 0, column, extinction.at(unit_point(p)));
        return step.density / step.transmittance;
    });
}

void ScaledMedium::extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const {
    sigma_t = sample.spectra[reference_sigma_t()] * density(p);
}

void ScaledMedium::scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const {
    sigma_s = sample.spectra[sigma_s_] * density(p);
}

}  // namespace latent::render
